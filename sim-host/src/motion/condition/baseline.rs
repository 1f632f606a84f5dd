//! Least-squares polynomials taken out of a motion.

use super::Motion;
use nalgebra::{DMatrix, DVector};

/// The acceleration less a polynomial of a degree fitted to it.
pub(super) fn acceleration(motion: &Motion, degree: usize) -> Vec<f64> {
    let powers: Vec<usize> = (0..=degree).collect();
    let c = fit(&motion.acceleration, &powers);
    let trend = |t: f64| powers.iter().zip(&c).map(|(&p, c)| c * power(t, p)).sum::<f64>();
    subtract(&motion.acceleration, trend)
}

/// The acceleration less the derivative of a polynomial of a degree, zero at the start, fitted to the velocity.
pub(super) fn velocity(motion: &Motion, degree: usize) -> Vec<f64> {
    let powers: Vec<usize> = (1..=degree).collect();
    let c = fit(&motion.velocity, &powers);
    let duration = motion.duration();
    let slope = |t: f64| powers.iter().zip(&c).map(|(&p, c)| c * p as f64 * power(t, p - 1)).sum::<f64>() / duration;
    subtract(&motion.acceleration, slope)
}

fn power(t: f64, exponent: usize) -> f64 {
    t.powi(i32::try_from(exponent).unwrap_or(0))
}

fn place(k: usize, n: usize) -> f64 {
    k as f64 / n.saturating_sub(1).max(1) as f64
}

fn subtract(signal: &[f64], trend: impl Fn(f64) -> f64) -> Vec<f64> {
    signal.iter().enumerate().map(|(k, x)| x - trend(place(k, signal.len()))).collect()
}

/// Coefficients of powers of time, which runs from 0 to 1 over the signal; zeros where samples are too few.
fn fit(signal: &[f64], powers: &[usize]) -> Vec<f64> {
    let m = powers.len();
    let (mut normal, mut right) = (DMatrix::zeros(m, m), DVector::zeros(m));
    for (k, x) in signal.iter().enumerate() {
        let basis = DVector::from_iterator(m, powers.iter().map(|&p| power(place(k, signal.len()), p)));
        right += &basis * *x;
        normal += &basis * basis.transpose();
    }
    normal.cholesky().map_or_else(|| vec![0.0; m], |c| c.solve(&right).iter().copied().collect())
}
