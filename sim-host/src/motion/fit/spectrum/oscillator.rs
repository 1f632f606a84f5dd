//! The oscillator behind one ordinate of the spectrum, driven by an acceleration that is constant between samples.
//!
//! u'' + 2 zeta w u' + w^2 u = -a; shown is the absolute acceleration u'' + a = -(2 zeta w u' + w^2 u).

use std::f64::consts::TAU;

/// A damped oscillator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator {
    /// Natural frequency, rad/s.
    natural: f64,
    /// Damped frequency, rad/s.
    damped: f64,
    /// Rate of decay, 1/s.
    decay: f64,
}

/// A peak of a response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// When, s from the first sample.
    pub time: f64,
    /// Absolute acceleration there, m/s2, signed.
    pub value: f64,
}

/// Points in a period at which a response is looked at; its peak is missed by at most 1 - cos(pi / 32), 0.5 %.
const POINTS: f64 = 32.0;
/// A free response is followed until it has decayed to exp(-MEMORY).
const MEMORY: f64 = 9.0;

impl Oscillator {
    /// An oscillator of a natural `period`, s, and a damping ratio below 1.
    pub fn new(period: f64, damping: f64) -> Self {
        let natural = TAU / period;
        Self { natural, damped: natural * (1.0 - damping * damping).sqrt(), decay: damping * natural }
    }

    /// Natural period, s.
    pub fn period(&self) -> f64 {
        TAU / self.natural
    }

    /// Absolute acceleration after a ground acceleration of 1 has acted for a time `t`, s.
    fn step_response(&self, t: f64) -> f64 {
        if t <= 0.0 {
            return 0.0;
        }
        let angle = self.damped * t;
        1.0 - (-self.decay * t).exp() * (angle.cos() - self.decay / self.damped * angle.sin())
    }

    /// Total variation of the impulse response: the largest response to a velocity within -1 and 1, 1/s.
    ///
    /// The impulse response exp(-d t) (2 d cos + (w_d - d^2 / w_d) sin) jumps to 2 d, rises to its first extreme and then
    /// swings through extremes that shrink by exp(-pi d / w_d) each.
    pub fn variation(&self) -> f64 {
        let (d, w) = (self.decay, self.damped);
        let (rise, jump) = (w - d * d / w, 2.0 * d);
        let angle = (w / d).atan() - jump.atan2(rise);
        let peak = (-d * angle.max(0.0) / w).exp() * rise.hypot(jump) * (w / d).atan().sin();
        let shrink = (-d * std::f64::consts::PI / w).exp();
        peak + peak * (1.0 + shrink) / (1.0 - shrink)
    }

    /// Weights of the velocities in the response at `time`, s, with the sample each belongs to; `count` samples every `dt` s.
    pub(super) fn row(&self, time: f64, dt: f64, count: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let first = ((time - MEMORY / self.decay) / dt).floor().max(0.0) as usize;
        let last = ((time / dt).ceil() as usize).min(count - 1);
        // The acceleration of interval j, (v[j+1] - v[j]) / dt, adds itself times this.
        let share = move |j: usize| {
            let since = time - j as f64 * dt;
            (self.step_response(since) - self.step_response(since - dt)) / dt
        };
        (first..=last).map(move |k| {
            let before = if k > first { share(k - 1) } else { 0.0 };
            let after = if k < last { share(k) } else { 0.0 };
            (k, before - after)
        })
    }

    /// The largest response to a motion given by its velocity, m/s, every `dt` s.
    pub fn peak(&self, velocity: &[f64], dt: f64) -> Peak {
        let mut best = Peak { time: 0.0, value: 0.0 };
        self.respond(velocity, dt, |time, value| {
            if value.abs() > best.value.abs() {
                best = Peak { time, value };
            }
        });
        best
    }

    /// The highest peak above `level`, m/s2, and the deepest below its negative.
    pub(super) fn peaks(&self, velocity: &[f64], dt: f64, level: f64) -> Vec<Peak> {
        let rest = Peak { time: 0.0, value: 0.0 };
        let (mut high, mut low) = (rest, rest);
        self.respond(velocity, dt, |time, value| {
            if value > high.value {
                high = Peak { time, value };
            }
            if value < low.value {
                low = Peak { time, value };
            }
        });
        [high, low].into_iter().filter(|peak| peak.value.abs() > level).collect()
    }

    /// Calls `see` with time and absolute acceleration at every point of the response, exact for constant acceleration in between.
    fn respond(&self, velocity: &[f64], dt: f64, mut see: impl FnMut(f64, f64)) {
        let parts = (POINTS * dt / self.period()).ceil().max(1.0);
        let h = dt / parts;
        let (fade, angle) = ((-self.decay * h).exp(), self.damped * h);
        let (cosine, sine, ratio) = (angle.cos(), angle.sin(), self.decay / self.damped);
        // State: w^2 u and w^2 u' about the rest position under the present acceleration.
        let (mut u, mut rate) = (0.0, 0.0);
        for (k, pair) in velocity.windows(2).enumerate() {
            let rest = -(pair[1] - pair[0]) / dt;
            for part in 0..parts as usize {
                let offset = u - rest;
                let next = fade * (offset * (cosine + ratio * sine) + rate / self.damped * sine);
                rate = fade * (rate * (cosine - ratio * sine) - offset * self.natural.powi(2) / self.damped * sine);
                u = rest + next;
                let absolute = -u - 2.0 * self.decay / self.natural.powi(2) * rate;
                see(k as f64 * dt + (part + 1) as f64 * h, absolute);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion() -> Vec<f64> {
        (0..2000).map(|k| 0.2 * (f64::from(k) * 0.05).sin() * (f64::from(k) * 0.0031).sin()).collect()
    }

    #[test]
    fn a_row_is_the_response() {
        let (oscillator, dt, velocity) = (Oscillator::new(0.2, 0.05), 0.005, motion());
        oscillator.respond(&velocity, dt, |time, value| {
            if (time * 1000.0).round() as i64 % 777 == 0 {
                let row: f64 = oscillator.row(time, dt, velocity.len()).map(|(k, w)| w * velocity[k]).sum();
                assert!((row - value).abs() < 1e-3 * 0.2 / dt * 0.05, "{row} against {value} at {time}");
            }
        });
    }

    #[test]
    fn a_held_acceleration_is_followed_at_twice_its_size() {
        // A step of acceleration overshoots by exp(-pi zeta / sqrt(1 - zeta^2)), the damper's share by less than 1 %.
        let velocity: Vec<f64> = (0..400).map(|k| 0.01 * f64::from(k)).collect();
        let peak = Oscillator::new(0.4, 0.05).peak(&velocity, 0.01);
        let overshoot = (-std::f64::consts::PI * 0.05 / (1.0f64 - 0.0025).sqrt()).exp();
        assert!((peak.value.abs() - (1.0 + overshoot)).abs() < 1e-2, "{}", peak.value);
        assert!((peak.time - 0.2).abs() < 0.02);
    }

    #[test]
    fn no_velocity_within_one_passes_the_variation_and_switching_comes_near_it() {
        let oscillator = Oscillator::new(0.2, 0.05);
        let dt = 0.001;
        let switching: Vec<f64> = (0..20_000).map(|k| if (k / 100) % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let reached = oscillator.peak(&switching, dt).value.abs();
        let most = oscillator.variation();
        assert!(reached <= most * 1.0001 && reached > 0.97 * most, "{reached} of {most}");
    }
}
