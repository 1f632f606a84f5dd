//! Tapered spectra of signals, of their derivatives and their integral, over the band that a reference excites.

use super::fit::Part;
use nalgebra::Complex;
use realfft::RealFftPlanner;
use std::f64::consts::PI;

/// Which derivative of a signal is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    Integral,
    Itself,
    First,
    Second,
}

/// A band of one log.
#[derive(Debug, Clone)]
pub(super) struct Band {
    dt: f64,
    samples: usize,
    first: usize,
    last: usize,
    /// Hz.
    pub(super) low: f64,
    /// Hz.
    pub(super) high: f64,
    /// What of it the reference excites, Hz.
    pub(super) excited: f64,
}

/// Share of the acceleration's power that lies below the band's upper edge.
const POWER: f64 = 0.998;
/// The upper edge, Hz, and as a share of the sampling rate at most.
const HIGHEST: (f64, f64) = (40.0, 0.3);
/// The upper edge of a widened band as a share of the sampling rate at most.
const WIDEST: f64 = 0.42;
/// Bins above what the reference excites at most.
const MOST: usize = 1200;
/// The upper edge at least, Hz.
const LEAST: f64 = 6.0;
/// Bins below the band: what the taper makes of bias and drift.
const SKIPPED: usize = 3;
/// Share of the log that is tapered at either end.
const TAPER: f64 = 0.08;

impl Band {
    /// The band that a reference (m, every `dt` s) excites; none where it does not move.
    pub(super) fn of(reference: &[f64], dt: f64) -> Option<Self> {
        let samples = reference.len();
        let nyquist = samples / 2;
        let whole = Self { dt, samples, first: SKIPPED, last: nyquist, low: 0.0, high: 0.0, excited: 0.5 / dt };
        let power: Vec<f64> = whole.spectrum(reference, Order::Second).iter().map(Complex::norm_sqr).collect();
        let width = 1.0 / (samples as f64 * dt);
        let last = ((HIGHEST.0.min(HIGHEST.1 / dt)) / width) as usize;
        let power = power.get(..last.saturating_sub(SKIPPED).min(power.len()))?;
        let total: f64 = power.iter().sum();
        if total.is_nan() || total <= 0.0 {
            return None;
        }
        let mut sum = 0.0;
        let reached = power.iter().position(|p| {
            sum += p;
            sum >= POWER * total
        });
        let edge = SKIPPED + reached.unwrap_or(power.len());
        let last = edge.max((LEAST / width) as usize).min(last);
        let high = last as f64 * width;
        Some(Self { last, low: SKIPPED as f64 * width, high, excited: high, ..whole })
    }

    /// The band up to `highest` (Hz), where noise alone may move anything.
    pub(super) fn widened(&self, highest: f64) -> Self {
        let width = 1.0 / (self.samples as f64 * self.dt);
        let last = ((highest.min(WIDEST / self.dt)) / width) as usize;
        Self { last: last.max(self.last), high: last.max(self.last) as f64 * width, ..self.clone() }
    }

    /// The bins: all that the reference excites, of those above so many that their number stays bounded.
    fn bins(&self) -> Vec<usize> {
        let width = 1.0 / (self.samples as f64 * self.dt);
        let edge = ((self.excited / width).round() as usize).clamp(self.first, self.last);
        let every = (self.last - edge).div_ceil(MOST).max(1);
        (self.first..=edge).chain((edge + every..=self.last).step_by(every)).collect()
    }

    /// Angular frequency of a bin, rad/s.
    fn omega(&self, bin: usize) -> f64 {
        2.0 * PI * bin as f64 / (self.samples as f64 * self.dt)
    }

    /// The band of a signal, a derivative of it, or its integral, after the taper. Differences and sums are taken in time, where the
    /// taper does not touch them, and their gain is corrected to that of the derivative.
    pub(super) fn spectrum(&self, signal: &[f64], order: Order) -> Vec<Complex<f64>> {
        let dt = self.dt;
        let values = match order {
            Order::Itself => signal.to_vec(),
            Order::First => crate::recording::signal::slope(signal, dt),
            Order::Second => crate::recording::signal::curvature(signal, dt),
            Order::Integral => sum(signal, dt),
        };
        let correction = |w: f64| match order {
            Order::Itself => 1.0,
            Order::First => w * dt / (w * dt).sin(),
            Order::Second => (w * dt).powi(2) / (2.0 - 2.0 * (w * dt).cos()),
            Order::Integral => (w * dt / 2.0).tan() / (w * dt / 2.0),
        };
        let bins = self.transform(&values);
        self.bins().into_iter().filter_map(|i| Some(*bins.get(i)? * correction(self.omega(i)))).collect()
    }

    fn transform(&self, values: &[f64]) -> Vec<Complex<f64>> {
        let n = self.samples;
        let mean = values.iter().take(n).sum::<f64>() / n.max(1) as f64;
        let mut tapered: Vec<f64> = values.iter().take(n).enumerate().map(|(k, x)| taper(k, n) * (x - mean)).collect();
        tapered.resize(n, 0.0);
        let forward = RealFftPlanner::<f64>::new().plan_fft_forward(n);
        let mut bins = forward.make_output_vec();
        // The buffers are made for this plan: their lengths cannot be wrong.
        let _ = forward.process(&mut tapered, &mut bins);
        bins.iter().map(|c| Complex::new(c.re, c.im)).collect()
    }

    /// Target and terms with what a bias and a drift explain taken out of each.
    pub(super) fn part(&self, target: Vec<Complex<f64>>, terms: Vec<Vec<Complex<f64>>>) -> Part {
        let middle = 0.5 * self.samples as f64;
        let drift: Vec<f64> = (0..self.samples).map(|k| (k as f64 - middle) / middle).collect();
        let window: Vec<f64> = vec![1.0; self.samples];
        // `transform` takes the mean off, so a bias is what is left of the mean that the taper weighs otherwise.
        let flat = self.flat(&window);
        let sloped = orthogonal(self.spectrum(&drift, Order::Itself), &flat);
        let clean = |x: Vec<Complex<f64>>| orthogonal(orthogonal(x, &flat), &sloped);
        let omega = self.bins().into_iter().map(|i| self.omega(i)).collect();
        let weight = vec![1.0; target.len()];
        Part { omega, target: clean(target), terms: terms.into_iter().map(clean).collect(), weight }
    }

    /// The band of the taper itself.
    fn flat(&self, ones: &[f64]) -> Vec<Complex<f64>> {
        let n = self.samples;
        let mut tapered: Vec<f64> = ones.iter().enumerate().map(|(k, x)| taper(k, n) * x).collect();
        let forward = RealFftPlanner::<f64>::new().plan_fft_forward(n);
        let mut bins = forward.make_output_vec();
        let _ = forward.process(&mut tapered, &mut bins);
        self.bins().into_iter().filter_map(|i| bins.get(i)).map(|c| Complex::new(c.re, c.im)).collect()
    }
}

/// Cosine at both ends, 1 between.
fn taper(k: usize, n: usize) -> f64 {
    let width = (TAPER * n as f64).max(1.0);
    let from_end = (k.min(n - 1 - k) as f64 + 0.5) / width;
    if from_end < 1.0 { 0.5 - 0.5 * (PI * from_end).cos() } else { 1.0 }
}

/// Trapezoidal integral.
fn sum(signal: &[f64], dt: f64) -> Vec<f64> {
    let mut total = 0.0;
    let mut before = signal.first().copied().unwrap_or(0.0);
    signal
        .iter()
        .map(|&x| {
            total += 0.5 * dt * (before + x);
            before = x;
            total
        })
        .collect()
}

/// What of `x` a real multiple of `direction` does not explain.
fn orthogonal(x: Vec<Complex<f64>>, direction: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let size: f64 = direction.iter().map(Complex::norm_sqr).sum();
    if size <= 0.0 {
        return x;
    }
    let along: f64 = x.iter().zip(direction).map(|(a, b)| (a * b.conj()).re).sum::<f64>() / size;
    x.into_iter().zip(direction).map(|(a, b)| a - b * along).collect()
}
