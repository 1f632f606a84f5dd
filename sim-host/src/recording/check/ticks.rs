//! The controller's own clock: it may run faster or slower than the recording.
//!
//! A law is replayed at the rate it ran at. Between samples its inputs follow a cubic through their neighbours
//! (Catmull and Rom's), which a table's motion does at any sensible rate of recording; a slower law holds its output.

use crate::recording::run::Run;

/// How the controller's ticks and the samples lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Ticks {
    /// This many ticks a sample, the time between ticks, s.
    Faster(usize, f64),
    /// A tick every so many samples, the time between ticks, s.
    Slower(usize, f64),
}

impl Ticks {
    /// From a run's step and the rate it states for its controller.
    pub(crate) fn of(run: &Run) -> Self {
        let ratio = run.controller_rate_hz.map_or(1.0, |rate| rate * run.dt);
        if ratio >= 1.0 {
            let count = ratio.round() as usize;
            Self::Faster(count, run.dt / count as f64)
        } else {
            let count = (1.0 / ratio).round().max(1.0) as usize;
            Self::Slower(count, run.dt * count as f64)
        }
    }

    /// What `law` makes of samples at the controller's rate, given with the time between ticks, as a recording sees it.
    pub(crate) fn seen(self, samples: &[f64], law: impl Fn(&[f64], f64) -> [Vec<f64>; 2]) -> [Vec<f64>; 2] {
        let n = samples.len();
        match self {
            Self::Faster(1, dt) => law(samples, dt),
            Self::Faster(count, dt) => {
                let fine: Vec<f64> =
                    (0..n * count).map(|i| between(samples, i / count, (i % count) as f64 / count as f64)).collect();
                law(&fine, dt).map(|series| series.into_iter().step_by(count).collect())
            }
            Self::Slower(count, dt) => {
                let coarse: Vec<f64> = samples.iter().step_by(count).copied().collect();
                law(&coarse, dt)
                    .map(|series| if series.is_empty() { series } else { (0..n).map(|k| series[k / count]).collect() })
            }
        }
    }
}

/// Value `share` of the way from sample `k` to the next.
fn between(samples: &[f64], k: usize, share: f64) -> f64 {
    let at = |i: usize| samples[i.min(samples.len() - 1)];
    let (before, here, next, after) = (at(k.saturating_sub(1)), at(k), at(k + 1), at(k + 2));
    let (slope, curve) = (0.5 * (next - before), before - 2.5 * here + 2.0 * next - 0.5 * after);
    here + share * (slope + share * (curve + share * 0.5 * (after - before + 3.0 * (here - next))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_followed_and_samples_are_kept() {
        let samples: Vec<f64> = (0..9).map(|k| f64::from(k) * 0.3 - 1.0).map(|t| t * t + 0.5 * t).collect();
        for k in 1..7 {
            assert_eq!(between(&samples, k, 0.0), samples[k]);
            let t = (k as f64 + 0.5) * 0.3 - 1.0;
            assert!((between(&samples, k, 0.5) - (t * t + 0.5 * t)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_slower_law_holds_and_a_faster_one_is_seen_at_the_samples() {
        let samples: Vec<f64> = (0..6).map(f64::from).collect();
        let double = |x: &[f64], _: f64| [x.iter().map(|v| 2.0 * v).collect(), Vec::new()];
        assert_eq!(Ticks::Slower(2, 2.0).seen(&samples, double)[0], [0.0, 0.0, 4.0, 4.0, 8.0, 8.0]);
        assert_eq!(Ticks::Faster(4, 0.25).seen(&samples, double)[0], [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
    }
}
