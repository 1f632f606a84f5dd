//! Levy's linear fit with Sanathanan and Koerner's reweighting, over a grid of delays.

use super::super::{Complex64, Response, ResponseError, laplace};
use super::{Order, TransferFunction, power, raise};
use nalgebra::{DMatrix, DVector};

/// Reweighted solutions of one delay.
const PASSES: usize = 12;

/// Delays that are tried.
const DELAYS: usize = 40;

/// The best linear fit over all delays tried.
pub(super) fn best_start(
    response: &Response,
    weights: &[f64],
    order: Order,
) -> Result<TransferFunction, ResponseError> {
    let delays = if order.longest_delay > 0.0 { DELAYS } else { 0 };
    (0..=delays)
        .filter_map(|k| {
            let delay = order.longest_delay * k as f64 / DELAYS as f64;
            let function = reweighted(response, weights, order, delay)?;
            let cost = function.chi2(response);
            cost.is_finite().then_some((function, cost))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(function, _)| function)
        .ok_or(ResponseError::Singular)
}

/// Geometric mean of the angular frequencies.
pub(super) fn scale(response: &Response) -> f64 {
    let logs: f64 = response.points.iter().map(|p| laplace(p.frequency).im.ln()).sum();
    (logs / response.points.len() as f64).exp()
}

/// Solves again and again, each time weighted by the denominator found before; keeps the best.
fn reweighted(response: &Response, weights: &[f64], order: Order, delay: f64) -> Option<TransferFunction> {
    let scale = scale(response);
    let mut reweight = vec![1.0; weights.len()];
    let mut best: Option<(TransferFunction, f64)> = None;
    for _ in 0..PASSES {
        let solution = solve(response, weights, &reweight, order, delay, scale)?;
        let function = unscaled(&solution, order, delay, scale);
        for (w, p) in reweight.iter_mut().zip(&response.points) {
            *w = 1.0 / denominator(&solution, order, laplace(p.frequency) / scale).norm().max(1e-12);
        }
        let cost = function.chi2(response);
        if best.as_ref().is_none_or(|(_, least)| cost < *least) {
            best = Some((function, cost));
        }
    }
    best.map(|(function, _)| function)
}

fn denominator(solution: &DVector<f64>, order: Order, s: Complex64) -> Complex64 {
    let a = (0..order.denominator).map(|i| solution[order.numerator + 1 + i] * power(s, i));
    a.sum::<Complex64>() + power(s, order.denominator)
}

/// Least squares of `b(s) - y a(s) = y s^n`, y being the response without delay and integrators, in scaled s.
fn solve(
    response: &Response,
    weights: &[f64],
    reweight: &[f64],
    order: Order,
    delay: f64,
    scale: f64,
) -> Option<DVector<f64>> {
    let columns = order.numerator + 1 + order.denominator;
    let rows = response.points.len();
    let mut matrix = DMatrix::zeros(2 * rows, columns);
    let mut right = DVector::zeros(2 * rows);
    for (r, p) in response.points.iter().enumerate() {
        let s = laplace(p.frequency);
        let lift = (s * delay).exp() * power(s, order.integrators);
        let y = p.value * lift;
        let weight = weights[r] * reweight[r] / lift.norm();
        let s = s / scale;
        let mut put = |column: usize, value: Complex64| {
            matrix[(2 * r, column)] = weight * value.re;
            matrix[(2 * r + 1, column)] = weight * value.im;
        };
        for i in 0..=order.numerator {
            put(i, power(s, i));
        }
        for i in 0..order.denominator {
            put(order.numerator + 1 + i, -y * power(s, i));
        }
        let value = weight * y * power(s, order.denominator);
        (right[2 * r], right[2 * r + 1]) = (value.re, value.im);
    }
    // Columns of one size, so that the tolerance below means the same for all.
    let sizes: Vec<f64> = matrix.column_iter().map(|c| c.norm().max(f64::MIN_POSITIVE)).collect();
    for (mut column, size) in matrix.column_iter_mut().zip(&sizes) {
        column /= *size;
    }
    let solved = matrix.svd(true, true).solve(&right, 1e-13).ok()?;
    Some(DVector::from_fn(columns, |i, _| solved[i] / sizes[i]))
}

fn unscaled(solution: &DVector<f64>, order: Order, delay: f64, scale: f64) -> TransferFunction {
    let lift = |value: f64, degree: usize| value * raise(scale, order.denominator, degree);
    TransferFunction {
        numerator: (0..=order.numerator).map(|i| lift(solution[i], i)).collect(),
        denominator: (0..order.denominator).map(|i| lift(solution[order.numerator + 1 + i], i)).collect(),
        integrators: order.integrators,
        delay,
    }
}
