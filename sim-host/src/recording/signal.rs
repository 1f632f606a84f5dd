//! Small signal processing for checks and noise floors: filling gaps, removing trends, averaged spectra.

use nalgebra::{Matrix2, Vector2};
use realfft::RealFftPlanner;
use realfft::num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Root mean square of the values that are finite; NaN where none is.
pub(crate) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.filter(|x| x.is_finite()).fold((0.0, 0.0), |(sum, count), x| (sum + x * x, count + 1.0));
    f64::sqrt(sum / count)
}

/// The samples with NaN filled by straight lines between the neighbours; at the ends the nearest value holds.
pub(crate) fn filled(samples: &[f64]) -> Vec<f64> {
    let mut out = samples.to_vec();
    let mut last: Option<usize> = None;
    for k in 0..out.len() {
        if !out[k].is_finite() {
            continue;
        }
        let from = last.map_or(0, |l| l + 1);
        for j in from..k {
            out[j] = match last {
                Some(l) => out[l] + (out[k] - out[l]) * (j - l) as f64 / (k - l) as f64,
                None => out[k],
            };
        }
        last = Some(k);
    }
    let (from, value) = last.map_or((0, 0.0), |l| (l + 1, out[l]));
    out[from..].fill(value);
    out
}

/// Mean of the samples that are numbers; zero where there are none.
pub(crate) fn mean(samples: &[f64]) -> f64 {
    let (sum, count) = samples.iter().filter(|x| x.is_finite()).fold((0.0, 0usize), |(s, n), x| (s + x, n + 1));
    sum / count.max(1) as f64
}

/// Root mean square about the mean, of the samples that are numbers.
pub(crate) fn deviation(samples: &[f64]) -> f64 {
    let mean = mean(samples);
    let (sum, count) =
        samples.iter().filter(|x| x.is_finite()).fold((0.0, 0usize), |(s, n), x| (s + (x - mean).powi(2), n + 1));
    (sum / count.max(1) as f64).sqrt()
}

/// Noise from fourth differences of however many samples, by their median size so that jerks do not count.
pub(crate) fn scatter(samples: &[f64]) -> f64 {
    let sizes: Vec<f64> =
        samples.windows(5).map(|w| (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).abs()).collect();
    // 70 is the sum of the squared weights; 0.6745 the median of a unit normal's size.
    quantile(&sizes, 0.5) / (0.6745 * 70f64.sqrt())
}

/// The value below which a part `q` of the samples lies; NaN for no samples.
pub(crate) fn quantile(samples: &[f64], q: f64) -> f64 {
    let mut sorted: Vec<f64> = samples.iter().copied().filter(|x| x.is_finite()).collect();
    if sorted.is_empty() {
        return f64::NAN;
    }
    let place = ((sorted.len() - 1) as f64 * q.clamp(0.0, 1.0)).round() as usize;
    *sorted.select_nth_unstable_by(place, f64::total_cmp).1
}

/// Samples, gaps filled, less their least-squares line.
pub(crate) fn detrended(samples: &[f64]) -> Vec<f64> {
    let mut filled = filled(samples);
    detrend(&mut filled);
    filled
}

/// Takes the least-squares line off.
pub(crate) fn detrend(samples: &mut [f64]) {
    let n = samples.len() as f64;
    if samples.len() < 2 {
        return;
    }
    let middle = (n - 1.0) / 2.0;
    let mean = samples.iter().sum::<f64>() / n;
    let slope =
        samples.iter().enumerate().map(|(k, x)| (k as f64 - middle) * x).sum::<f64>() * 12.0 / (n * (n * n - 1.0));
    for (k, x) in samples.iter_mut().enumerate() {
        *x -= mean + slope * (k as f64 - middle);
    }
}

/// First difference over two steps, centred, per second; the ends repeat their neighbours.
pub(crate) fn slope(samples: &[f64], dt: f64) -> Vec<f64> {
    centred(samples, |before, _, after| (after - before) / (2.0 * dt))
}

/// Second difference, centred, per second squared; the ends repeat their neighbours.
pub(crate) fn curvature(samples: &[f64], dt: f64) -> Vec<f64> {
    centred(samples, |before, here, after| (after - 2.0 * here + before) / (dt * dt))
}

fn centred(samples: &[f64], formula: impl Fn(f64, f64, f64) -> f64) -> Vec<f64> {
    let inner: Vec<f64> = samples.windows(3).map(|w| formula(w[0], w[1], w[2])).collect();
    let (Some(&first), Some(&last)) = (inner.first(), inner.last()) else { return vec![0.0; samples.len()] };
    std::iter::once(first).chain(inner).chain([last]).collect()
}

/// Averaged auto and cross spectra of two signals.
#[derive(Debug, Clone, Default)]
pub(crate) struct Spectra {
    /// Frequencies, Hz.
    pub frequency: Vec<f64>,
    /// Power of the first, its unit squared per Hz.
    pub input: Vec<f64>,
    /// Power of the second.
    pub output: Vec<f64>,
    /// Cross power: conjugate of the first times the second.
    pub cross: Vec<Complex64>,
    /// Number of segments averaged.
    pub segments: usize,
}

impl Spectra {
    /// Magnitude-squared coherence of a bin, with the bias that few averages give taken off.
    pub(crate) fn coherence(&self, bin: usize) -> f64 {
        let power = self.input[bin] * self.output[bin];
        if power <= 0.0 || self.segments < 2 {
            return 0.0;
        }
        let raw = self.cross[bin].norm_sqr() / power;
        // Half-overlapping Hann segments count for about 0.6 of their number.
        let count = (0.6 * self.segments as f64).max(1.5);
        ((raw - 1.0 / count) / (1.0 - 1.0 / count)).clamp(0.0, 1.0)
    }
}

/// Welch's averaged spectra with Hann segments that overlap by half, each freed of its trend. Segments with a gap (NaN
/// in either signal) are left out.
pub(crate) fn spectra(first: &[f64], second: &[f64], dt: f64, segment: usize) -> Spectra {
    let segment = segment.max(8);
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(segment);
    let window: Vec<f64> = (0..segment).map(|k| (PI * (k as f64 + 0.5) / segment as f64).sin().powi(2)).collect();
    let scale = 2.0 * dt / window.iter().map(|w| w * w).sum::<f64>();
    let bins = segment / 2 + 1;
    let mut out = Spectra {
        frequency: (0..bins).map(|k| k as f64 / (segment as f64 * dt)).collect(),
        input: vec![0.0; bins],
        output: vec![0.0; bins],
        cross: vec![Complex64::default(); bins],
        segments: 0,
    };
    let transform = |part: &[f64]| {
        let mut part = part.to_vec();
        detrend(&mut part);
        part.iter_mut().zip(&window).for_each(|(x, w)| *x *= w);
        let mut spectrum = fft.make_output_vec();
        // Lengths agree by construction, which is all that can fail.
        let _ = fft.process(&mut part, &mut spectrum);
        spectrum
    };
    let length = first.len().min(second.len());
    for start in (0..length.saturating_sub(segment - 1)).step_by((segment / 2).max(1)) {
        let (a, b) = (&first[start..start + segment], &second[start..start + segment]);
        if a.iter().chain(b).any(|x| !x.is_finite()) {
            continue;
        }
        for (k, (x, y)) in transform(a).iter().zip(transform(b)).enumerate() {
            out.input[k] += scale * x.norm_sqr();
            out.output[k] += scale * y.norm_sqr();
            out.cross[k] += scale * x.conj() * y;
        }
        out.segments += 1;
    }
    let average = 1.0 / out.segments.max(1) as f64;
    for k in 0..bins {
        out.input[k] *= average;
        out.output[k] *= average;
        out.cross[k] *= average;
    }
    out
}

/// The series `by` samples later brought to now; its ends are held.
pub(crate) fn shifted(series: &[f64], by: i32) -> Vec<f64> {
    let last = series.len().saturating_sub(1) as i64;
    (0..series.len() as i64).map(|k| series[(k + i64::from(by)).clamp(0, last) as usize]).collect()
}

/// A segment length that gives at least about eight averages: a power of two, at most `longest` samples.
pub(crate) fn segment_length(samples: usize, longest: usize) -> usize {
    let wanted = (samples / 5).clamp(16, longest.max(16));
    1 << (usize::BITS - 1 - wanted.leading_zeros())
}

/// A sine as fitted to samples: `sine sin(2 pi f t) + cosine cos(2 pi f t)`, t from the first sample.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(clippy::struct_field_names, reason = "the weight of the sine is called like it")]
pub(crate) struct Sine {
    /// f, Hz.
    pub frequency: f64,
    /// Weight of the sine, in the samples' unit.
    pub sine: f64,
    /// Weight of the cosine, in the samples' unit.
    pub cosine: f64,
}

impl Sine {
    /// Of these frequencies (Hz) the one whose sine takes most from samples `dt` (s) apart, by least squares over those that are
    /// finite; none where too few are.
    pub(crate) fn best(samples: &[f64], dt: f64, frequencies: impl Iterator<Item = f64>) -> Option<Self> {
        let fit = |frequency: f64| {
            let (mut matrix, mut right) = (Matrix2::zeros(), Vector2::zeros());
            // Turned on from sample to sample: in a million of them the rounding adds up to a part in ten thousand millions.
            let (mut sine, mut cosine) = (0.0, 1.0);
            let (step_sine, step_cosine) = (TAU * frequency * dt).sin_cos();
            for x in samples {
                if x.is_finite() {
                    let row = Vector2::new(sine, cosine);
                    matrix += row * row.transpose();
                    right += row * *x;
                }
                (sine, cosine) = (sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine);
            }
            let weights: Vector2<f64> = matrix.try_inverse()? * right;
            Some((weights.dot(&right), Self { frequency, sine: weights[0], cosine: weights[1] }))
        };
        frequencies.filter_map(fit).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, sine)| sine)
    }

    /// Its value at a sample.
    pub(crate) fn at(&self, sample: usize, dt: f64) -> f64 {
        let (sine, cosine) = (TAU * self.frequency * sample as f64 * dt).sin_cos();
        self.sine * sine + self.cosine * cosine
    }

    /// The samples without it.
    pub(crate) fn taken_off(&self, samples: &[f64], dt: f64) -> Vec<f64> {
        samples.iter().enumerate().map(|(k, x)| x - self.at(k, dt)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_bridged_and_ends_held() {
        let nan = f64::NAN;
        assert_eq!(filled(&[nan, 1.0, nan, nan, 4.0, nan]), [1.0, 1.0, 2.0, 3.0, 4.0, 4.0]);
        assert_eq!(filled(&[nan, nan]), [0.0, 0.0]);
    }

    #[test]
    fn a_line_is_taken_off_whole() {
        let mut line: Vec<f64> = (0..50).map(|k| 3.0 - 0.2 * f64::from(k)).collect();
        detrend(&mut line);
        assert!(line.iter().all(|x| x.abs() < 1e-12));
    }

    #[test]
    fn a_sine_is_fitted_and_taken_off_whatever_is_missing() {
        let wave = Sine { frequency: 50.3, sine: 2.0, cosine: -0.7 };
        let mut samples: Vec<f64> = (0..800).map(|k| wave.at(k, 1e-3)).collect();
        samples[300..420].fill(f64::NAN);
        let found = Sine::best(&samples, 1e-3, (0..10).map(|i| 50.0 + 0.1 * f64::from(i))).unwrap();
        assert!((found.frequency - 50.3).abs() < 1e-9 && (found.sine - 2.0).abs() < 1e-9, "{found:?}");
        let left = found.taken_off(&samples, 1e-3);
        assert!(left.iter().filter(|x| x.is_finite()).all(|x| x.abs() < 1e-9));
        assert_eq!(left.iter().filter(|x| x.is_nan()).count(), 120);
        assert_eq!(Sine::best(&[f64::NAN; 9], 1e-3, std::iter::once(50.0)), None);
    }

    #[test]
    fn power_of_a_sine_and_its_coherence() {
        let sine: Vec<f64> = (0..8192).map(|k| (2.0 * PI * 10.0 * f64::from(k) / 256.0).sin()).collect();
        let out = spectra(&sine, &sine, 1.0 / 256.0, 1024);
        let power: f64 = out.input.iter().sum::<f64>() * 0.25;
        assert!((power - 0.5).abs() < 1e-3, "{power}");
        assert!(out.coherence(40) > 0.99);
    }
}
