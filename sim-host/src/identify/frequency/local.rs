//! Response from a short or transient record by local polynomials: around each frequency the response and the leakage
//! of the record's ends are both smooth, so both are fitted as parabolas over a few bins and the leakage is taken off.
//!
//! Source: R. Pintelon, J. Schoukens, G. Vandersteen, K. Barbe, "Estimation of nonparametric noise and FRF models for
//! multivariable systems, Part I", Mech. Syst. Signal Process. 24 (2010) 573-595.

use super::{Complex64, Point, Response, ResponseError, check, transform};
use nalgebra::{DMatrix, DVector};

/// Coefficients of each parabola.
const ORDER: usize = 3;

/// Response at every `spacing`-th bin of the record's spectrum from `half` bins to either side (at least 4; 6 is a good
/// start), samples `dt` apart. Coherence is the part of the local output power that the response explains.
pub fn local_polynomial(
    input: &[f64],
    output: &[f64],
    dt: f64,
    half: usize,
    spacing: usize,
) -> Result<Response, ResponseError> {
    let half = half.max(ORDER + 1);
    check(input, output, 8 * half)?;
    let (u, y) = (transform(input), transform(output));
    let width = 1.0 / (input.len() as f64 * dt);
    let last = ((0.45 * input.len() as f64) as usize).min(u.len() - 1 - half);
    let bins = (half + 1..=last).step_by(spacing.max(1));
    Ok(Response { points: bins.filter_map(|bin| point(&u, &y, bin, half, width)).collect() })
}

fn point(u: &[Complex64], y: &[Complex64], bin: usize, half: usize, width: f64) -> Option<Point> {
    let rows = 2 * half + 1;
    let at = |row: usize| bin + row - half;
    let distance = |row: usize| (row as f64 - half as f64) / half as f64;
    let size = (0..rows).map(|r| u[at(r)].norm_sqr()).sum::<f64>().sqrt();
    if size <= 0.0 {
        return None;
    }
    let matrix = DMatrix::from_fn(rows, 2 * ORDER, |row, column| {
        let power = distance(row).powf((column % ORDER) as f64);
        if column < ORDER { u[at(row)] / size * power } else { Complex64::new(power, 0.0) }
    });
    let right = DVector::from_fn(rows, |row, _| y[at(row)]);
    let normal = (matrix.adjoint() * &matrix).lu();
    let found = normal.solve(&(matrix.adjoint() * &right))?;
    let residual = &right - &matrix * &found;
    let noise = residual.norm_squared() / (rows - 2 * ORDER) as f64;
    let unit = DVector::from_fn(2 * ORDER, |i, _| Complex64::new(if i == 0 { 1.0 } else { 0.0 }, 0.0));
    let inverse = normal.solve(&unit)?;
    let value = found[0] / size;
    let std = (noise * inverse[0].re.max(0.0)).sqrt() / size;
    let power = right.norm_squared() / rows as f64;
    let coherence = (1.0 - noise / power.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (value.is_finite() && std.is_finite()).then_some(Point { frequency: bin as f64 * width, value, std, coherence })
}
