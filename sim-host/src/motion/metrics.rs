//! How near a response is to its reference, and how strong a motion is.
//!
//! The paper's metrics are Eq. 11 and 12: the norm of the error over the norm of the reference, the response shifted in
//! time so that the error is least. Table 1's `E_a` comes out when it is read as the square of that ratio and `E_d` as the
//! ratio itself, so both readings are given everywhere ([`RelativeError`]).

mod coherence;
mod indices;
mod intensity;
mod played;
mod shift;

pub(crate) use coherence::coherence;
pub(crate) use indices::{Indices, indices};
pub(crate) use intensity::{Intensity, intensity};
pub(crate) use played::{Played, Recorded, played};
pub(crate) use shift::{Shift, relative_error};

use super::{Motion, peak};
use std::ops::Range;

/// The longest shift the paper's metrics are free to take, s.
pub(crate) const MAX_SHIFT: f64 = 0.5;

/// A relative error in both readings, and the shift it was found at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativeError {
    /// Norm of the error over norm of the reference; infinite where the reference is zero and the response is not.
    pub ratio: f64,
    /// How far the response lags the reference, s; negative where it leads.
    pub delay: f64,
}

impl RelativeError {
    /// The reading that Table 1's `E_a` needs: the square of the ratio.
    pub fn squared(&self) -> f64 {
        self.ratio * self.ratio
    }
}

/// A response against its reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// `E_a`, Eq. 11: acceleration, shift free.
    pub e_a: RelativeError,
    /// Acceleration, no shift.
    pub e_a_unshifted: RelativeError,
    /// `E_d`, Eq. 12: displacement, shift free on its own.
    pub e_d: RelativeError,
    /// Displacement, at the shift of the acceleration.
    pub e_d_at_acceleration_delay: RelativeError,
    /// Displacement, no shift.
    pub e_d_unshifted: RelativeError,
    /// Largest acceleration of the reference, m/s².
    pub reference_peak: f64,
    /// Largest acceleration of the response, m/s².
    pub response_peak: f64,
}

impl Comparison {
    /// Largest acceleration of the response over that of the reference: spikes from saturation make it exceed 1.
    pub fn spike_ratio(&self) -> f64 {
        if self.reference_peak > 0.0 { self.response_peak / self.reference_peak } else { f64::NAN }
    }
}

/// Why two motions cannot be compared.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// Their sampling intervals differ.
    #[error("the reference is sampled every {reference} s and the response every {response} s: resample one of them")]
    Interval {
        /// Of the reference, s.
        reference: f64,
        /// Of the response, s.
        response: f64,
    },
    /// Their lengths differ.
    #[error("the reference has {reference} samples and the response {response}: expected the same number")]
    Length {
        /// Of the reference.
        reference: usize,
        /// Of the response.
        response: usize,
    },
    /// The window holds no sample.
    #[error("the window from {from_s} to {to_s} s holds no sample")]
    Window {
        /// Begin, s.
        from_s: f64,
        /// End, s.
        to_s: f64,
    },
}

/// A stretch of time over which errors and peaks are taken, s from the first sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Begin, s.
    pub from_s: f64,
    /// End, s; the sample there belongs to it.
    pub to_s: f64,
}

impl Window {
    /// The indices of its samples.
    fn indices(self, dt: f64, count: usize) -> Range<usize> {
        let from = (self.from_s.max(0.0) / dt - 1e-6).ceil().min(count as f64) as usize;
        let to = ((self.to_s / dt + 1e-6).floor() + 1.0).clamp(0.0, count as f64) as usize;
        from..to.max(from)
    }
}

/// Refuses two motions whose samples are not taken at the same times.
fn comparable(reference: &Motion, response: &Motion) -> Result<(), CompareError> {
    if ((reference.dt - response.dt) / reference.dt).abs() > 1e-9 {
        return Err(CompareError::Interval { reference: reference.dt, response: response.dt });
    }
    if reference.len() != response.len() {
        return Err(CompareError::Length { reference: reference.len(), response: response.len() });
    }
    Ok(())
}

/// A response's errors as it stands, acceleration and displacement: the shifts of [`compare`] take most of its time.
pub(crate) fn compare_unshifted(
    reference: &Motion,
    response: &Motion,
) -> Result<(RelativeError, RelativeError), CompareError> {
    comparable(reference, response)?;
    let of = |a: &[f64], b: &[f64]| relative_error(a, b, reference.dt, 0..reference.len(), Shift::None);
    Ok((of(&reference.acceleration, &response.acceleration), of(&reference.displacement, &response.displacement)))
}

/// Compares a response with its reference, over the whole or over a window of the reference's time.
pub(crate) fn compare(
    reference: &Motion,
    response: &Motion,
    window: Option<Window>,
) -> Result<Comparison, CompareError> {
    comparable(reference, response)?;
    let (dt, count) = (reference.dt, reference.len());
    let window = window.unwrap_or(Window { from_s: 0.0, to_s: reference.duration() });
    let range = window.indices(dt, count);
    if range.is_empty() {
        return Err(CompareError::Window { from_s: window.from_s, to_s: window.to_s });
    }
    let free = Shift::Free { max: MAX_SHIFT };
    let a = |shift| relative_error(&reference.acceleration, &response.acceleration, dt, range.clone(), shift);
    let d = |shift| relative_error(&reference.displacement, &response.displacement, dt, range.clone(), shift);
    let e_a = a(free);
    Ok(Comparison {
        e_a,
        e_a_unshifted: a(Shift::None),
        e_d: d(free),
        e_d_at_acceleration_delay: d(Shift::By(e_a.delay)),
        e_d_unshifted: d(Shift::None),
        reference_peak: peak(&reference.acceleration[range.clone()]),
        response_peak: peak(&response.acceleration[range]),
    })
}

#[cfg(test)]
mod tests {
    use super::super::generate::NEAR_FIELD_MODERATE;
    use super::*;

    /// The motion a number of samples later, at rest before.
    fn late(motion: &Motion, samples: usize) -> Motion {
        let n = motion.len();
        let mut acceleration = vec![0.0; samples];
        acceleration.extend(&motion.acceleration[..n - samples]);
        Motion::from_acceleration(motion.dt, acceleration)
    }

    #[test]
    fn a_late_and_weaker_response_is_taken_apart_into_both() {
        let reference = NEAR_FIELD_MODERATE.generate(2).unwrap().motion();
        let response = late(&reference, 12).scaled(0.9);
        let found = compare(&reference, &response, None).unwrap();
        assert!((found.e_a.delay - 0.06).abs() < 1e-4 && (found.e_d.delay - 0.06).abs() < 2e-3, "{found:?}");
        assert!((found.e_a.ratio - 0.1).abs() < 1e-3 && (found.e_a.squared() - 0.01).abs() < 2e-4, "{found:?}");
        assert!((found.e_d.ratio - 0.1).abs() < 1e-3 && (found.spike_ratio() - 0.9).abs() < 1e-12, "{found:?}");
        assert!(found.e_a_unshifted.ratio > 0.5, "{found:?}");
        assert!((found.e_d_at_acceleration_delay.ratio - 0.1).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn a_window_sees_only_its_own_errors() {
        let reference = NEAR_FIELD_MODERATE.generate(2).unwrap().motion();
        let mut response = reference.clone();
        response.acceleration[1000] += 50.0;
        let at = |from_s, to_s| compare(&reference, &response, Some(Window { from_s, to_s }));
        let quiet = at(5.1, 16.0).unwrap();
        assert!(quiet.e_a_unshifted.ratio == 0.0 && quiet.e_a.ratio == 0.0, "{quiet:?}");
        let loud = at(1.0, 5.0).unwrap();
        assert!(loud.e_a_unshifted.ratio > 1.0 && loud.spike_ratio() > 10.0, "{loud:?}");
        assert_eq!(at(90.0, 91.0), Err(CompareError::Window { from_s: 90.0, to_s: 91.0 }));
        assert_eq!(compare_unshifted(&reference, &response).unwrap().0, {
            let whole = compare(&reference, &response, None).unwrap();
            whole.e_a_unshifted
        });
        let other = Motion { dt: 0.01, ..reference.clone() };
        assert!(matches!(compare(&reference, &other, None), Err(CompareError::Interval { .. })));
        let shorter = Motion::from_acceleration(reference.dt, reference.acceleration[1..].to_vec());
        assert!(matches!(compare(&reference, &shorter, None), Err(CompareError::Length { .. })));
    }
}
