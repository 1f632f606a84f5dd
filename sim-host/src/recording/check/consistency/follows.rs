//! Up to which frequency the stated loop moves with its reference: beyond it, a displacement that runs against the reference is the
//! loop's own phase and no sign turned round.

use super::FOLLOWS;
use crate::recording::{Baseline, RecordedLaw};
use realfft::num_complex::Complex64;

/// Largest angle by which a loop that follows lags or leads, rad: as far from a turned sign as from none would be a right angle.
const WITHIN: f64 = std::f64::consts::FRAC_PI_3;
/// Factor by which a stated loop's frequencies may be wrong.
const WRONG: f64 = 1.5;
/// Frequencies looked at, from a twentieth of [`FOLLOWS`] on.
const STEPS: i32 = 60;

/// The frequency in Hz, [`FOLLOWS`] at most; that where the loop is not known.
pub(super) fn follows_to(baseline: &Baseline, law: &RecordedLaw) -> f64 {
    let at = |step: i32| 0.05 * FOLLOWS * (20.0 * WRONG).powf(f64::from(step) / f64::from(STEPS));
    let lost = (0..=STEPS).map(at).find(|&hz| response(baseline, law, hz).is_some_and(|h| h.arg().abs() > WITHIN));
    lost.map_or(FOLLOWS, |hz| (hz / WRONG).min(FOLLOWS))
}

/// Displacement over reference at a frequency; none where the loop is not stated in a form that says it.
fn response(baseline: &Baseline, law: &RecordedLaw, hz: f64) -> Option<Complex64> {
    let s = Complex64::new(0.0, std::f64::consts::TAU * hz);
    let plant = match baseline {
        Baseline::Servo(servo) => (s * servo.b1 + servo.b0) / (s * (s + servo.a1)),
        Baseline::RigidMass(rigid) => Complex64::from(rigid.gain) / (s * (s * rigid.mass + rigid.viscous)),
        Baseline::ForceBalance(_) => return None,
    };
    let (forward, back) = match *law {
        RecordedLaw::ProportionalIntegral { kp, ki } => (kp + ki / s, kp + ki / s),
        RecordedLaw::Cascade { kp, kv } => (Complex64::from(kv * kp), kv * (kp + s)),
        RecordedLaw::Open | RecordedLaw::Core { .. } => return None,
    };
    Some(plant * forward / (1.0 + plant * back)).filter(|h| h.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{RigidMass, Servo};

    #[test]
    fn a_heavy_mass_on_a_soft_loop_turns_round_early() {
        // sqrt(kp / m) is 0.94 Hz.
        let heavy = Baseline::RigidMass(RigidMass { mass: 33410.0, viscous: 468_800.0, gain: 1.0 });
        let soft = RecordedLaw::ProportionalIntegral { kp: 1.177e6, ki: 0.147e6 };
        let lost = follows_to(&heavy, &soft);
        assert!(lost < 0.5, "{lost} Hz");
    }

    #[test]
    fn the_papers_loop_follows_as_far_as_any_is_asked_to() {
        let paper = Baseline::Servo(Servo {
            b1: 0.69,
            b0: 138.0,
            a1: 57.65,
            velocity_limit: None,
            mass: None,
            piston_area: None,
        });
        let followed = follows_to(&paper, &RecordedLaw::ProportionalIntegral { kp: 10.0, ki: 0.0 });
        assert!((followed - FOLLOWS).abs() < 1e-12, "{followed} Hz");
        assert!((follows_to(&paper, &RecordedLaw::Open) - FOLLOWS).abs() < 1e-12);
    }
}
