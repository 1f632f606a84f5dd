//! A motion made for a required spectrum: sines of random phase under a trapezoid, their amplitudes corrected by what the
//! spectrum shows until it lies above the required one by a stated margin. Sines inside the standard's band can reach the spectrum and
//! still peak below the zero-period acceleration; what is lacking, a short burst above the band adds.

use super::super::spectrum::{SpectrumError, response_spectrum};
use super::{QualifyError, Requirement, ScoredModel, judge, rigid};
use rand::{Rng as _, SeedableRng as _};
use std::f64::consts::PI;

/// The shape of a synthetic motion over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Rate, Hz.
    pub rate: f64,
    /// Rise, s.
    pub rise: f64,
    /// Full strength, s.
    pub hold: f64,
    /// Decay, s.
    pub decay: f64,
}

impl Shape {
    /// 5, 20 and 5 s at 400 Hz: what AC156 asks for.
    pub const USUAL: Self = Self { rate: 400.0, rise: 5.0, hold: 20.0, decay: 5.0 };

    fn envelope(&self, t: f64) -> f64 {
        let end = self.rise + self.hold + self.decay;
        (t / self.rise).min((end - t) / self.decay).clamp(0.0, 1.0)
    }
}

/// Sines an octave.
const SINES: f64 = 24.0;
/// Corrections.
const ROUNDS: usize = 8;

/// An acceleration, m/s2, whose spectrum is at the least `margin` times what is required. The same seed gives the same motion; other seeds give motions that are independent.
pub fn synthesise(asked: Requirement<'_>, margin: f64, shape: &Shape, seed: u64) -> Result<Vec<f64>, QualifyError> {
    let dt = 1.0 / shape.rate;
    let plain = sines(asked, margin, shape, seed)?;
    let Some(motion) = rigid::raised_acceleration(&plain, dt, asked) else { return Ok(plain) };
    // The burst may take from an oscillator what another sine gave it.
    let ScoredModel { margin: found, .. } = judge(&motion, dt, &[], asked)?;
    let factor = (margin / found).max(1.0);
    Ok(motion.iter().map(|a| a * factor).collect())
}

/// The sines alone: the spectrum is reached, the zero-period acceleration is what comes of it.
pub(super) fn sines(asked: Requirement<'_>, margin: f64, shape: &Shape, seed: u64) -> Result<Vec<f64>, QualifyError> {
    let dt = 1.0 / shape.rate;
    let Requirement { standard, required, lowest } = asked;
    let highest = standard.band.1 * 1.15;
    let count = ((highest / (0.8 * lowest)).log2() * SINES).ceil() as usize;
    let mut dice = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let mut share = || f64::from(dice.next_u32()) / 2f64.powi(32);
    // Each seed has frequencies of its own: two axes of the same sines would be coherent whatever their phases.
    let frequencies: Vec<f64> =
        (0..=count).map(|k| 0.8 * lowest * ((k as f64 + share() - 0.5) / SINES).exp2()).collect();
    let phases: Vec<f64> = frequencies.iter().map(|_| 2.0 * PI * share()).collect();
    let wanted: Vec<f64> = frequencies
        .iter()
        .map(|f| required.at(*f).unwrap_or_else(|| required.points.first().map_or(0.0, |p| p.1)))
        .collect();
    let mut amplitudes: Vec<f64> = wanted.iter().map(|a| 0.05 * a).collect();
    for _ in 0..ROUNDS {
        let motion = sum(&frequencies, &phases, &amplitudes, shape);
        let reached = spectrum(&motion, dt, required.damping, &frequencies)?;
        for ((amplitude, wanted), reached) in amplitudes.iter_mut().zip(&wanted).zip(&reached) {
            *amplitude *= (wanted / reached).clamp(0.5, 2.0);
        }
    }
    let motion = sum(&frequencies, &phases, &amplitudes, shape);
    // A spectrum grows with its motion, so one factor sets the margin.
    let ScoredModel { margin: found, .. } = judge(&motion, dt, &[], asked)?;
    Ok(motion.iter().map(|a| a * margin / found).collect())
}

fn spectrum(motion: &[f64], dt: f64, damping: f64, frequencies: &[f64]) -> Result<Vec<f64>, SpectrumError> {
    let periods: Vec<f64> = frequencies.iter().map(|f| 1.0 / f).collect();
    Ok(response_spectrum(motion, dt, damping, &periods)?.s_a)
}

fn sum(frequencies: &[f64], phases: &[f64], amplitudes: &[f64], shape: &Shape) -> Vec<f64> {
    let count = ((shape.rise + shape.hold + shape.decay) * shape.rate).round() as usize;
    let at = |k: usize| {
        let t = k as f64 / shape.rate;
        let sines = frequencies.iter().zip(phases).zip(amplitudes);
        shape.envelope(t) * sines.map(|((f, phase), a)| a * (2.0 * PI * f * t + phase).sin()).sum::<f64>()
    };
    (0..=count).map(at).collect()
}
