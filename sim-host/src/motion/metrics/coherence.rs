//! Magnitude-squared coherence and transfer of a response with its reference, by Welch's method: Hann windows overlapping by half,
//! each less its mean (Bendat and Piersol, Random Data, 11.6).

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use std::f64::consts::PI;

/// Coherence over frequency.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Coherence {
    /// Frequencies, Hz, from 0 to half the sampling rate.
    pub frequency: Vec<f64>,
    /// Coherence, 0 to 1; 0 where either signal has nothing at the frequency.
    pub value: Vec<f64>,
    /// Magnitude of the transfer from reference to response, `S_xy / S_xx`; 0 where the reference has nothing.
    pub gain: Vec<f64>,
    /// Its phase, rad, negative where the response lags.
    pub phase: Vec<f64>,
    /// Power of the reference, up to a common factor.
    pub power: Vec<f64>,
    /// Windows averaged; with one alone the coherence is 1 everywhere and says nothing.
    pub windows: usize,
    /// Windows that the reference's power is spread over at each frequency, `(sum p)^2 / sum p^2`: where one holds nearly all of it the
    /// coherence is near 1 whatever the response does.
    pub spread: Vec<f64>,
}

/// The coherence of two signals sampled every `dt` s, over windows of `window` samples (2 at least).
pub(crate) fn coherence(reference: &[f64], response: &[f64], dt: f64, window: usize) -> Coherence {
    let count = reference.len().min(response.len());
    let size = window.clamp(2, count.max(2)) / 2 * 2;
    let bins = size / 2 + 1;
    let (mut pxx, mut pyy, mut squares) = (vec![0.0; bins], vec![0.0; bins], vec![0.0; bins]);
    let mut pxy = vec![Complex::new(0.0, 0.0); bins];
    let mut transform = transformer(size);
    let mut windows = 0;
    while windows * size / 2 + size <= count {
        let at = windows * size / 2;
        let (x, y) = (transform(&reference[at..at + size]), transform(&response[at..at + size]));
        for (i, (x, y)) in x.iter().zip(&y).enumerate() {
            pxx[i] += x.norm_sqr();
            squares[i] += x.norm_sqr().powi(2);
            pyy[i] += y.norm_sqr();
            pxy[i] += x.conj() * y;
        }
        windows += 1;
    }
    let value = |i: usize| {
        let power = pxx[i] * pyy[i];
        if power > 0.0 { (pxy[i].norm_sqr() / power).min(1.0) } else { 0.0 }
    };
    Coherence {
        frequency: (0..bins).map(|i| i as f64 / (size as f64 * dt)).collect(),
        value: (0..bins).map(value).collect(),
        gain: (0..bins).map(|i| if pxx[i] > 0.0 { pxy[i].norm() / pxx[i] } else { 0.0 }).collect(),
        phase: pxy.iter().map(|c| c.arg()).collect(),
        spread: pxx.iter().zip(&squares).map(|(p, s)| if *s > 0.0 { p * p / s } else { 0.0 }).collect(),
        power: pxx,
        windows,
    }
}

/// A function that takes the mean out of a window, tapers it and gives its spectrum.
fn transformer(size: usize) -> impl FnMut(&[f64]) -> Vec<Complex<f64>> {
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(size);
    let taper: Vec<f64> = (0..size).map(|k| 0.5 - 0.5 * (2.0 * PI * k as f64 / size as f64).cos()).collect();
    move |signal| {
        let mean = signal.iter().sum::<f64>() / size as f64;
        let mut buffer: Vec<f64> = signal.iter().zip(&taper).map(|(x, w)| (x - mean) * w).collect();
        let mut spectrum = forward.make_output_vec();
        // The buffers are made for this plan: their lengths cannot be wrong.
        forward.process(&mut buffer, &mut spectrum).map(|()| spectrum).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};

    fn noise(seed: u64) -> Vec<f64> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        (0..8192).map(|_| f64::from(rng.next_u32()) / f64::from(u32::MAX) - 0.5).collect()
    }

    #[test]
    fn what_is_linear_is_coherent_and_what_is_independent_is_not() {
        let x = noise(1);
        let delayed: Vec<f64> = (0..x.len()).map(|k| -3.0 * x[k.saturating_sub(2)]).collect();
        let same = coherence(&x, &delayed, 0.01, 256);
        assert!(same.windows == 63 && same.value[1..].iter().all(|&c| c > 0.99), "{:?}", same.value);
        let other = coherence(&x, &noise(2), 0.01, 256);
        let mean = other.value.iter().sum::<f64>() / other.value.len() as f64;
        assert!(mean < 0.05, "{mean}");
        assert_eq!(same.frequency.last().copied(), Some(50.0));
    }

    /// Of two bursts that know nothing of each other the coherence is near 1, and the spread says why.
    #[test]
    fn a_burst_is_spread_over_few_windows() {
        let all = coherence(&noise(1), &noise(2), 0.01, 256);
        assert!(all.spread.iter().skip(1).all(|&n| n > 20.0), "{:?}", all.spread);
        // In the middle of one window, at the ends of those beside it.
        let burst = |seed: u64| -> Vec<f64> {
            noise(seed).iter().enumerate().map(|(k, x)| if (3960..3976).contains(&k) { *x } else { 1e-3 * x }).collect()
        };
        let few = coherence(&burst(1), &burst(2), 0.01, 256);
        let middle = |of: &[f64]| {
            let mut sorted = of[1..].to_vec();
            sorted.sort_by(f64::total_cmp);
            sorted[sorted.len() / 2]
        };
        let (spread, value) = (middle(&few.spread), middle(&few.value));
        assert!(spread < 1.5 && value > 0.8, "{spread} {value}");
    }

    #[test]
    fn signals_too_short_for_a_window_give_none() {
        assert_eq!(coherence(&[1.0], &[2.0], 0.01, 64).windows, 0);
    }
}
