//! Spectra and transfer function of the test so far, by Welch's method: segments of about four seconds that overlap by half,
//! under a Hann window.
//!
//! With `R` the displacement reference and `X` the measured displacement in one segment, `H = sum(conj(R) X) / sum(|R|^2)` and
//! the coherence is `|sum(conj(R) X)|^2 / (sum(|R|^2) sum(|X|^2))`. The reference's acceleration is `(2 pi f)^2` times its displacement.

use std::f64::consts::PI;
use std::sync::Arc;

use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};
use serde::Serialize;
use shakedown_core::State;

use super::bench::Sample;

/// Least length of a segment, s.
const SEGMENT: f64 = 4.0;
/// The band shown, Hz.
const BAND: [f64; 2] = [0.4, 50.0];
/// Share of the largest acceleration density below which the reference does not excite.
const EXCITED: f64 = 1e-4;

/// What a page is shown.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Shown {
    /// Segments averaged.
    pub(super) segments: u32,
    /// Hz.
    pub(super) frequency: Vec<f64>,
    /// Amplitude density of the reference's acceleration, m/s2 per root Hz.
    pub(super) reference: Vec<f64>,
    /// The same of the measured acceleration.
    pub(super) achieved: Vec<f64>,
    /// Magnitude of the transfer function from reference to measured displacement, dB; none where the reference does not excite.
    pub(super) magnitude: Vec<Option<f64>>,
    /// Its phase, degrees.
    pub(super) phase: Vec<Option<f64>>,
    /// Coherence.
    pub(super) coherence: Vec<Option<f64>>,
}

/// Sums over the segments so far.
pub(super) struct Spectra {
    rate: f64,
    fft: Arc<dyn RealToComplex<f64>>,
    window: Vec<f64>,
    /// Reference, displacement and acceleration of the segment under way.
    segment: [Vec<f64>; 3],
    segments: u32,
    reference: Vec<f64>,
    displacement: Vec<f64>,
    acceleration: Vec<f64>,
    cross: Vec<Complex<f64>>,
    running: bool,
}

impl Spectra {
    /// Nothing yet, of samples at `rate`, Hz.
    pub(super) fn new(rate: f64) -> Self {
        let length = ((SEGMENT * rate).max(16.0) as usize).next_power_of_two();
        let fft = RealFftPlanner::new().plan_fft_forward(length);
        let window = (0..length).map(|k| 0.5 - 0.5 * (2.0 * PI * k as f64 / length as f64).cos()).collect();
        let zeros = vec![0.0; length / 2 + 1];
        Self {
            rate,
            fft,
            window,
            segment: Default::default(),
            segments: 0,
            reference: zeros.clone(),
            displacement: zeros.clone(),
            acceleration: zeros.clone(),
            cross: vec![Complex::default(); zeros.len()],
            running: false,
        }
    }

    /// Takes a sample; those of a test while it runs count, and a new test begins anew.
    pub(super) fn take(&mut self, sample: &Sample) {
        let running = sample.state == State::Running;
        if running && !self.running {
            *self = Self::new(self.rate);
        }
        self.running = running;
        if !running {
            return;
        }
        if sample.gap > 0 {
            self.segment.iter_mut().for_each(Vec::clear);
        }
        let values = [sample.reference, sample.displacement, sample.acceleration];
        for (segment, value) in self.segment.iter_mut().zip(values) {
            segment.push(value);
        }
        if self.segment[0].len() == self.window.len() {
            self.add();
            let half = self.window.len() / 2;
            self.segment.iter_mut().for_each(|segment| drop(segment.drain(..half)));
        }
    }

    fn add(&mut self) {
        let [r, x, a] = [0, 1, 2].map(|k| self.transform(k));
        for k in 0..r.len() {
            self.reference[k] += r[k].norm_sqr();
            self.displacement[k] += x[k].norm_sqr();
            self.acceleration[k] += a[k].norm_sqr();
            self.cross[k] += r[k].conj() * x[k];
        }
        self.segments += 1;
    }

    fn transform(&self, which: usize) -> Vec<Complex<f64>> {
        let segment = &self.segment[which];
        let mean = segment.iter().sum::<f64>() / segment.len() as f64;
        let mut windowed: Vec<f64> = segment.iter().zip(&self.window).map(|(y, w)| (y - mean) * w).collect();
        let mut out = self.fft.make_output_vec();
        // The lengths are the plan's own.
        let _ = self.fft.process(&mut windowed, &mut out);
        out
    }

    /// What is known so far; none before the first segment.
    pub(super) fn shown(&self) -> Option<Shown> {
        if self.segments == 0 {
            return None;
        }
        let step = self.rate / self.window.len() as f64;
        let power: f64 = self.window.iter().map(|w| w * w).sum();
        let density = |sum: f64| (2.0 * sum / (f64::from(self.segments) * self.rate * power)).sqrt();
        let bins: Vec<usize> =
            (1..self.reference.len()).filter(|&k| (BAND[0]..=BAND[1]).contains(&(k as f64 * step))).collect();
        let of = |y: &dyn Fn(usize) -> f64| bins.iter().map(|&k| rounded(y(k))).collect::<Vec<f64>>();
        let reference = |k: usize| (2.0 * PI * k as f64 * step).powi(2) * density(self.reference[k]);
        let largest = bins.iter().map(|&k| reference(k)).fold(0.0, f64::max);
        let excited = |k: usize| reference(k) > EXCITED.sqrt() * largest;
        let transfer = |k: usize| self.cross[k] / self.reference[k];
        let where_excited = |y: &dyn Fn(usize) -> f64| {
            bins.iter().map(|&k| excited(k).then(|| rounded(y(k)))).collect::<Vec<Option<f64>>>()
        };
        Some(Shown {
            segments: self.segments,
            frequency: of(&|k| k as f64 * step),
            reference: of(&reference),
            achieved: of(&|k| density(self.acceleration[k])),
            magnitude: where_excited(&|k| 20.0 * transfer(k).norm().max(1e-9).log10()),
            phase: where_excited(&|k| transfer(k).arg().to_degrees()),
            coherence: where_excited(&|k| self.cross[k].norm_sqr() / (self.reference[k] * self.displacement[k])),
        })
    }
}

/// To four significant digits: a page needs no more.
fn rounded(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return 0.0;
    }
    let scale = 10f64.powi(3 - value.abs().log10().floor() as i32);
    (value * scale).round() / scale
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(k: usize, state: State) -> Sample {
        let t = k as f64 / 1000.0;
        // A deterministic reference of tones to 20 Hz, each of the same acceleration, so that all of them excite; the table answers
        // with half of it, 10 ms late.
        let tone = |n: u32, t: f64| (PI * f64::from(n) * t + f64::from(n * n)).sin() / f64::from(n * n);
        let at = |t: f64| (1..40).map(|n| tone(n, t)).sum::<f64>() * 1e-2;
        Sample {
            time: t,
            gap: 0,
            reference: at(t),
            modified: at(t),
            displacement: 0.5 * at(t - 0.01),
            acceleration: 0.0,
            command: 0.0,
            state,
            saturated: false,
            limited: false,
            held: false,
        }
    }

    #[test]
    fn gain_and_delay_of_the_table_are_seen() {
        let mut spectra = Spectra::new(1000.0);
        (0..30_000).for_each(|k| spectra.take(&sample(k, State::Running)));
        let shown = spectra.shown().unwrap();
        assert!(shown.segments >= 12);
        let near = |f: f64| shown.frequency.iter().position(|g| (g - f).abs() < 0.13).unwrap();
        for f in [2.0, 5.0, 10.0] {
            let k = near(f);
            assert!((shown.magnitude[k].unwrap() + 6.02).abs() < 0.2, "{f} Hz: {:?}", shown.magnitude[k]);
            assert!((shown.phase[k].unwrap() + 3.6 * f).abs() < 3.0, "{f} Hz: {:?}", shown.phase[k]);
            assert!(shown.coherence[k].unwrap() > 0.98);
        }
        assert_eq!(shown.magnitude[near(45.0)], None, "nothing excites there");
    }

    #[test]
    fn what_is_no_test_does_not_count_and_a_new_test_begins_anew() {
        let mut spectra = Spectra::new(1000.0);
        (0..9000).for_each(|k| spectra.take(&sample(k, State::Ready)));
        assert!(spectra.shown().is_none());
        (0..9000).for_each(|k| spectra.take(&sample(k, State::Running)));
        assert!(spectra.shown().is_some());
        spectra.take(&sample(0, State::Ready));
        assert!(spectra.shown().is_some(), "it stays until the next");
        spectra.take(&sample(0, State::Running));
        assert!(spectra.shown().is_none());
    }
}
