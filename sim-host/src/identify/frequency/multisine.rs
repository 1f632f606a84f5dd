//! Best linear approximation from periods of a multisine, and how much of the rest is odd, even and noise.
//!
//! The multisine drives chosen lines of its period's spectrum. What the output holds at lines that were left out is
//! distortion: at odd ones that of odd nonlinearities (saturation, friction), at even ones that of even ones (unequal
//! limits, a null bias). What changes from period to period is noise.
//!
//! Source: J. Schoukens, R. Pintelon, Y. Rolain, "Mastering System Identification in 100 Exercises", 2012, chapters 4
//! and 6; R. Pintelon, J. Schoukens, "System Identification", 2nd ed., section 4.3.

use super::{Complex64, Point, Response, ResponseError, check, transform};

/// A line of the driven spectrum is one this much below the strongest, or above.
const DRIVEN: f64 = 1e-3;

/// Power at a line that was left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistortionLine {
    /// Hz.
    pub frequency: f64,
    /// Amplitude of the output there, the noise taken off, in the output's unit.
    pub amplitude: f64,
    /// Standard deviation of that amplitude from noise alone.
    pub noise: f64,
}

/// What a multisine says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Multisine {
    /// Best linear approximation at the driven lines; its deviation holds noise and, with several phases of the
    /// multisine, distortion.
    pub response: Response,
    /// Amplitude of the output at the driven lines.
    pub linear: Vec<(f64, f64)>,
    /// Odd lines that were left out.
    pub odd: Vec<DistortionLine>,
    /// Even lines that were left out.
    pub even: Vec<DistortionLine>,
    /// Standard deviation of the output's lines from noise, by driven frequency.
    pub noise: Vec<(f64, f64)>,
}

/// Mean lines of a record and their scatter between its periods.
struct Lines {
    mean: Vec<Complex64>,
    /// Variance of the mean.
    variance: Vec<f64>,
}

/// Analyses records of `period` samples, `dt` apart; each record is one choice of phases and must hold at least two
/// periods, the transient already cut off.
pub fn multisine(records: &[(&[f64], &[f64])], dt: f64, period: usize) -> Result<Multisine, ResponseError> {
    let mut all = Vec::new();
    for (input, output) in records {
        check(input, output, 2 * period.max(8))?;
        all.push((lines(input, period), lines(output, period)));
    }
    let (first, _) = all.first().ok_or(ResponseError::TooFew { what: "records", found: 0, least: 1 })?;
    let strongest = first.mean.iter().skip(1).map(|x| x.norm()).fold(0.0, f64::max);
    let driven: Vec<bool> = first.mean.iter().map(|x| x.norm() > DRIVEN * strongest && strongest > 0.0).collect();
    let width = 1.0 / (period as f64 * dt);
    let highest = driven.iter().rposition(|d| *d).unwrap_or(0);
    let mut out = Multisine::default();
    for bin in 1..=highest {
        let frequency = bin as f64 * width;
        let count = all.len() as f64;
        let noise = (all.iter().map(|(_, y)| y.variance[bin]).sum::<f64>() / count).sqrt();
        if driven[bin] {
            out.response.points.push(best_linear(&all, bin, frequency));
            let power = all.iter().map(|(_, y)| y.mean[bin].norm_sqr()).sum::<f64>() / count;
            out.linear.push((frequency, power.sqrt()));
            out.noise.push((frequency, noise));
        } else {
            let power = all.iter().map(|(u, y)| without_input(u, y, &driven, bin).norm_sqr()).sum::<f64>() / count;
            let amplitude = (power - noise * noise).max(0.0).sqrt();
            let line = DistortionLine { frequency, amplitude, noise };
            if bin % 2 == 1 { out.odd.push(line) } else { out.even.push(line) }
        }
    }
    Ok(out)
}

fn lines(samples: &[f64], period: usize) -> Lines {
    let periods: Vec<Vec<Complex64>> = samples.chunks_exact(period).map(transform).collect();
    let count = periods.len() as f64;
    let scale = 2.0 / period as f64;
    let bins = period / 2 + 1;
    let mean: Vec<Complex64> =
        (0..bins).map(|k| periods.iter().map(|p| p[k] * scale).sum::<Complex64>() / count).collect();
    let scatter = |k: usize| periods.iter().map(|p| (p[k] * scale - mean[k]).norm_sqr()).sum::<f64>();
    let variance = (0..bins).map(|k| scatter(k) / (count - 1.0).max(1.0) / count).collect();
    Lines { mean, variance }
}

/// The output at a line that was left out, less what the imperfect drive itself puts there, by the nearest driven line.
fn without_input(u: &Lines, y: &Lines, driven: &[bool], bin: usize) -> Complex64 {
    let near = (0..driven.len()).filter(|k| driven[*k]).min_by_key(|k| k.abs_diff(bin));
    near.map_or(y.mean[bin], |k| y.mean[bin] - y.mean[k] / u.mean[k] * u.mean[bin])
}

fn best_linear(all: &[(Lines, Lines)], bin: usize, frequency: f64) -> Point {
    let ratios: Vec<Complex64> = all.iter().map(|(u, y)| y.mean[bin] / u.mean[bin]).collect();
    let count = ratios.len() as f64;
    let value = ratios.iter().sum::<Complex64>() / count;
    let noise: f64 = all
        .iter()
        .map(|(u, y)| (y.variance[bin] + value.norm_sqr() * u.variance[bin]) / u.mean[bin].norm_sqr())
        .sum::<f64>()
        / (count * count);
    let scatter = ratios.iter().map(|r| (r - value).norm_sqr()).sum::<f64>() / (count * (count - 1.0).max(1.0));
    let variance = noise.max(scatter);
    let coherence = 1.0 - (variance * count / (value.norm_sqr() + variance * count).max(f64::MIN_POSITIVE));
    Point { frequency, value, std: variance.sqrt(), coherence: coherence.clamp(0.0, 1.0) }
}
