//! Response spectra and Fourier amplitude.

use super::STANDARD_GRAVITY;
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
    let peaks: Vec<[f64; 3]> =
        periods.par_iter().map(|&period| Oscillator::new(period, damping, dt).peaks(acceleration)).collect();
    let column = |i: usize| peaks.iter().map(|p| p[i]).collect();
    Ok(ResponseSpectrum { damping, periods: periods.to_vec(), s_d: column(0), s_v: column(1), s_a: column(2) })
}

/// `x'' + 2 z w x' + w^2 x = -a`, stepped exactly for an acceleration that is linear over a step.
struct Oscillator {
    w: f64,
    damping: f64,
    /// Length of a step, s.
    h: f64,
    /// Steps to a sample.
    steps: usize,
    /// `(x, v)` after a step from `(x, v, a, a_next)`.
    transition: [[f64; 4]; 2],
}

impl Oscillator {
    fn new(period: f64, damping: f64, dt: f64) -> Self {
        let w = 2.0 * PI / period;
        let steps = (20.0 * dt / period).ceil().clamp(4.0, 1e4) as usize;
        let h = dt / steps as f64;
        // The response to each of the four inputs alone makes a column of the transition.
        let mut transition = [[0.0; 4]; 2];
        let units = [(1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0)];
        for (i, (x, v, a, next)) in units.into_iter().enumerate() {
            (transition[0][i], transition[1][i]) = advance((w, damping, h), (x, v), (a, next));
        }
        Self { w, damping, h, steps, transition }
    }

    /// Relative displacement, relative velocity and absolute acceleration, and the rates they change at.
    fn quantities(&self, x: f64, v: f64, a: f64) -> ([f64; 3], [f64; 3]) {
        let (w, c) = (self.w, 2.0 * self.damping * self.w);
        let absolute = -c * v - w * w * x;
        let relative = absolute - a;
        ([x, v, absolute], [v, relative, -c * relative - w * w * v])
    }

    /// Largest relative displacement, relative velocity and absolute acceleration.
    fn peaks(&self, acceleration: &[f64]) -> [f64; 3] {
        let (mut x, mut v) = (0.0, 0.0);
        let mut peaks = [0.0f64; 3];
        for pair in acceleration.windows(2) {
            let slope = (pair[1] - pair[0]) / self.steps as f64;
            for i in 0..self.steps {
                let a = pair[0] + slope * i as f64;
                let (_, before) = self.quantities(x, v, a);
                let input = [x, v, a, a + slope];
                let next = self.transition.map(|row| row.iter().zip(&input).map(|(c, u)| c * u).sum::<f64>());
                let (values, after) = self.quantities(next[0], next[1], a + slope);
                for j in 0..3 {
                    peaks[j] = values[j].abs().max(peaks[j]);
                    if before[j] * after[j] < 0.0 {
                        let turn = self.turn(j, (x, v), (a, slope), (before[j], after[j]));
                        peaks[j] = turn.abs().max(peaks[j]);
                    }
                }
                (x, v) = (next[0], next[1]);
            }
        }
        peaks
    }

    /// The extreme of quantity `j` within a step, where its rate passes through zero, by false position.
    fn turn(&self, j: usize, state: (f64, f64), (a, slope): (f64, f64), rates: (f64, f64)) -> f64 {
        let (mut from, mut to) = ((0.0, rates.0), (1.0, rates.1));
        let mut extreme = 0.0;
        for _ in 0..4 {
            let share = (from.0 * to.1 - to.0 * from.1) / (to.1 - from.1);
            let end = a + slope * share;
            let (x, v) = advance((self.w, self.damping, self.h * share), state, (a, end));
            let (values, rate) = self.quantities(x, v, end);
            extreme = values[j];
            if rate[j] * from.1 > 0.0 {
                from = (share, rate[j]);
            } else if rate[j] * to.1 > 0.0 {
                to = (share, rate[j]);
            } else {
                break;
            }
        }
        extreme
    }
}

/// State of an oscillator `(w, damping)` after `h` s, from a state, under an acceleration running straight from one value
/// to another: the particular solution `-(a + s t) / w^2 + 2 z s / w^3` and the free vibration that meets the start.
pub(super) fn advance((w, z, h): (f64, f64, f64), (x0, v0): (f64, f64), (a0, a1): (f64, f64)) -> (f64, f64) {
    let slope = (a1 - a0) / h;
    let particular = |a: f64| -a / (w * w) + 2.0 * z * slope / (w * w * w);
    let particular_velocity = -slope / (w * w);
    let wd = w * (1.0 - z * z).sqrt();
    let c1 = x0 - particular(a0);
    let c2 = (v0 - particular_velocity + z * w * c1) / wd;
    let (decay, cos, sin) = ((-z * w * h).exp(), (wd * h).cos(), (wd * h).sin());
    let free = decay * (c1 * cos + c2 * sin);
    let free_velocity = decay * ((c2 * wd - z * w * c1) * cos - (c1 * wd + z * w * c2) * sin);
    (free + particular(a1), free_velocity + particular_velocity)
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
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_step_of_acceleration_gives_the_closed_form() {
        let (period, z) = (0.7, 0.05);
        let spectrum = response_spectrum(&vec![2.0; 2001], 0.01, z, &[period]).unwrap();
        let w = 2.0 * PI / period;
        let overshoot = (-z * PI / (1.0 - z * z).sqrt()).exp();
        let displacement = 2.0 / (w * w) * (1.0 + overshoot);
        assert!((spectrum.s_d[0] / displacement - 1.0).abs() < 1e-5, "{}", spectrum.s_d[0] / displacement);
        // The spring's pull ends at the ground's acceleration, so the first peak of it is that of displacement.
        assert!((spectrum.pseudo_acceleration()[0] / (2.0 * (1.0 + overshoot)) - 1.0).abs() < 1.5e-3);
    }

    #[test]
    fn resonance_grows_to_its_steady_state() {
        let (period, z, dt) = (0.5, 0.05, 0.005);
        let w = 2.0 * PI / period;
        let a: Vec<f64> = (0..8000).map(|k| (w * f64::from(k) * dt).sin()).collect();
        let spectrum = response_spectrum(&a, dt, z, &[period]).unwrap();
        let steady = 1.0 / (2.0 * z * w * w);
        assert!((spectrum.s_d[0] / steady - 1.0).abs() < 2e-3, "{}", spectrum.s_d[0] / steady);
        assert!((spectrum.s_v[0] / (steady * w) - 1.0).abs() < 2e-3);
        assert!((spectrum.s_a[0] / (steady * w * w * (1.0 + 4.0 * z * z).sqrt()) - 1.0).abs() < 2e-3);
    }

    #[test]
    fn a_stiff_oscillator_follows_the_ground_and_a_soft_one_stays_behind() {
        let dt = 0.005;
        let a: Vec<f64> =
            (0..4000).map(|k| (2.0 * PI * f64::from(k) * dt).sin() * (1.0 - (f64::from(k) / 4000.0))).collect();
        let motion = crate::motion::Motion::from_acceleration(dt, a.clone());
        let spectrum = response_spectrum(&a, dt, 0.05, &[0.01, 500.0]).unwrap();
        assert!((spectrum.s_a[0] / crate::motion::peak(&a) - 1.0).abs() < 2e-3);
        assert!((spectrum.s_d[1] / crate::motion::peak(&motion.displacement) - 1.0).abs() < 0.05);
    }

    /// Found by the property below: a displacement that turned there and back within a sample.
    #[test]
    fn a_turn_there_and_back_within_a_sample_is_seen() {
        let a = [-4.38, -4.167, 1.28, -4.395, 3.49, 2.347, -2.591, 2.887];
        let fine = super::super::resample::resample(&a, 0.02, 1e-4, super::super::resample::Interpolation::Linear);
        let at = |a: &[f64], dt| response_spectrum(a, dt, 0.05, &[0.518_867_457_263]).unwrap().s_d[0];
        assert!((at(&a, 0.02) / at(&fine, 1e-4) - 1.0).abs() < 1e-4, "{} {}", at(&a, 0.02), at(&fine, 1e-4));
    }

    #[test]
    fn bad_input_is_refused_with_its_value() {
        assert_eq!(response_spectrum(&[0.0; 4], 0.01, 1.0, &[1.0]), Err(SpectrumError::Damping(1.0)));
        assert_eq!(response_spectrum(&[0.0; 4], 0.01, 0.05, &[1.0, 0.0]), Err(SpectrumError::Period(0.0)));
        assert!(response_spectrum(&[], 0.01, 0.05, &[1.0]).is_ok_and(|s| s.s_a == [0.0]));
    }

    #[test]
    fn the_fourier_amplitude_of_a_gaussian_is_a_gaussian() {
        let dt = 0.01;
        let x: Vec<f64> = (0..1024).map(|k| (-((f64::from(k) * dt - 5.0) / 0.2).powi(2)).exp()).collect();
        let (frequency, amplitude) = fourier_amplitude(&x, dt);
        for (f, found) in frequency.iter().zip(&amplitude).take(40) {
            let exact = 0.2 * PI.sqrt() * (-(PI * f * 0.2).powi(2)).exp();
            assert!((found - exact).abs() < 1e-9, "{f} Hz: {found} {exact}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn spectra_scale_with_the_motion_and_finer_samples_of_the_same_lines_change_nothing(
            a in prop::collection::vec(-5.0..5.0f64, 2..60), factor in 0.1..4.0f64
        ) {
            let t = periods(0.05, 3.0, 8);
            let spectrum = response_spectrum(&a, 0.02, 0.05, &t).unwrap();
            let scaled: Vec<f64> = a.iter().map(|x| x * factor).collect();
            let other = response_spectrum(&scaled, 0.02, 0.05, &t).unwrap();
            let fine = super::super::resample::resample(&a, 0.02, 0.002, super::super::resample::Interpolation::Linear);
            let finer = response_spectrum(&fine, 0.002, 0.05, &t).unwrap();
            for (scaled, plain) in other.s_a.iter().zip(&spectrum.s_a) {
                prop_assert!((scaled - factor * plain).abs() < 1e-9 * (1.0 + scaled));
            }
            for ((fine, coarse), period) in finer.s_d.iter().zip(&spectrum.s_d).zip(&t) {
                prop_assert!((fine / coarse - 1.0).abs() < 1e-3, "{fine} {coarse} at {period} s");
            }
        }
    }
}
