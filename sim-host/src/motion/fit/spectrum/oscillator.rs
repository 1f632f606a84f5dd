//! The oscillator behind one ordinate of the spectrum, driven by an acceleration that is linear between its samples.
//!
//! u'' + 2 zeta w u' + w^2 u = -a; shown is the absolute acceleration u'' + a = -(2 zeta w u' + w^2 u). With d = zeta w
//! and w' the damped frequency it answers a unit step of a by 1 - exp(-d t) (cos w't - d/w' sin w't) and a unit ramp by
//! t - exp(-d t) sin w't / w'.

use super::super::super::spectrum::advance;
use std::f64::consts::TAU;

/// A damped oscillator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Oscillator {
    /// Natural frequency, rad/s.
    natural: f64,
    /// Damped frequency, rad/s.
    damped: f64,
    /// Rate of decay, 1/s.
    decay: f64,
}

/// A peak of a response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Peak {
    /// When, s from the first sample.
    pub time: f64,
    /// Absolute acceleration there, m/s2, signed.
    pub value: f64,
}

/// Points in a period at which a response is looked at; its peak is missed by at most 1 - cos(pi / 64), 0.12 %.
const POINTS: f64 = 64.0;
/// A free response is followed until it has decayed to exp(-MEMORY).
const MEMORY: f64 = 9.0;

impl Oscillator {
    /// An oscillator of a natural `period`, s, and a damping ratio below 1.
    pub(crate) fn new(period: f64, damping: f64) -> Self {
        let natural = TAU / period;
        Self { natural, damped: natural * (1.0 - damping * damping).sqrt(), decay: damping * natural }
    }

    /// Natural period, s.
    pub(crate) fn period(&self) -> f64 {
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

    /// Absolute acceleration after a ground acceleration has risen by 1 a second for a time `t`, s.
    fn ramp_response(&self, t: f64) -> f64 {
        if t <= 0.0 { 0.0 } else { t - (-self.decay * t).exp() * (self.damped * t).sin() / self.damped }
    }

    /// Total variation of the impulse response: the largest response to a velocity within -1 and 1, 1/s.
    ///
    /// The impulse response exp(-d t) (2 d cos + (w_d - d^2 / w_d) sin) jumps to 2 d, rises to its first extreme and then
    /// swings through extremes that shrink by exp(-pi d / w_d) each.
    pub(crate) fn variation(&self) -> f64 {
        let (d, w) = (self.decay, self.damped);
        let (rise, jump) = (w - d * d / w, 2.0 * d);
        let angle = (w / d).atan() - jump.atan2(rise);
        let peak = (-d * angle.max(0.0) / w).exp() * rise.hypot(jump) * (w / d).atan().sin();
        let shrink = (-d * std::f64::consts::PI / w).exp();
        peak + peak * (1.0 + shrink) / (1.0 - shrink)
    }

    /// Weights of the accelerations in the response at `time`, s, with the sample each belongs to; `count` samples every
    /// `dt` s.
    pub(super) fn row(&self, time: f64, dt: f64, count: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let first = ((time - MEMORY / self.decay) / dt).floor().max(0.0) as usize;
        let last = ((time / dt).ceil() as usize).min(count - 1);
        (first..=last).map(move |k| {
            let since = time - k as f64 * dt;
            let fall = self.ramp_response(since) - self.ramp_response(since - dt);
            // Nothing rises to the first sample: it stands there at once.
            let rise = if k == 0 {
                self.step_response(since) * dt
            } else {
                self.ramp_response(since + dt) - self.ramp_response(since)
            };
            (k, (rise - fall) / dt)
        })
    }

    /// The largest response to an acceleration, m/s2, every `dt` s.
    pub(crate) fn peak(&self, acceleration: &[f64], dt: f64) -> Peak {
        let mut best = Peak { time: 0.0, value: 0.0 };
        self.respond(acceleration, dt, |time, value| {
            if value.abs() > best.value.abs() {
                best = Peak { time, value };
            }
        });
        best
    }

    /// The peak of every half cycle that passes `level`, m/s2, to either side, largest first.
    pub(super) fn peaks(&self, acceleration: &[f64], dt: f64, level: f64) -> Vec<Peak> {
        let mut found: Vec<Peak> = Vec::new();
        let mut outside = false;
        self.respond(acceleration, dt, |time, value| {
            if value.abs() <= level {
                outside = false;
                return;
            }
            match found.last_mut() {
                Some(peak) if outside && value.abs() > peak.value.abs() => *peak = Peak { time, value },
                Some(_) if outside => {}
                _ => found.push(Peak { time, value }),
            }
            outside = true;
        });
        found.sort_by(|a, b| b.value.abs().total_cmp(&a.value.abs()));
        found
    }

    /// Calls `see` with time and absolute acceleration at every point of the response.
    fn respond(&self, acceleration: &[f64], dt: f64, mut see: impl FnMut(f64, f64)) {
        let parts = (POINTS * dt / self.period()).ceil().max(1.0);
        let h = dt / parts;
        let damping = self.decay / self.natural;
        let state = |x, v, from, to| advance((self.natural, damping, h), (x, v), (from, to));
        // The state after a step, by the displacement and velocity before it and the accelerations at its ends.
        let columns = [
            state(1.0, 0.0, 0.0, 0.0),
            state(0.0, 1.0, 0.0, 0.0),
            state(0.0, 0.0, 1.0, 0.0),
            state(0.0, 0.0, 0.0, 1.0),
        ];
        let (spring, damper) = (self.natural * self.natural, 2.0 * self.decay);
        let (mut x, mut v) = (0.0, 0.0);
        for (k, pair) in acceleration.windows(2).enumerate() {
            let slope = (pair[1] - pair[0]) / parts;
            for part in 0..parts as usize {
                let from = pair[0] + slope * part as f64;
                let inputs = [x, v, from, from + slope];
                x = columns.iter().zip(&inputs).map(|(c, u)| c.0 * u).sum();
                v = columns.iter().zip(&inputs).map(|(c, u)| c.1 * u).sum();
                see(k as f64 * dt + (part + 1) as f64 * h, -damper * v - spring * x);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion() -> Vec<f64> {
        (0..2000).map(|k| 2.0 * (f64::from(k) * 0.05).cos() * (f64::from(k) * 0.0031).cos()).collect()
    }

    #[test]
    fn a_row_is_the_response() {
        for period in [0.05, 0.2, 0.5] {
            let (oscillator, dt, acceleration) = (Oscillator::new(period, 0.05), 0.005, motion());
            let (mut seen, mut compared) = (0, 0);
            oscillator.respond(&acceleration, dt, |time, value| {
                seen += 1;
                if seen % 389 == 0 {
                    let row: f64 = oscillator.row(time, dt, acceleration.len()).map(|(k, w)| w * acceleration[k]).sum();
                    assert!((row - value).abs() < 1e-3, "{row} against {value} at {time}");
                    compared += 1;
                }
            });
            assert!(compared > 3);
        }
    }

    #[test]
    fn every_half_cycle_over_the_level_gives_its_peak() {
        let ringing: Vec<f64> = (0..400).map(|k| if k < 2 { 1.0 } else { 0.0 }).collect();
        let oscillator = Oscillator::new(0.4, 0.05);
        let highest = oscillator.peak(&ringing, 0.01);
        let peaks = oscillator.peaks(&ringing, 0.01, 0.5 * highest.value.abs());
        assert_eq!(peaks[0], highest);
        // A free vibration loses 15 % a half cycle: four of them pass half the first.
        assert_eq!(peaks.len(), 5);
        for pair in peaks.windows(2) {
            assert!(
                pair[0].value * pair[1].value < 0.0 && (pair[1].time - pair[0].time - 0.2).abs() < 0.02,
                "{peaks:?}"
            );
        }
    }

    #[test]
    fn a_held_acceleration_is_followed_at_twice_its_size() {
        // A step of acceleration overshoots by exp(-pi zeta / sqrt(1 - zeta^2)), the damper's share by less than 1 %.
        let peak = Oscillator::new(0.4, 0.05).peak(&[1.0; 400], 0.01);
        let overshoot = (-std::f64::consts::PI * 0.05 / (1.0f64 - 0.0025).sqrt()).exp();
        assert!((peak.value.abs() - (1.0 + overshoot)).abs() < 1e-2, "{}", peak.value);
        assert!((peak.time - 0.2).abs() < 0.02);
    }

    #[test]
    fn no_velocity_within_one_passes_the_variation_and_switching_comes_near_it() {
        let oscillator = Oscillator::new(0.2, 0.05);
        let dt = 0.0005;
        // The velocity switches between its limits in two samples, every tenth of a second.
        let acceleration: Vec<f64> = (0..40_000)
            .map(|k| match (k % 200, k / 200 % 2) {
                (0, 0) => 2.0 / dt,
                (0, _) => -2.0 / dt,
                _ => 0.0,
            })
            .collect();
        let reached = oscillator.peak(&acceleration[100..], dt).value.abs();
        let most = oscillator.variation();
        assert!(reached <= most * 1.0001 && reached > 0.97 * most, "{reached} of {most}");
    }
}
