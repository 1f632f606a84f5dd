//! Whole runs in the frequency domain: response over drive, the next drive, and what it will do.

use super::{Learning, Update};
use nalgebra::Complex;
use realfft::RealFftPlanner;
use std::f64::consts::TAU;

/// The transform of a run, padded so that neither end reaches the other.
#[derive(Debug, Clone)]
pub(super) struct Spectrum {
    bins: Vec<Complex<f64>>,
    samples: usize,
    size: usize,
}

/// Largest gain of the inverse response, 1.
const MOST: f64 = 4.0;
/// Frequencies over which response over drive is smoothed to either side, Hz.
const SMOOTHED: f64 = 0.15;
/// Order of the low-pass on what is learned.
const ORDER: i32 = 8;

impl Spectrum {
    /// Of values at rest at both ends.
    pub(super) fn of(values: &[f64]) -> Self {
        let size = (values.len() * 5 / 4).next_power_of_two();
        let mut padded = values.to_vec();
        padded.resize(size, 0.0);
        let transform = RealFftPlanner::<f64>::new().plan_fft_forward(size);
        let mut bins = transform.make_output_vec();
        // The buffers are made for this plan: their lengths cannot be wrong.
        let _ = transform.process(&mut padded, &mut bins);
        let bins = bins.iter().map(|c| Complex::new(c.re, c.im)).collect();
        Self { bins, samples: values.len(), size }
    }

    fn with(&self, bins: Vec<Complex<f64>>) -> Self {
        Self { bins, ..*self }
    }

    fn frequency(&self, bin: usize, dt: f64) -> f64 {
        bin as f64 / (self.size as f64 * dt)
    }

    /// The same later by `delay` (s).
    pub(super) fn delayed(&self, delay: f64, dt: f64) -> Self {
        let turn = |(i, c): (usize, &Complex<f64>)| c * Complex::from_polar(1.0, -TAU * self.frequency(i, dt) * delay);
        self.with(self.bins.iter().enumerate().map(turn).collect())
    }

    /// Back in time, what lies above `band` (Hz) taken off.
    pub(super) fn low_passed(&self, band: f64, dt: f64) -> Vec<f64> {
        let kept = |(i, c): (usize, &Complex<f64>)| c * passes(self.frequency(i, dt), band);
        self.with(self.bins.iter().enumerate().map(kept).collect()).values()
    }

    fn values(&self) -> Vec<f64> {
        let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(self.size);
        let mut bins = inverse.make_input_vec();
        for (to, from) in bins.iter_mut().zip(&self.bins) {
            (to.re, to.im) = (from.re, from.im);
        }
        if let (Some(first), true) = (bins.first_mut(), self.bins.len() > 1) {
            first.im = 0.0;
        }
        if let Some(last) = bins.last_mut() {
            last.im = 0.0;
        }
        let mut out = inverse.make_output_vec();
        let _ = inverse.process(&mut bins, &mut out);
        out.iter().take(self.samples).map(|x| x / self.size as f64).collect()
    }
}

/// Share of a frequency that is learned.
fn passes(frequency: f64, band: f64) -> f64 {
    1.0 / (1.0 + (frequency / band).powi(ORDER))
}

/// Response over drive, smoothed, and how coherent the two are.
fn response(drive: &Spectrum, seen: &Spectrum, dt: f64) -> Vec<(Complex<f64>, f64)> {
    let half = (SMOOTHED * drive.size as f64 * dt).ceil() as usize;
    let n = drive.bins.len();
    let mut cross = vec![Complex::new(0.0, 0.0); n + 1];
    let (mut power, mut answer) = (vec![0.0; n + 1], vec![0.0; n + 1]);
    for i in 0..n {
        cross[i + 1] = cross[i] + seen.bins[i] * drive.bins[i].conj();
        power[i + 1] = power[i] + drive.bins[i].norm_sqr();
        answer[i + 1] = answer[i] + seen.bins[i].norm_sqr();
    }
    let at = |i: usize| {
        let (from, to) = (i.saturating_sub(half), (i + half + 1).min(n));
        let (cross, power, answer) = (cross[to] - cross[from], power[to] - power[from], answer[to] - answer[from]);
        if power > 0.0 && answer > 0.0 {
            (cross / power, cross.norm_sqr() / (power * answer))
        } else {
            (Complex::new(0.0, 0.0), 0.0)
        }
    };
    (0..n).map(at).collect()
}

/// The next drive, m.
pub(super) fn correction(r: &Spectrum, x: &Spectrum, wanted: &Spectrum, how: &Learning, dt: f64) -> Vec<f64> {
    let gain = |t: &Complex<f64>| t.conj() / t.norm_sqr().max(1.0 / (MOST * MOST));
    let response = response(r, x, dt);
    let next = response.iter().enumerate().map(|(i, (t, coherence))| {
        let share = how.gain * passes(r.frequency(i, dt), how.band);
        let error = wanted.bins[i] - x.bins[i];
        match how.update {
            Update::Inverse => r.bins[i] + gain(t) * error * (share * coherence),
            Update::Plain => r.bins[i] + error * share,
        }
    });
    r.with(next.collect()).values()
}

/// What the next run will do within `band` (Hz), m.
pub(super) fn predicted(r: &Spectrum, x: &Spectrum, next: &[f64], band: f64, dt: f64) -> Vec<f64> {
    let next = Spectrum::of(next);
    let response = response(r, x, dt);
    let bins = response.iter().enumerate().map(|(i, (t, _))| x.bins[i] + t * (next.bins[i] - r.bins[i]));
    r.with(bins.collect()).low_passed(band, dt)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pulse() -> Vec<f64> {
        (0..4000).map(|k| (-((f64::from(k) - 1500.0) / 60.0).powi(2)).exp()).collect()
    }

    #[test]
    fn there_and_back_is_the_same_and_a_delay_is_one() {
        let there = Spectrum::of(&pulse());
        let late = there.delayed(0.1, 1e-3).values();
        for (k, x) in there.values().iter().enumerate() {
            assert!((x - pulse()[k]).abs() < 1e-12);
            assert!(k + 100 >= late.len() || (late[k + 100] - x).abs() < 1e-9);
        }
    }

    /// A table that gives four fifths of its drive, late: one whole correction makes the motion wanted.
    #[test]
    fn a_response_is_undone_in_one_correction() {
        let r = Spectrum::of(&pulse());
        let x = r.with(r.bins.iter().map(|c| c * 0.8).collect()).delayed(0.02, 1e-3);
        let how = Learning { band: 40.0, runs: 2, ..Learning::default() };
        let wanted = r.delayed(0.02, 1e-3);
        let next = correction(&r, &x, &wanted, &how, 1e-3);
        for (k, (a, b)) in next.iter().zip(pulse()).enumerate() {
            assert!((a - b / 0.8).abs() < 2e-3, "{k}");
        }
        let will = predicted(&r, &x, &next, 40.0, 1e-3);
        assert!(will.iter().zip(wanted.values()).all(|(a, b)| (a - b).abs() < 2e-3));
    }
}
