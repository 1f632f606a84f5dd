//! A drive and the recording of it: where in the recording it was played, and how near the table came.
//!
//! The drive is found in the recording by the cross-correlation of velocities, which neither an offset nor the drift of a
//! displacement disturbs. Where the recording holds the reference that the controller was given, the start comes from it, and the
//! delay of the table is what is left between drive and motion; else the start comes from the motion itself, and the delay cannot be
//! known. Both accelerations pass the same 15 Hz 4th-order zero-phase low-pass.

use super::super::condition::Recipe;
use super::super::filter::{Butterworth, FilterError, Pass};
use super::super::resample::{Interpolation, linear, resample};
use super::super::{Motion, record::central_difference};
use super::{CompareError, Comparison, Indices, compare, indices};
use realfft::RealFftPlanner;

/// What a recording holds, evenly sampled, in SI, without gaps.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Recorded<'a> {
    /// Step, s.
    pub dt: f64,
    /// Displacement of the table, m.
    pub displacement: &'a [f64],
    /// Acceleration of the table, m/s2; the second derivative of the displacement where there is none.
    pub acceleration: Option<&'a [f64]>,
    /// The reference that the controller was given, m.
    pub reference: Option<&'a [f64]>,
}

/// A drive beside what the table made of it.
#[derive(Debug, Clone)]
pub(crate) struct Played {
    /// When the drive begins, s after the recording's first sample.
    pub start: f64,
    /// How far the recorded reference is from the drive, RMS over RMS; none where no reference was recorded, and then the start is
    /// the motion's and includes the table's delay.
    pub reference_error: Option<f64>,
    /// Samples of the recording over which the two are compared.
    pub samples: std::ops::Range<usize>,
    /// Share of the drive that the recording holds.
    pub covered: f64,
    /// Mean of the measured displacement less the drive's mean, m: the sensor's zero, and what a gain other than one makes of the
    /// drive's own mean; taken off before the two are compared.
    pub offset: f64,
    /// The drive at the recording's samples, its acceleration low-passed.
    pub wanted: Motion,
    /// What the table did, likewise.
    pub achieved: Motion,
    /// E_a and E_d.
    pub comparison: Comparison,
    /// The laboratory's indices.
    pub indices: Indices,
}

/// Why a drive and a recording are not compared.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub(crate) enum PlayedError {
    /// The drive is not in it.
    #[error(
        "nothing in the recording resembles the drive: the correlation of their velocities is {correlation:.2} at most, expected {least}; \
         name the drive that was played, or check the displacement's column and unit"
    )]
    Elsewhere {
        /// Largest magnitude of the correlation.
        correlation: f64,
        /// What is asked for.
        least: f64,
    },
    /// It moves the other way.
    #[error(
        "the recorded {what} is the drive with its sign turned (correlation {correlation:.2}): correct the sign of one"
    )]
    Turned {
        /// Which signal.
        what: &'static str,
        /// The correlation.
        correlation: f64,
    },
    /// Too little of it.
    #[error("the recording holds {seconds:.2} s of the drive, fewer than {least} samples")]
    TooShort {
        /// Seconds of the drive.
        seconds: f64,
        /// Fewest samples.
        least: usize,
    },
    /// A signal could not be filtered.
    #[error(transparent)]
    Filter(#[from] FilterError),
    /// The motions could not be compared.
    #[error(transparent)]
    Compare(#[from] CompareError),
    /// A spectrum could not be taken.
    #[error(transparent)]
    Spectrum(#[from] super::super::spectrum::SpectrumError),
}

/// Correlation of velocities below which the recording is of something else.
const LEAST: f64 = 0.6;
/// Fewest samples in common.
const SAMPLES: usize = 64;
/// Steps of the drive at most before it is interpolated on straight lines, s: an error of 1e-4 at 15 Hz.
const FINE: f64 = 3e-4;

/// Finds a drive in a recording and compares the two.
pub(crate) fn played(drive: &Motion, recorded: &Recorded<'_>) -> Result<Played, PlayedError> {
    let dt = recorded.dt;
    let by_motion = lag(drive, recorded.displacement, dt, "displacement")?;
    let by_reference = recorded.reference.map(|r| lag(drive, r, dt, "reference")).transpose()?;
    let start = by_reference.unwrap_or(by_motion);
    let count = recorded.displacement.len();
    let first = (start / dt - 1e-6).ceil().max(0.0) as usize;
    let last = ((start + drive.duration()) / dt + 1e-6).floor().max(0.0) as usize;
    let samples = first..(last + 1).min(count);
    if samples.len() < SAMPLES {
        return Err(PlayedError::TooShort { seconds: samples.len() as f64 * dt, least: SAMPLES });
    }
    let wanted = placed(drive, start, dt, &samples)?;
    let mut achieved = measured(recorded, &samples)?;
    let offset = mean_difference(&achieved.displacement, &wanted.displacement);
    achieved.displacement.iter_mut().for_each(|x| *x -= offset);
    let reference_error = recorded.reference.map(|r| {
        let r: Vec<f64> = r[samples.clone()].to_vec();
        let level = mean_difference(&r, &wanted.displacement);
        let missed: f64 = r.iter().zip(&wanted.displacement).map(|(a, b)| (a - level - b).powi(2)).sum();
        (missed / wanted.displacement.iter().map(|x| x * x).sum::<f64>()).sqrt()
    });
    Ok(Played {
        start,
        reference_error,
        covered: (samples.len() as f64 * dt / drive.duration()).min(1.0),
        offset,
        comparison: compare(&wanted, &achieved, None)?,
        indices: indices(&wanted.acceleration, &achieved.acceleration, dt)?,
        samples,
        wanted,
        achieved,
    })
}

/// When the drive begins in a recorded displacement, s: the peak of the velocities' cross-correlation, between samples by a
/// parabola.
fn lag(drive: &Motion, recorded: &[f64], dt: f64, what: &'static str) -> Result<f64, PlayedError> {
    let smooth = |x: Vec<f64>| fitting(dt).map_or_else(|| Ok(x.clone()), |f| f.apply(&x, dt, Pass::ZeroPhase));
    let fine = finely(&drive.displacement, drive.dt);
    let count = (drive.duration() / dt).floor() as usize + 1;
    let on_grid: Vec<f64> = (0..count).map(|k| linear(&fine.1, k as f64 * dt / fine.0)).collect();
    let a = smooth(central_difference(&on_grid, dt))?;
    let b = smooth(central_difference(recorded, dt))?;
    let correlation = correlate(&a, &b);
    let energy = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let size = (energy(&a) * energy(&b)).sqrt().max(f64::MIN_POSITIVE);
    let at = |i: usize| correlation[i] / size;
    let peak = (0..correlation.len()).max_by(|&i, &j| at(i).abs().total_cmp(&at(j).abs())).unwrap_or(0);
    // The recording may hold more than the drive, whose energy alone counts.
    let lag = peak as isize - (a.len().cast_signed() - 1);
    let inside = |k: usize| usize::try_from(k.cast_signed() + lag).ok().and_then(|k| b.get(k)).map_or(0.0, |x| x * x);
    let shared = (0..a.len()).map(inside).sum::<f64>();
    let value = correlation[peak] / (energy(&a) * shared).sqrt().max(f64::MIN_POSITIVE);
    if value.abs() < LEAST {
        return Err(PlayedError::Elsewhere { correlation: value.abs(), least: LEAST });
    }
    if value < 0.0 {
        return Err(PlayedError::Turned { what, correlation: value });
    }
    let between = if peak > 0 && peak + 1 < correlation.len() {
        let (l, m, r) = (at(peak - 1), at(peak), at(peak + 1));
        let bend = l - 2.0 * m + r;
        if bend < 0.0 { 0.5 * (l - r) / bend } else { 0.0 }
    } else {
        0.0
    };
    Ok((lag as f64 + between) * dt)
}

/// Cross-correlation of `a` within `b`: element `i` is for a lag of `i - (a.len() - 1)` samples.
fn correlate(a: &[f64], b: &[f64]) -> Vec<f64> {
    let count = a.len() + b.len() - 1;
    let size = count.next_power_of_two();
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, inverse) = (planner.plan_fft_forward(size), planner.plan_fft_inverse(size));
    let transform = |signal: &mut dyn Iterator<Item = f64>| {
        let mut padded: Vec<f64> = signal.collect();
        padded.resize(size, 0.0);
        let mut bins = forward.make_output_vec();
        // The buffers are made for this plan: their lengths cannot be wrong.
        let _ = forward.process(&mut padded, &mut bins);
        bins
    };
    let (a, mut bins) = (transform(&mut a.iter().rev().copied()), transform(&mut b.iter().copied()));
    bins.iter_mut().zip(&a).for_each(|(b, a)| *b *= *a);
    let mut out = inverse.make_output_vec();
    if let Some(first) = bins.first_mut() {
        first.im = 0.0;
    }
    if let Some(last) = bins.last_mut() {
        last.im = 0.0;
    }
    let _ = inverse.process(&mut bins, &mut out);
    out.iter().take(count).map(|x| x / size as f64).collect()
}

/// A signal at steps so fine that straight lines between them do: the step and the samples.
fn finely(signal: &[f64], dt: f64) -> (f64, Vec<f64>) {
    let parts = (dt / FINE).ceil().max(1.0);
    if parts <= 1.0 {
        return (dt, signal.to_vec());
    }
    (dt / parts, resample(signal, dt, dt / parts, Interpolation::BandLimited))
}

/// The drive at the recording's samples.
fn placed(drive: &Motion, start: f64, dt: f64, samples: &std::ops::Range<usize>) -> Result<Motion, PlayedError> {
    let filter = fitting(drive.dt);
    let smooth = filter.map_or_else(
        || Ok(drive.acceleration.clone()),
        |filter| filter.apply(&drive.acceleration, drive.dt, Pass::ZeroPhase),
    )?;
    let at = |signal: &[f64]| -> Vec<f64> {
        let (step, fine) = finely(signal, drive.dt);
        samples.clone().map(|k| linear(&fine, (k as f64 * dt - start) / step)).collect()
    };
    let (displacement, velocity) = (at(&drive.displacement), at(&drive.velocity));
    Ok(Motion { dt, displacement, velocity, acceleration: at(&smooth) })
}

/// The 15 Hz low-pass where signals of a step hold anything above it.
fn fitting(dt: f64) -> Option<Butterworth> {
    (0.45 / dt > 15.0).then(Recipe::table1_response)
}

/// What the table did over these samples.
fn measured(recorded: &Recorded<'_>, samples: &std::ops::Range<usize>) -> Result<Motion, PlayedError> {
    let dt = recorded.dt;
    let velocity = central_difference(recorded.displacement, dt);
    let derived;
    let acceleration = if let Some(measured) = recorded.acceleration {
        measured
    } else {
        derived = crate::recording::signal::curvature(recorded.displacement, dt);
        &derived
    };
    let level = acceleration.iter().sum::<f64>() / acceleration.len().max(1) as f64;
    let centred: Vec<f64> = acceleration.iter().map(|a| a - level).collect();
    let smooth = fitting(dt).map_or_else(|| Ok(centred.clone()), |f| f.apply(&centred, dt, Pass::ZeroPhase))?;
    let part = |signal: &[f64]| signal[samples.clone()].to_vec();
    Ok(Motion { dt, displacement: part(recorded.displacement), velocity: part(&velocity), acceleration: part(&smooth) })
}

fn mean_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a - b).sum::<f64>() / a.len().min(b.len()).max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::generate::{FAR_FIELD, NEAR_FIELD_MODERATE};

    /// A recording at 204.8 Hz that begins 3.21 s before the drive; the table is 12 ms late and 3 % weak, its sensor 5 mm off.
    fn recording(drive: &Motion, late: f64) -> Vec<f64> {
        let (dt, before) = (1.0 / 204.8, 3.21);
        let (step, fine) = finely(&drive.displacement, drive.dt);
        let count = ((drive.duration() + 6.0) / dt) as usize;
        (0..count).map(|k| 0.97 * linear(&fine, (k as f64 * dt - before - late) / step) + 5e-3).collect()
    }

    #[test]
    fn start_delay_gain_and_offset_are_found() {
        let drive = NEAR_FIELD_MODERATE.generate(4).unwrap().motion();
        let (x, r) = (recording(&drive, 0.012), recording(&drive, 0.0));
        let recorded = Recorded { dt: 1.0 / 204.8, displacement: &x, acceleration: None, reference: Some(&r) };
        let found = played(&drive, &recorded).unwrap();
        assert!((found.start - 3.21).abs() < 2e-4, "{}", found.start);
        assert!((found.indices.delay - 0.012).abs() < 3e-4, "{}", found.indices.delay);
        assert!((found.indices.gain - 0.97).abs() < 0.01 && found.indices.coherence > 0.99, "{:?}", found.indices);
        // The table's 3 % of weakness takes as much of the drive's own mean from it.
        let mean = drive.displacement.iter().sum::<f64>() / drive.displacement.len() as f64;
        assert!((found.offset - (5e-3 - 0.03 * mean)).abs() < 2e-4 && found.covered > 0.999, "{}", found.offset);
        assert!(found.reference_error.unwrap() < 0.04 && found.comparison.e_d.ratio < 0.04);
        // Without the reference the delay cannot be distinguished from the start.
        let blind = played(&drive, &Recorded { reference: None, ..recorded }).unwrap();
        assert!((blind.start - 3.222).abs() < 3e-4 && blind.indices.delay.abs() < 3e-4, "{}", blind.start);
    }

    #[test]
    fn another_drive_and_a_turned_sign_are_refused() {
        let drive = NEAR_FIELD_MODERATE.generate(4).unwrap().motion();
        let other = FAR_FIELD.generate(5).unwrap().motion();
        let x = recording(&drive, 0.0);
        let of = |x: &[f64], drive: &Motion| {
            played(drive, &Recorded { dt: 1.0 / 204.8, displacement: x, acceleration: None, reference: None })
        };
        assert!(matches!(of(&x, &other), Err(PlayedError::Elsewhere { .. })));
        let turned: Vec<f64> = x.iter().map(|x| -x).collect();
        assert!(matches!(of(&turned, &drive), Err(PlayedError::Turned { what: "displacement", .. })));
        assert!(matches!(of(&x[..700], &drive), Err(PlayedError::Elsewhere { .. } | PlayedError::TooShort { .. })));
    }
}
