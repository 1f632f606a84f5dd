//! One sine at a time, the paper's way: the table is driven at one frequency and a real amplitude until it has settled,
//! then gain and phase are the ratio of two fitted sines.
//!
//! Both signals are fitted by least squares with a constant, a drift and harmonics up to the fifth, so that neither an
//! incomplete period nor a saturated, flattened response disturbs the fundamental (the describing function).

use super::{Complex64, Point, Response, ResponseError, check};
use crate::recording::signal::quantile;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Harmonics that are fitted beside the fundamental: the second to this one.
const HARMONICS: usize = 5;

/// What one sine says.
#[derive(Debug, Clone, PartialEq)]
pub struct SinePoint {
    /// Gain and phase of the fundamental.
    pub point: Point,
    /// Amplitude of the input, its unit.
    pub amplitude: f64,
    /// Even harmonics over the fundamental of the output, 1: unequal limits, a null bias.
    pub even: f64,
    /// Odd harmonics over the fundamental of the output, 1: saturation, friction, a deadband.
    pub odd: f64,
}

/// A sine fitted to samples.
struct SineFit {
    /// Complex amplitudes of the fundamental and the harmonics.
    lines: Vec<Complex64>,
    /// Variance of the fundamental's complex amplitude.
    variance: f64,
    /// Part of the samples' power about their line that all fitted sines hold.
    explained: f64,
}

/// Response at one frequency (Hz) from samples `dt` apart, already settled.
pub fn sine_point(input: &[f64], output: &[f64], dt: f64, frequency: f64) -> Result<SinePoint, ResponseError> {
    check(input, output, 4 * HARMONICS)?;
    let nyquist = 0.5 / dt;
    if !(frequency > 0.0 && frequency < nyquist) {
        return Err(ResponseError::OutOfBand { frequency, nyquist });
    }
    let (u, y) = (fit(input, dt, frequency)?, fit(output, dt, frequency)?);
    let size = u.lines[0].norm_sqr();
    if size <= 16.0 * u.variance || size == 0.0 {
        return Err(ResponseError::NotDriven { frequency });
    }
    let value = y.lines[0] / u.lines[0];
    let std = ((y.variance + value.norm_sqr() * u.variance) / size).sqrt();
    let part = |first: usize| {
        let harmonics = y.lines.iter().skip(first).step_by(2).map(Complex64::norm_sqr).sum::<f64>();
        (harmonics / y.lines[0].norm_sqr().max(f64::MIN_POSITIVE)).sqrt()
    };
    let point = Point { frequency, value, std, coherence: y.explained };
    Ok(SinePoint { point, amplitude: size.sqrt(), even: part(1), odd: part(2) })
}

fn fit(samples: &[f64], dt: f64, frequency: f64) -> Result<SineFit, ResponseError> {
    let n = samples.len();
    let lines = (1..=HARMONICS).take_while(|h| (*h as f64) * frequency * dt < 0.49).count();
    let column = |k: usize, j: usize| {
        let phase = 2.0 * PI * frequency * dt * k as f64 * (j / 2) as f64;
        match j {
            0 => 1.0,
            1 => k as f64 / n as f64 - 0.5,
            j if j % 2 == 0 => phase.cos(),
            _ => phase.sin(),
        }
    };
    let matrix = DMatrix::from_fn(n, 2 + 2 * lines, column);
    let right = DVector::from_column_slice(samples);
    let normal = matrix.tr_mul(&matrix).cholesky().ok_or(ResponseError::Singular)?;
    let found = normal.solve(&matrix.tr_mul(&right));
    let residual = &right - &matrix * &found;
    let noise = residual.norm_squared() / n.saturating_sub(2 + 2 * lines).max(1) as f64;
    let inverse = normal.inverse();
    let line = |j: usize| found[0] + found[1] * column(j, 1);
    let power: f64 = samples.iter().enumerate().map(|(k, x)| (x - line(k)).powi(2)).sum();
    Ok(SineFit {
        // A sine a cos + b sin is the real part of (a - jb) exp(jwt).
        lines: (0..lines).map(|h| Complex64::new(found[2 + 2 * h], -found[3 + 2 * h])).collect(),
        variance: noise * (inverse[(2, 2)] + inverse[(3, 3)]),
        explained: (1.0 - residual.norm_squared() / power.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0),
    })
}

/// A stretch of a recording in which the input is one sine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dwell {
    /// First sample.
    pub from: usize,
    /// The sample after the last.
    pub to: usize,
    /// Hz.
    pub frequency: f64,
}

/// Finds the sines in a recorded sweep of held frequencies: stretches in which the input's periods are equal within
/// 2 % for at least `periods` of them.
pub fn dwells(input: &[f64], dt: f64, periods: usize) -> Vec<Dwell> {
    let middle = 0.5 * (quantile(input, 0.001) + quantile(input, 0.999));
    let rising = |k: &usize| input[*k - 1] < middle && input[*k] >= middle;
    let crossings: Vec<f64> = (1..input.len())
        .filter(rising)
        .map(|k| k as f64 - (input[k] - middle) / (input[k] - input[k - 1]).max(f64::MIN_POSITIVE))
        .collect();
    let mut found = Vec::new();
    let mut first = 0;
    for last in 1..=crossings.len() {
        let length = |i: usize| crossings[i + 1] - crossings[i];
        let same = last + 1 < crossings.len() && (length(last) / length(first) - 1.0).abs() < 0.02;
        if same {
            continue;
        }
        if last < crossings.len() && last - first >= periods {
            let mean = (crossings[last] - crossings[first]) / (last - first) as f64;
            let (from, to) = (crossings[first].ceil() as usize, crossings[last].floor() as usize + 1);
            found.push(Dwell { from, to, frequency: 1.0 / (mean * dt) });
        }
        first = last;
    }
    found
}

/// Response from a recorded sweep of held sines; of each, the first `settle` periods are left out.
pub fn sweep(input: &[f64], output: &[f64], dt: f64, settle: usize) -> Result<Vec<SinePoint>, ResponseError> {
    check(input, output, 4 * HARMONICS)?;
    let mut points = Vec::new();
    for dwell in dwells(input, dt, settle + 2) {
        let from = dwell.from + (settle as f64 / (dwell.frequency * dt)).round() as usize;
        let (u, y) = (&input[from..dwell.to], &output[from..dwell.to]);
        points.push(sine_point(u, y, dt, dwell.frequency)?);
    }
    points.sort_by(|a, b| a.point.frequency.total_cmp(&b.point.frequency));
    Ok(points)
}

/// The points of sines as one response.
pub fn response(points: &[SinePoint]) -> Response {
    Response { points: points.iter().map(|p| p.point).collect() }
}
