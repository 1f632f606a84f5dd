//! Response spectra and Fourier amplitude.

mod oscillator;

pub(super) use oscillator::advance;

use super::STANDARD_GRAVITY;
use oscillator::{Oscillator, impulses};
use rayon::prelude::*;
use realfft::RealFftPlanner;
use std::f64::consts::PI;

/// Largest responses of linear single-degree-of-freedom oscillators to a ground acceleration, by period.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseSpectrum {
    /// Damping, share of critical.
    pub damping: f64,
    /// Undamped periods, s.
    pub periods: Vec<f64>,
    /// Largest displacement relative to the ground, m.
    pub s_d: Vec<f64>,
    /// Largest velocity relative to the ground, m/s.
    pub s_v: Vec<f64>,
    /// Largest absolute acceleration, m/s².
    pub s_a: Vec<f64>,
}

impl ResponseSpectrum {
    /// `S_a` in g.
    pub fn s_a_in_g(&self) -> Vec<f64> {
        self.s_a.iter().map(|a| a / STANDARD_GRAVITY).collect()
    }

    /// Pseudo-acceleration `(2 pi / T)^2 S_d`, m/s².
    pub fn pseudo_acceleration(&self) -> Vec<f64> {
        self.periods.iter().zip(&self.s_d).map(|(t, d)| (2.0 * PI / t).powi(2) * d).collect()
    }
}

/// Why there is no response spectrum.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SpectrumError {
    /// The damping is not below critical.
    #[error("damping {0}: expected from 0 to below 1, 0.05 for the usual 5 %")]
    Damping(f64),
    /// A period that is not positive.
    #[error("period {0} s: expected over 0")]
    Period(f64),
}

/// Periods evenly spaced in the logarithm, s.
pub fn periods(from: f64, to: f64, count: usize) -> Vec<f64> {
    let step = if count > 1 { (to / from).ln() / (count - 1) as f64 } else { 0.0 };
    (0..count).map(|i| from * (step * i as f64).exp()).collect()
}

/// The response spectrum of a ground acceleration (m/s²) sampled every `dt` s and linear between samples.
///
/// Each oscillator is stepped exactly (Nigam and Jennings, 1969), in steps of at most a twentieth of its period and a quarter
/// of a sample; where a quantity turns within a step, its peak is sought there. Only a turn there and back within one step
/// is missed: white noise under a soft oscillator showed it at 1.7e-3 of the peak in steps of a sample, below 1e-4 in these.
/// The oscillator is first taken from sample to sample; within a sample it is only looked at where a quantity can exceed its largest
/// at all samples.
/// The oscillator starts at rest; what it does after the last sample does not count, so pad a record with rest where it
/// should.
pub fn response_spectrum(
    acceleration: &[f64],
    dt: f64,
    damping: f64,
    periods: &[f64],
) -> Result<ResponseSpectrum, SpectrumError> {
    if !(0.0..1.0).contains(&damping) {
        return Err(SpectrumError::Damping(damping));
    }
    if let Some(&period) = periods.iter().find(|t| !(**t > 0.0 && t.is_finite())) {
        return Err(SpectrumError::Period(period));
    }
    let impulses = impulses(acceleration, dt);
    let peaks: Vec<[f64; 3]> =
        periods.par_iter().map(|&period| Oscillator::new(period, damping, dt).peaks(acceleration, &impulses)).collect();
    let column = |i: usize| peaks.iter().map(|p| p[i]).collect();
    Ok(ResponseSpectrum { damping, periods: periods.to_vec(), s_d: column(0), s_v: column(1), s_a: column(2) })
}

/// Fourier amplitude of a signal sampled every `dt` s, `dt |sum x exp(-i w t)|`: frequencies (Hz) and amplitudes (unit of
/// the signal times s). The signal is padded with zeros to a power of two.
pub fn fourier_amplitude(signal: &[f64], dt: f64) -> (Vec<f64>, Vec<f64>) {
    let size = signal.len().next_power_of_two().max(2);
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(size);
    let mut buffer = signal.to_vec();
    buffer.resize(size, 0.0);
    let mut spectrum = forward.make_output_vec();
    // The buffers are made for this plan: their lengths cannot be wrong.
    let amplitude = match forward.process(&mut buffer, &mut spectrum) {
        Ok(()) => spectrum.iter().map(|c| c.norm() * dt).collect(),
        Err(_) => Vec::new(),
    };
    ((0..=size / 2).map(|i| i as f64 / (size as f64 * dt)).collect(), amplitude)
}

#[cfg(test)]
mod tests;
