//! Response from any record by sine tapers: several orthogonal windows over the same samples give independent looks at
//! each frequency without cutting the record to pieces.
//!
//! Source: K. S. Riedel and A. Sidorenko, "Minimum bias multiple taper spectral estimation", IEEE Trans. Signal
//! Processing 43 (1995) 188-195.

use super::{Complex64, Point, Response, ResponseError, check, transform};
use crate::recording::signal::detrend;
use std::f64::consts::PI;

/// Sums over tapers and records at one frequency.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    input: f64,
    output: f64,
    cross: Complex64,
    looks: usize,
}

/// Response of several records of one system, each with its input and output, samples `dt` apart, by `tapers` windows
/// (8 is a good start: it smooths over `(tapers + 1) / (2 duration)` Hz to either side).
///
/// Points are one smoothing width apart, up to 0.45 of the sampling rate. The records are averaged by their power.
pub(crate) fn multitaper(records: &[(&[f64], &[f64])], dt: f64, tapers: usize) -> Result<Response, ResponseError> {
    let tapers = tapers.max(2);
    for (input, output) in records {
        check(input, output, 8 * tapers)?;
    }
    let shortest = records.iter().map(|(u, _)| u.len()).min();
    let shortest = shortest.ok_or(ResponseError::TooFew { what: "records", found: 0, least: 1 })?;
    let width = (tapers + 1) as f64 / (2.0 * shortest as f64 * dt);
    let count = (0.45 / dt / (2.0 * width)).floor() as usize;
    let mut sums = vec![Sums::default(); count];
    for (input, output) in records {
        add(&mut sums, input, output, dt, tapers, 2.0 * width);
    }
    let point = |(k, s): (usize, &Sums)| point((k + 1) as f64 * 2.0 * width, s);
    Ok(Response { points: sums.iter().enumerate().filter_map(point).collect() })
}

fn add(sums: &mut [Sums], input: &[f64], output: &[f64], dt: f64, tapers: usize, spacing: f64) {
    let n = input.len();
    let (mut u, mut y) = (input.to_vec(), output.to_vec());
    detrend(&mut u);
    detrend(&mut y);
    for taper in 1..=tapers {
        let window: Vec<f64> =
            (1..=n).map(|k| (2.0 / (n + 1) as f64).sqrt() * (PI * (taper * k) as f64 / (n + 1) as f64).sin()).collect();
        let tapered = |x: &[f64]| transform(&x.iter().zip(&window).map(|(x, w)| x * w).collect::<Vec<f64>>());
        let (fu, fy) = (tapered(&u), tapered(&y));
        for (k, sum) in sums.iter_mut().enumerate() {
            let bin = ((k + 1) as f64 * spacing * n as f64 * dt).round() as usize;
            let (Some(a), Some(b)) = (fu.get(bin), fy.get(bin)) else { continue };
            sum.input += a.norm_sqr();
            sum.output += b.norm_sqr();
            sum.cross += a.conj() * b;
            sum.looks += 1;
        }
    }
}

fn point(frequency: f64, sums: &Sums) -> Option<Point> {
    if sums.input <= 0.0 || sums.looks < 2 {
        return None;
    }
    let value = sums.cross / sums.input;
    let raw = (sums.cross.norm_sqr() / (sums.input * sums.output).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    let looks = sums.looks as f64;
    // The part of the output that is not explained, per look, over the input's power.
    let rest = sums.output * (1.0 - raw) / (looks - 1.0);
    let coherence = ((raw - 1.0 / looks) / (1.0 - 1.0 / looks)).clamp(0.0, 1.0);
    Some(Point { frequency, value, std: (rest / sums.input).sqrt(), coherence })
}
