//! Faults, and how each changes a recording.

use crate::recording::channel::Channel;
use crate::recording::lag::lagged;
use crate::recording::run::Run;
use rand::Rng;
use serde::{Deserialize, Serialize};

/// What is planted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// The channel comes late.
    Delay,
    /// The channel is out of proportion.
    Gain,
    /// The channel went through a first-order low-pass.
    Filter,
    /// A constant in the channel.
    Bias,
    /// Coulomb friction more than there is, through the force balance of the fitted twin.
    Friction,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Delay, Self::Gain, Self::Filter, Self::Bias, Self::Friction];

    /// A name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Delay => "delay",
            Self::Gain => "gain",
            Self::Filter => "filter",
            Self::Bias => "bias",
            Self::Friction => "friction",
        }
    }

    /// Channels that it is planted into, the first that a recording has.
    fn channels(self) -> &'static [Channel] {
        match self {
            Self::Friction => &[Channel::PressureDifference],
            _ => &[Channel::Acceleration, Channel::Command],
        }
    }
}

/// A planted fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fault {
    /// What.
    pub kind: Kind,
    /// The channel.
    pub channel: String,
    /// Size, in `unit`.
    pub size: f64,
    /// Its unit.
    pub unit: String,
    /// Root of the sum of squares of the change over the channel's noise, in standard deviations.
    pub sigma: f64,
}

/// Velocity over which the planted friction turns round (m/s): the noise of a velocity from a displacement is below it.
const SLOW: f64 = 2e-3;

/// Standard deviation of a channel's noise from its fourth differences, which a smooth signal leaves nothing of.
pub fn noise(values: &[f64]) -> f64 {
    let fourth =
        values.windows(5).map(|w| w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).filter(|d| d.is_finite());
    let (n, sum) = fourth.fold((0_usize, 0.0), |(n, sum), d| (n + 1, sum + d * d));
    (sum / (70.0 * n.max(1) as f64)).sqrt()
}

impl Fault {
    /// Draws a fault of a kind, plants it into the run's samples from `from` on, and measures it; none where the run has not the
    /// channel, or the change would be below `least` standard deviations. `scale` is the twin's pressure per acceleration, where
    /// it has one.
    pub fn plant(
        kind: Kind,
        run: &mut Run,
        from: usize,
        scale: Option<f64>,
        least: f64,
        rng: &mut impl Rng,
    ) -> Option<Self> {
        let channel = kind.channels().iter().copied().find(|c| run.channel(*c).is_some())?;
        let before = run.channel(channel)?.to_vec();
        let noise = noise(&before[from..]);
        let unit = |rng: &mut dyn Rng| (rng.next_u64() >> 11) as f64 / 9_007_199_254_740_992.0;
        let sign = if unit(rng) < 0.5 { -1.0 } else { 1.0 };
        let mut draw = |low: f64, high: f64| low * libm::pow(high / low, unit(rng));
        let (size, name, after) = match kind {
            Kind::Delay => {
                let time = draw(2e-3, 2e-2);
                (time, "s", delayed(&before, time / run.dt))
            }
            Kind::Gain => {
                let part = sign * draw(0.03, 0.3);
                (part, "1", before.iter().map(|v| v * (1.0 + part)).collect())
            }
            Kind::Filter => {
                let time = draw(2e-3, 2e-2);
                (time, "s", lagged(&before, time / run.dt))
            }
            Kind::Bias => {
                let size = sign * draw(0.3, 10.0) * noise;
                (size, "unit of the channel", before.iter().map(|v| v + size).collect())
            }
            Kind::Friction => {
                let force = draw(0.1, 2.0);
                let v = velocity(run)?;
                let scale = scale?;
                let push = |(p, v): (&f64, &f64)| p + scale * force * libm::tanh(v / SLOW);
                (force, "m/s2", before.iter().zip(&v).map(push).collect())
            }
        };
        let change = before[from..].iter().zip(&after[from..]).map(|(a, b)| (b - a).powi(2)).filter(|d| d.is_finite());
        let sigma = change.sum::<f64>().sqrt() / noise.max(f64::MIN_POSITIVE);
        run.channels.set(channel, after);
        (sigma >= least).then(|| Self { kind, channel: channel.name().into(), size, unit: name.into(), sigma })
    }
}

/// Later by `samples`, straight between them.
fn delayed(values: &[f64], samples: f64) -> Vec<f64> {
    let at = |k: usize| {
        let place = (k as f64 - samples).max(0.0);
        let (below, part) = (place.floor() as usize, place - place.floor());
        let above = (below + 1).min(values.len() - 1);
        (1.0 - part) * values[below] + part * values[above]
    };
    (0..values.len()).map(at).collect()
}

/// The displacement's slope over about 10 ms (m/s).
fn velocity(run: &Run) -> Option<Vec<f64>> {
    let x = run.channel(Channel::Displacement)?;
    let half = ((5e-3 / run.dt).round() as usize).max(1);
    let slope = |k: usize| {
        let (a, b) = (k.saturating_sub(half), (k + half).min(x.len() - 1));
        (x[b] - x[a]) / ((b - a).max(1) as f64 * run.dt)
    };
    Some((0..x.len()).map(slope).collect())
}

#[cfg(test)]
mod tests {
    use super::{delayed, lagged, noise};

    #[test]
    fn noise_is_read_from_beneath_a_smooth_signal() {
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        let values: Vec<f64> = (0..4000).map(|k| (f64::from(k) * 0.01).sin() * 50.0 + uniform()).collect();
        let expected = (1.0_f64 / 12.0).sqrt();
        assert!((noise(&values) / expected - 1.0).abs() < 0.06, "{}", noise(&values));
    }

    #[test]
    fn a_delay_moves_and_a_filter_trails_a_ramp_by_its_time() {
        let ramp: Vec<f64> = (0..200).map(f64::from).collect();
        assert!((delayed(&ramp, 2.5)[100] - 97.5).abs() < 1e-12);
        for time in [0.4, 4.0] {
            assert!((lagged(&ramp, time)[199] - (199.0 - time)).abs() < 1e-9, "{}", lagged(&ramp, time)[199]);
        }
    }
}
