//! A fit by name: from a motion to the motion that the table is given instead, limits checked on what is written.
//!
//! A record holds acceleration samples, and whoever reads it integrates them as linear in between ([`Motion`]). So what a
//! fit gives up, e, is taken off as a' = a - (e[k+1] - e[k-1]) / 2 dt, and a motion untouched stays untouched to the last
//! digit. Integrated again that gives e averaged over its neighbours, which can pass a limit by a little where the
//! reference bends, and linear acceleration lets the velocity pass between two samples what it keeps at both; the limits are
//! then tightened by as much and the fit repeated. What is left, under [`KEPT`], is scaled off, so that a limit kept is kept.

use super::super::record::central_difference;
use super::super::{Motion, peak};
use super::online::{self, Modifier};
use super::spectrum::{self, Band, SpectrumFit};
use super::{FitError, Limits, Norm, Reference, convex, steepest, taut};

/// How a record is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// The paper's Eq. 10.
    Clip,
    /// The taut string: velocity and end displacement only.
    Taut,
    /// The nearest waveform within every limit.
    Convex(Norm),
    /// The nearest waveform that keeps a band of the response spectrum.
    Spectrum(Band),
    /// The core's causal modifier.
    Causal,
    /// The core's preview modifier, with so many seconds of preview.
    Preview(f64),
}

/// A motion fitted to a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Modified {
    /// What the table is given.
    pub motion: Motion,
    /// No motion within the limits is nearer in the method's norm; `None` where the method proves nothing.
    pub bound: Option<f64>,
    /// The band, where the spectrum was to be kept.
    pub spectrum: Option<SpectrumFit>,
    /// The limits that the last repetition was fitted to.
    pub tightened: Limits,
}

/// A limit counts as kept within this share of it: far below what a sensor resolves.
const KEPT: f64 = 1e-5;
/// Repetitions at most.
const REPETITIONS: usize = 6;

/// Fits `motion` to `limits`. `progress` is told what is being done.
pub fn modify(
    motion: &Motion,
    limits: &Limits,
    method: Method,
    mut progress: impl FnMut(&str),
) -> Result<Modified, FitError> {
    let start = motion.displacement.first().copied().unwrap_or(0.0);
    let reference = Reference::new(motion.dt, motion.velocity.clone(), start)?;
    let mut tightened = *limits;
    let mut bound = None;
    for repetition in 0..REPETITIONS {
        if repetition > 0 {
            progress("tightening the limits to what integration makes of the samples");
        }
        let (drive, proven, spectrum) = fit(motion, &reference, &tightened, method, &mut progress)?;
        if repetition == 0 {
            bound = proven;
        }
        let next = tighter(&drive, limits, &tightened, method).filter(|_| repetition + 1 < REPETITIONS);
        let Some(next) = next else {
            return Ok(Modified { motion: within(drive, limits, method), bound, spectrum, tightened });
        };
        tightened = next;
    }
    Err(FitError::Solver("the limits were not met after tightening".into()))
}

/// The motion as it is written, the bound proven, and the spectrum where it was kept.
fn fit(
    motion: &Motion,
    reference: &Reference,
    limits: &Limits,
    method: Method,
    progress: &mut impl FnMut(&str),
) -> Result<(Motion, Option<f64>, Option<SpectrumFit>), FitError> {
    let fitted = match method {
        Method::Clip => online::fit(reference, limits, Modifier::Clip),
        Method::Causal => online::fit(reference, limits, Modifier::Causal),
        Method::Preview(seconds) => online::fit(reference, limits, Modifier::Preview(seconds)),
        Method::Taut => taut::fit(reference, limits),
        Method::Convex(norm) => {
            progress("solving the convex program");
            convex::fit(reference, limits, norm)
        }
        Method::Spectrum(band) => {
            let found = spectrum::fit(motion, limits, &band, |round, deviation| {
                progress(&format!("round {round}: S_a within {:.1} %", 100.0 * deviation));
            })?;
            return Ok((found.motion.clone(), None, Some(found)));
        }
    }?;
    Ok((drive(motion, reference, &fitted.velocity), fitted.bound, None))
}

/// The motion whose acceleration is the reference's less the slope of what was given up.
fn drive(motion: &Motion, reference: &Reference, velocity: &[f64]) -> Motion {
    let mut given_up: Vec<f64> = reference.velocity.iter().zip(velocity).map(|(r, v)| r - v).collect();
    // The table starts at rest, whatever a filter has made of the reference's first sample.
    if let (Some(first), Some(r)) = (given_up.first_mut(), reference.velocity.first()) {
        *first = *r;
    }
    let slope = central_difference(&given_up, motion.dt);
    let acceleration = motion.acceleration.iter().zip(&slope).map(|(a, s)| a - s).collect();
    Motion::from_state(motion.dt, acceleration, reference.start, 0.0)
}

/// A limit beside what a motion does.
struct Kept {
    found: f64,
    limit: Option<f64>,
    tightened: Option<f64>,
}

/// The limits that a method looks at, in the order velocity, stroke, acceleration, jerk.
fn looked_at(drive: &Motion, limits: &Limits, tightened: &Limits, method: Method) -> [Kept; 4] {
    let all = matches!(method, Method::Convex(_) | Method::Spectrum(_));
    let stroke = all || matches!(method, Method::Causal | Method::Preview(_));
    let (far, fast) = drive.peaks_between();
    let kept = |looked_at: bool, found: f64, limit: Option<f64>, tightened: Option<f64>| Kept {
        found,
        limit: limit.filter(|_| looked_at),
        tightened,
    };
    [
        kept(true, fast, Some(limits.velocity), Some(tightened.velocity)),
        kept(stroke, far, limits.stroke, tightened.stroke),
        kept(all, peak(&drive.acceleration), limits.acceleration, tightened.acceleration),
        kept(all, steepest(&drive.acceleration, drive.dt), limits.jerk, tightened.jerk),
    ]
}

/// The limits to fit to next, where `drive` breaks one that the method looks at.
fn tighter(drive: &Motion, limits: &Limits, tightened: &Limits, method: Method) -> Option<Limits> {
    let mut broken = false;
    let next = looked_at(drive, limits, tightened, method).map(|kept| match (kept.limit, kept.tightened) {
        (Some(limit), Some(value)) if kept.found > limit * (1.0 + KEPT) => {
            broken = true;
            Some(value * (1.0 - 0.1 * KEPT) * limit / kept.found)
        }
        (_, value) => value,
    });
    let [velocity, stroke, acceleration, jerk] = next;
    let velocity = velocity.unwrap_or(tightened.velocity);
    broken.then_some(Limits { velocity, stroke, acceleration, jerk, ..*tightened })
}

/// The motion made smaller by the little that the last repetition left above a limit.
fn within(drive: Motion, limits: &Limits, method: Method) -> Motion {
    let shares =
        looked_at(&drive, limits, limits, method).map(|kept| kept.limit.map_or(1.0, |limit| limit / kept.found));
    let share = shares.into_iter().fold(1.0, f64::min);
    if share < 1.0 { drive.scaled(share * (1.0 - 1e-12)) } else { drive }
}
