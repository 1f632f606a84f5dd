//! What laboratories call a good test: the three indices of NCREE (Chen et al., 2018, by name; the definitions are ours, since
//! theirs are not public), and delay, gain and coherence.

use super::super::peak;
use super::super::spectrum::{SpectrumError, response_spectrum};
use super::coherence::{Coherence, coherence};
use super::{MAX_SHIFT, Shift, relative_error};
use serde_json::{Value, json};

/// How near a response is to its reference, both accelerations through the same filter.
#[derive(Debug, Clone, PartialEq)]
pub struct Indices {
    /// Waveform: `||y - a|| / ||a||`, no shift.
    pub waveform: f64,
    /// The same with the delay taken out.
    pub shifted: f64,
    /// Spectrum: share of the periods, 1/12 octave apart, at which the response spectra (5 %) differ by more than 10 %.
    pub spectrum: f64,
    /// The same for 20 %.
    pub spectrum_20: f64,
    /// Peak: `max |y| / max |a| - 1`.
    pub peak: f64,
    /// How far the response lags, s: the shift at which the error is least, up to half a second.
    pub delay: f64,
    /// RMS of the error, m/s2, no shift.
    pub rms: f64,
    /// RMS of the error with the delay taken out, m/s2.
    pub rms_less_delay: f64,
    /// RMS of the error over the peak of the reference.
    pub rms_of_peak: f64,
    /// Magnitude of the transfer from reference to response from 0.5 to 15 Hz, weighted by the reference's power; NaN where too few
    /// windows are averaged or nothing is coherent.
    pub gain: f64,
    /// Coherence over the same band, weighted so.
    pub coherence: f64,
    /// The transfer at some frequencies.
    pub transfer: Vec<At>,
    /// RMS of the error by band.
    pub bands: Vec<BandError>,
}

/// The transfer from reference to response at a frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct At {
    /// Hz.
    pub frequency: f64,
    /// Magnitude; NaN where the coherence is below 0.8.
    pub gain: f64,
    /// Phase, degrees, negative where the response lags; NaN likewise.
    pub phase: f64,
    /// Coherence.
    pub coherence: f64,
}

/// What of the error lies in a band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandError {
    /// Hz.
    pub from: f64,
    /// Hz.
    pub to: f64,
    /// RMS of the error there, m/s2.
    pub rms: f64,
}

impl Indices {
    /// The shape that docs/formats.md states; what is not known is null.
    pub fn json(&self) -> Value {
        let transfer = self.transfer.iter().map(
            |at| json!({"frequency_hz": at.frequency, "gain": at.gain, "phase_deg": at.phase, "coherence": at.coherence}),
        );
        let bands = self.bands.iter().map(|b| json!({"from_hz": b.from, "to_hz": b.to, "rms": b.rms}));
        json!({
            "waveform": self.waveform, "spectrum": self.spectrum, "spectrum_20": self.spectrum_20, "peak": self.peak,
            "delay_s": self.delay, "rms": self.rms, "rms_less_delay": self.rms_less_delay, "rms_of_peak": self.rms_of_peak,
            "gain": self.gain, "coherence": self.coherence,
            "transfer": transfer.collect::<Vec<_>>(), "error_bands": bands.collect::<Vec<_>>(),
        })
    }
}

/// Band over which gain and coherence are taken, Hz.
const BAND: (f64, f64) = (0.5, 15.0);
/// Coherence below which a transfer says nothing.
const TRUSTED: f64 = 0.8;
/// Windows that the reference's power must be spread over: of two signals that know nothing of each other three have a coherence beyond
/// [`TRUSTED`] in one of twenty frequencies (`1 - 0.05^(1/2)`), two in one of five.
const SPREAD: f64 = 3.0;
/// Windows to average at least.
const WINDOWS: usize = 8;
/// Longest window, s.
const LONGEST: f64 = 10.0;
/// Frequencies at which the transfer is told, Hz.
const TOLD: [f64; 5] = [1.0, 2.0, 5.0, 10.0, 20.0];
/// Edges of the bands of the error, Hz.
const EDGES: [f64; 5] = [0.1, 1.0, 5.0, 15.0, 33.0];
/// Periods of the spectra: from this frequency to that, Hz.
const SPECTRUM: (f64, f64) = (0.5, 33.0);
/// Rate at which spectra and transfers are taken at most, Hz: six times the highest frequency told.
const ENOUGH: f64 = 200.0;

/// The indices of a response against its reference, accelerations (m/s2) every `dt` s of the same length.
pub(crate) fn indices(reference: &[f64], response: &[f64], dt: f64) -> Result<Indices, SpectrumError> {
    let count = reference.len().min(response.len());
    let (reference, response) = (&reference[..count], &response[..count]);
    let range = 0..count;
    let still = relative_error(reference, response, dt, range.clone(), Shift::None).ratio;
    let shifted = relative_error(reference, response, dt, range, Shift::Free { max: MAX_SHIFT });
    let size = (reference.iter().map(|a| a * a).sum::<f64>() / count.max(1) as f64).sqrt();
    let every = ((1.0 / (dt * ENOUGH)).floor() as usize).max(1);
    let thin = |signal: &[f64]| signal.iter().step_by(every).copied().collect::<Vec<_>>();
    let (a, y, step) = (thin(reference), thin(response), dt * every as f64);
    let apart = apart(&a, &y, step)?;
    let share = |most: f64| apart.iter().filter(|d| **d > most).count() as f64 / apart.len().max(1) as f64;
    let transfer = transfer(&a, &y, step);
    let (gain, coherent) = transfer.as_ref().map_or((f64::NAN, f64::NAN), weighted);
    let error: Vec<f64> = a.iter().zip(&y).map(|(a, y)| y - a).collect();
    Ok(Indices {
        waveform: still,
        shifted: shifted.ratio,
        spectrum: share(0.1),
        spectrum_20: share(0.2),
        peak: peak(response) / peak(reference) - 1.0,
        delay: shifted.delay,
        rms: still * size,
        rms_less_delay: shifted.ratio * size,
        rms_of_peak: still * size / peak(reference),
        gain,
        coherence: coherent,
        transfer: transfer.as_ref().map_or_else(Vec::new, |t| TOLD.iter().filter_map(|f| at(t, *f)).collect()),
        bands: bands(&error, step),
    })
}

/// Relative difference of the response spectra, period by period.
fn apart(reference: &[f64], response: &[f64], dt: f64) -> Result<Vec<f64>, SpectrumError> {
    let steps = (12.0 * (SPECTRUM.1 / SPECTRUM.0).log2()).floor() as i32;
    let periods: Vec<f64> = (0..=steps).map(|k| 1.0 / (SPECTRUM.0 * 2f64.powf(f64::from(k) / 12.0))).collect();
    let of = |signal: &[f64]| response_spectrum(signal, dt, 0.05, &periods).map(|s| s.s_a);
    let (a, y) = (of(reference)?, of(response)?);
    Ok(a.iter().zip(&y).map(|(a, y)| if *a > 0.0 { (y / a - 1.0).abs() } else { f64::INFINITY }).collect())
}

/// The transfer from windows as long as leave [`WINDOWS`] of them; none where that is too short to tell [`BAND`]'s lower end.
fn transfer(reference: &[f64], response: &[f64], dt: f64) -> Option<Coherence> {
    // Windows overlap by half.
    let longest = 2.0 * reference.len() as f64 / (WINDOWS as f64 + 1.0);
    let window = longest.min(LONGEST / dt) as usize;
    (window as f64 * dt * BAND.0 >= 1.0).then(|| coherence(reference, response, dt, window))
}

/// Gain and coherence over [`BAND`], by the reference's power; the gain where it can be trusted.
fn weighted(found: &Coherence) -> (f64, f64) {
    let inside = || (0..found.frequency.len()).filter(|&i| (BAND.0..=BAND.1).contains(&found.frequency[i]));
    let mean = |bins: &mut dyn Iterator<Item = usize>, of: &[f64]| {
        let (sum, weight) = bins.fold((0.0, 0.0), |(s, w), i| (s + of[i] * found.power[i], w + found.power[i]));
        if weight > 0.0 { sum / weight } else { f64::NAN }
    };
    (mean(&mut inside().filter(|&i| found.value[i] >= TRUSTED), &found.gain), mean(&mut inside(), &found.value))
}

/// What is told of the transfer at a frequency; nothing of gain and phase where the coherence is low, or rests on a burst.
fn at(found: &Coherence, frequency: f64) -> Option<At> {
    let i = found.frequency.iter().position(|f| *f >= frequency * (1.0 - 1e-9))?;
    let told = found.value[i] >= TRUSTED && found.spread[i] >= SPREAD;
    let trusted = |x: f64| if told { x } else { f64::NAN };
    Some(At {
        frequency: found.frequency[i],
        gain: trusted(found.gain[i]),
        phase: trusted(found.phase[i].to_degrees()),
        coherence: found.value[i],
    })
}

/// RMS of a signal by band, from its Fourier amplitudes (Parseval).
fn bands(error: &[f64], dt: f64) -> Vec<BandError> {
    let (frequency, amplitude) = super::super::spectrum::fourier_amplitude(error, dt);
    let duration = error.len() as f64 * dt;
    let width = frequency.get(1).copied().unwrap_or(0.0);
    let highest = frequency.last().copied().unwrap_or(0.0);
    let power = |from: f64, to: f64| {
        let inside = frequency.iter().zip(&amplitude).filter(|(f, _)| (from..to).contains(*f));
        2.0 * width / duration * inside.map(|(_, a)| a * a).sum::<f64>()
    };
    let told = EDGES.windows(2).filter(|edge| edge[1] <= highest);
    told.map(|edge| BandError { from: edge[0], to: edge[1], rms: power(edge[0], edge[1]).sqrt() }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::generate::NEAR_FIELD_MODERATE;
    use std::f64::consts::PI;

    fn record() -> (Vec<f64>, f64) {
        let record = NEAR_FIELD_MODERATE.generate(3).unwrap();
        (record.acceleration, record.dt)
    }

    #[test]
    fn a_response_that_is_the_reference_has_no_error() {
        let (a, dt) = record();
        let found = indices(&a, &a, dt).unwrap();
        assert_eq!((found.waveform, found.spectrum, found.peak, found.delay), (0.0, 0.0, 0.0, 0.0));
        assert!((found.gain - 1.0).abs() < 1e-12 && (found.coherence - 1.0).abs() < 1e-12);
    }

    #[test]
    fn weaker_and_late_is_told_apart() {
        let (a, dt) = record();
        let y: Vec<f64> = (0..a.len()).map(|k| if k < 4 { 0.0 } else { 0.85 * a[k - 4] }).collect();
        let found = indices(&a, &y, dt).unwrap();
        assert!((found.delay - 4.0 * dt).abs() < 0.1 * dt, "{}", found.delay);
        assert!((found.peak + 0.15).abs() < 1e-12);
        assert!((found.gain - 0.85).abs() < 0.02, "{}", found.gain);
        assert!(found.coherence > 0.95, "{}", found.coherence);
        assert_eq!((found.spectrum, found.spectrum_20), (1.0, 0.0));
        let rms = (a.iter().map(|x| x * x).sum::<f64>() / a.len() as f64).sqrt();
        assert!((found.rms_less_delay / rms - 0.15).abs() < 5e-3, "{}", found.rms_less_delay / rms);
        for at in found.transfer.iter().filter(|at| at.gain.is_finite()) {
            let lag = -360.0 * at.frequency * 4.0 * dt;
            let apart = (at.phase - lag + 180.0).rem_euclid(360.0) - 180.0;
            assert!(apart.abs() < 6.0, "{at:?} {lag}");
        }
    }

    #[test]
    fn an_error_of_one_frequency_is_in_its_band() {
        let (a, dt) = record();
        let y: Vec<f64> = a.iter().enumerate().map(|(k, a)| a + 0.5 * (2.0 * PI * 8.0 * k as f64 * dt).sin()).collect();
        let found = indices(&a, &y, dt).unwrap();
        let rms: Vec<f64> = found.bands.iter().map(|b| b.rms).collect();
        assert!((rms[2] / (0.5 / 2f64.sqrt()) - 1.0).abs() < 0.01 && rms[0] + rms[1] + rms[3] < 0.05, "{rms:?}");
    }
}
