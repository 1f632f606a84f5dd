//! The paper's record-fitting choices, Eq. 9, Eq. 10 and Fig. 13: the area under an acceleration is a velocity, and a
//! table's velocity limit bounds that area. A pulse keeps its peak and loses duration, or keeps its duration and loses peak.
//!
//! These are the paper's, kept as themselves for comparison: they leave displacement where it falls.

use super::resample::{Interpolation, resample};
use super::{Motion, peak};
use serde::{Deserialize, Serialize};

/// Which quantity gives way where the area under the acceleration is more than the limit allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Choice {
    /// The peak is kept and the duration cut: velocity is clipped, Eq. 10, so that the acceleration stops where the area
    /// is used up.
    PeakKept,
    /// The duration is kept and the peak scaled, pulse by pulse: every acceleration pulse between two zero crossings is
    /// scaled so that the velocity at its ends is the clipped one. Pulses that stay inside the limit are untouched.
    PeakScaled,
    /// The whole record is scaled until its largest velocity is the limit.
    RecordScaled,
    /// The whole record keeps its accelerations and runs faster, until its largest velocity is the limit. It becomes
    /// shorter, and its frequencies higher.
    TimeCompressed,
}

impl Choice {
    /// Every choice.
    pub const ALL: [Self; 4] = [Self::PeakKept, Self::PeakScaled, Self::RecordScaled, Self::TimeCompressed];
}

/// The velocity limit is not a positive number, m/s.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("velocity limit {0} m/s: expected a finite number over 0")]
pub(crate) struct LimitError(pub f64);

/// Fits a motion to a velocity limit (m/s). A motion inside it comes back as it is.
pub(crate) fn fit(motion: &Motion, limit: f64, choice: Choice) -> Result<Motion, LimitError> {
    if !(limit.is_finite() && limit > 0.0) {
        return Err(LimitError(limit));
    }
    let found = peak(&motion.velocity);
    if found <= limit {
        return Ok(motion.clone());
    }
    let start = motion.displacement.first().copied().unwrap_or(0.0);
    let with = |velocity| Motion::from_velocity(motion.dt, velocity, start);
    Ok(match choice {
        Choice::PeakKept => with(motion.velocity.iter().map(|v| v.clamp(-limit, limit)).collect()),
        Choice::PeakScaled => with(scaled_pulses(&motion.velocity, limit)),
        Choice::RecordScaled => motion.scaled(limit / found),
        Choice::TimeCompressed => compressed(motion, limit / found),
    })
}

/// Velocity whose every rise and fall is scaled to run between the clipped values of its ends.
fn scaled_pulses(velocity: &[f64], limit: f64) -> Vec<f64> {
    let mut fitted = Vec::with_capacity(velocity.len());
    let mut from = 0;
    while from + 1 < velocity.len() {
        let rising = velocity[from + 1] > velocity[from];
        let run = velocity[from..].windows(2).take_while(|w| (w[1] > w[0]) == rising).count();
        let (start, end) = (velocity[from], velocity[from + run]);
        let (low, high) = (start.clamp(-limit, limit), end.clamp(-limit, limit));
        // A fall may be level throughout.
        let scale = if end == start { 0.0 } else { (high - low) / (end - start) };
        fitted.extend(velocity[from..from + run].iter().map(|v| (low + scale * (v - start)).clamp(-limit, limit)));
        from += run;
    }
    fitted.extend(velocity.get(from).map(|v| v.clamp(-limit, limit)));
    fitted
}

/// The motion run faster by a factor below 1, at its old sampling interval.
fn compressed(motion: &Motion, factor: f64) -> Motion {
    let acceleration = resample(&motion.acceleration, motion.dt * factor, motion.dt, Interpolation::BandLimited);
    let faster = Motion::from_acceleration(motion.dt, acceleration);
    // Resampling moves the peak by a little.
    let limit = factor * peak(&motion.velocity);
    let found = peak(&faster.velocity);
    if found > limit { faster.scaled(limit / found) } else { faster }
}

#[cfg(test)]
mod tests {
    use super::super::generate::{FAR_FIELD, NEAR_FIELD_STRONG};
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_square_pulse_is_cut_or_lowered() {
        // 2 m/s2 over 0.4 s and back: 0.8 m/s, twice what the limit allows.
        let a: Vec<f64> = (0..=80).map(|k| if k < 40 { 2.0 } else { -2.0 }).collect();
        let velocity = (0..=80).map(|k: i32| 0.8 - 0.02 * f64::from((k - 40).abs())).collect();
        let motion = Motion { acceleration: a, ..Motion::from_velocity(0.01, velocity, 0.0) };
        let kept = fit(&motion, 0.4, Choice::PeakKept).unwrap().interval_acceleration();
        assert!(kept[..20].iter().all(|a| (a - 2.0).abs() < 1e-9) && kept[20..60].iter().all(|a| a.abs() < 1e-9));
        let scaled = fit(&motion, 0.4, Choice::PeakScaled).unwrap().interval_acceleration();
        assert!(
            scaled[..40].iter().all(|a| (a - 1.0).abs() < 1e-9) && scaled[40..].iter().all(|a| (a + 1.0).abs() < 1e-9)
        );
    }

    #[test]
    fn the_whole_record_gives_up_peak_or_duration() {
        let motion = NEAR_FIELD_STRONG.generate(3).unwrap().motion();
        let scaled = fit(&motion, 0.242, Choice::RecordScaled).unwrap();
        assert!(
            (peak(&scaled.acceleration) / peak(&motion.acceleration) - 0.242 / peak(&motion.velocity)).abs() < 1e-9
        );
        let faster = fit(&motion, 0.242, Choice::TimeCompressed).unwrap();
        assert!((peak(&faster.acceleration) / peak(&motion.acceleration) - 1.0).abs() < 0.05);
        assert!((faster.duration() / motion.duration() - 0.242 / peak(&motion.velocity)).abs() < 1e-3);
        assert_eq!(fit(&motion, f64::NAN, Choice::PeakKept).map_err(|e| e.0.is_nan()), Err(true));
        let quiet = FAR_FIELD.generate(1).unwrap().motion();
        for choice in Choice::ALL {
            assert_eq!(fit(&quiet, 0.242, choice).unwrap(), quiet);
        }
    }

    proptest! {
        #[test]
        fn no_choice_exceeds_the_limit_or_adds_acceleration(
            a in prop::collection::vec(-8.0..8.0f64, 2..200), limit in 0.01..0.5f64, which in 0..4usize
        ) {
            let motion = Motion::from_acceleration(0.01, a);
            let fitted = fit(&motion, limit, Choice::ALL[which]).unwrap();
            prop_assert!(peak(&fitted.velocity) <= limit * (1.0 + 1e-12));
            if Choice::ALL[which] != Choice::TimeCompressed {
                let (before, after) = (motion.interval_acceleration(), fitted.interval_acceleration());
                prop_assert!(before.iter().zip(&after).all(|(b, a)| a.abs() <= b.abs() + 1e-9 && a * b >= -1e-9));
            }
        }
    }
}
