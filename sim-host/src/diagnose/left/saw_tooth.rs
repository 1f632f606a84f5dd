//! A saw-tooth on the displacement sensor: a line and its harmonics, each of which falls off and is in step as a saw-tooth's are.

use super::rows::Look;
use crate::diagnose::residual::residual;
use crate::identify::data::Channel;
use crate::recording::SetUpFinding;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Harmonics that are compared.
const HARMONICS: usize = 6;
/// Phases that are tried.
const PHASES: usize = 48;
/// Fewest periods of a run.
const PERIODS: f64 = 8.0;
/// Squares that a saw-tooth takes away in the longest run, and in another, which noise does not.
const CERTAIN: f64 = 70.0;
const AGAIN: f64 = 25.0;
/// Share of the power of the harmonics that is a saw-tooth's: of one line alone it is two thirds.
const IN_STEP: f64 = 0.8;
/// Power over what is usual beside it from which the motion has a line there itself.
const DRIVEN: f64 = 30.0;
/// Bins on either side that say what is usual.
const BESIDE: usize = 96;
/// Factor by which a run is padded, and the fewest samples of one.
const PADDED: usize = 4;
const FEWEST: usize = 512;

/// The spectrum of a run's residual.
struct Spectrum {
    /// Amplitudes by frequency, of a sine of amplitude one minus i.
    amplitudes: Vec<Complex64>,
    /// Mean square of an amplitude around each bin.
    usual: Vec<f64>,
    /// Width of a bin, Hz.
    hz: f64,
}

/// A saw-tooth as it fits best.
#[derive(Debug, Clone, Copy)]
struct SawTooth {
    frequency: f64,
    /// From peak to peak.
    height: f64,
    /// Squares that it takes away.
    gain: f64,
    /// Share of the harmonics' power that it is.
    share: f64,
}

/// Adds the saw-tooth of the displacement sensor, where it has one.
pub(super) fn report(looks: &[Look], (channel, noise): (Channel, f64), findings: &mut Vec<SetUpFinding>) {
    if channel != Channel::Displacement {
        return;
    }
    let mut sorted: Vec<&Look> = looks.iter().filter(|(run, _)| run.len() >= FEWEST).collect();
    sorted.sort_by_key(|(run, _)| std::cmp::Reverse(run.len()));
    let mut spectra = sorted.iter().filter_map(|&&look| Some((look, of(look)?)));
    let Some((look, longest)) = spectra.next() else { return };
    let found = longest.strongest().filter(|found| found.gain > CERTAIN && found.share > IN_STEP);
    let Some(found) = found.filter(|found| !is_driven(look, found.frequency)) else { return };
    if spectra.next().is_none_or(|(_, other)| other.near(found.frequency, longest.hz).gain > AGAIN) {
        findings.push(SetUpFinding::saw_tooth(channel.name(), 0.5 * noise * found.height, channel.unit()));
    }
}

/// The spectrum of what is left of the displacement in a run.
fn of((run, predicted): Look) -> Option<Spectrum> {
    Some(Spectrum::of(&residual(run, predicted, Channel::Displacement)?, run.dt))
}

/// Whether the motion has a line at a frequency, whose leftovers would be one too.
fn is_driven((run, predicted): Look, frequency: f64) -> bool {
    let moved = Spectrum::of(&predicted.displacement, run.dt);
    let bin = (frequency / moved.hz).round() as usize;
    moved.amplitudes.get(bin).is_some_and(|a| a.norm_sqr() > DRIVEN * moved.usual[bin])
}

impl Spectrum {
    fn of(series: &[f64], dt: f64) -> Self {
        let size = PADDED * series.len().next_power_of_two();
        let mean = series.iter().filter(|x| x.is_finite()).sum::<f64>() / series.len().max(1) as f64;
        let clean = |x: &f64| if x.is_finite() { x - mean } else { 0.0 };
        let mut padded: Vec<f64> = series.iter().map(clean).collect();
        padded.resize(size, 0.0);
        let transform = RealFftPlanner::<f64>::new().plan_fft_forward(size);
        let mut amplitudes = transform.make_output_vec();
        // Lengths agree by construction, which is all that can fail.
        let _ = transform.process(&mut padded, &mut amplitudes);
        let scale = 2.0 / series.len().max(1) as f64;
        for amplitude in &mut amplitudes {
            *amplitude *= scale;
        }
        Self { usual: usual(&amplitudes), amplitudes, hz: 1.0 / (size as f64 * dt) }
    }

    /// The strongest saw-tooth of a frequency that repeats often enough.
    fn strongest(&self) -> Option<SawTooth> {
        let bins = self.amplitudes.len() as f64;
        let (first, last) = (PERIODS * PADDED as f64 * HARMONICS as f64, bins - 1.0);
        let steps = (first as usize)..(last as usize);
        // A step moves the last harmonic by a bin.
        let each = steps.filter_map(|step| self.at(step as f64 / HARMONICS as f64));
        each.max_by(|a, b| a.gain.total_cmp(&b.gain))
    }

    /// The strongest saw-tooth within a bin of another spectrum, of `width` (Hz), of a frequency.
    fn near(&self, frequency: f64, width: f64) -> SawTooth {
        let steps = (4.0 * HARMONICS as f64 * (width / self.hz).max(1.0)) as i32;
        let bin = |i: i32| frequency / self.hz + f64::from(i) / HARMONICS as f64;
        let each = (-steps..=steps).filter_map(|i| self.at(bin(i)));
        let none = SawTooth { frequency, height: 0.0, gain: 0.0, share: 0.0 };
        each.max_by(|a, b| a.gain.total_cmp(&b.gain)).unwrap_or(none)
    }

    /// The saw-tooth at a frequency, in bins.
    fn at(&self, bin: f64) -> Option<SawTooth> {
        let mut harmonics = [(Complex64::default(), 0.0); HARMONICS];
        for (k, harmonic) in harmonics.iter_mut().enumerate() {
            let place = (bin * (k + 1) as f64).round() as usize;
            *harmonic = (*self.amplitudes.get(place)?, *self.usual.get(place)?);
        }
        let power: f64 = harmonics.iter().map(|(a, usual)| 2.0 * a.norm_sqr() / usual).sum();
        if power < AGAIN {
            return None;
        }
        let of_phase = |i: usize| in_step(&harmonics, i as f64 / PHASES as f64);
        let (gain, height) = (0..PHASES).map(of_phase).max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(SawTooth { frequency: bin * self.hz, height, gain, share: gain / power })
    }
}

/// Squares that a saw-tooth of this phase (turns) takes away, and its height.
fn in_step(harmonics: &[(Complex64, f64)], phase: f64) -> (f64, f64) {
    let (mut both, mut own) = (0.0, 0.0);
    for (k, (amplitude, usual)) in harmonics.iter().enumerate() {
        let order = (k + 1) as f64;
        // That of a height of one: sin(2 pi k (f t + phase)) / (pi k).
        let saw = Complex64::from_polar(1.0 / (PI * order), TAU * order * phase - 0.25 * TAU);
        both += (amplitude * saw.conj()).re / usual;
        own += saw.norm_sqr() / usual;
    }
    (2.0 * both * both / own, (both / own).abs())
}

/// Mean square of the amplitudes around each bin, the loudest of them left out as often as a line takes.
fn usual(amplitudes: &[Complex64]) -> Vec<f64> {
    let powers: Vec<f64> = amplitudes.iter().map(Complex64::norm_sqr).collect();
    let median = |at: usize| {
        let mut beside = powers[at.saturating_sub(BESIDE)..(at + BESIDE).min(powers.len())].to_vec();
        let middle = beside.len() / 2;
        // Of an exponential variable the mean is the median over ln 2.
        *beside.select_nth_unstable_by(middle, f64::total_cmp).1 / std::f64::consts::LN_2
    };
    let stride = BESIDE / 2;
    let coarse: Vec<f64> = (0..powers.len()).step_by(stride).map(median).collect();
    (0..powers.len()).map(|i| coarse[i / stride].max(f64::MIN_POSITIVE)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::fit::tests::gauss;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;

    /// A minute at 250 Hz of noise and what is added to it.
    fn spectrum(added: impl Fn(f64) -> f64) -> Spectrum {
        let mut noise = ChaCha8Rng::seed_from_u64(5);
        let series: Vec<f64> = (0..15_000).map(|k| gauss(&mut noise) + added(f64::from(k) * 4e-3)).collect();
        Spectrum::of(&series, 4e-3)
    }

    fn is_saw_tooth(found: SawTooth) -> bool {
        found.gain > CERTAIN && found.share > IN_STEP
    }

    /// One of a third of the noise is found with its frequency and height; a sine, a saw-tooth's harmonics out of step and noise are none.
    #[test]
    fn a_saw_tooth_is_told_from_lines_and_from_noise() {
        let saw = |t: f64| 0.7 * (0.5 - (1.437 * t + 0.2).fract());
        let found = spectrum(saw).strongest().unwrap();
        assert!(is_saw_tooth(found), "{found:?}");
        assert!((found.frequency - 1.437).abs() < 0.003 && (found.height / 0.7 - 1.0).abs() < 0.15, "{found:?}");
        let sine = spectrum(|t| 0.5 * (TAU * 1.437 * t).sin()).strongest().unwrap();
        assert!(!is_saw_tooth(sine), "{sine:?}");
        let wrong = |k: i32| [0.0, 1.2, 3.9, 2.2, 5.1, 0.7][k as usize % 6];
        let line = |t: f64, k: i32| (TAU * 1.437 * f64::from(k) * t + wrong(k)).sin() / f64::from(k);
        let lines = spectrum(|t| 0.3 * (1..6).map(|k| line(t, k)).sum::<f64>()).strongest().unwrap();
        assert!(!is_saw_tooth(lines), "{lines:?}");
        assert!(spectrum(|_| 0.0).strongest().is_none_or(|found| !is_saw_tooth(found)));
    }
}
