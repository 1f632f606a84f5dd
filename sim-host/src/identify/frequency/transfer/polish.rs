//! Levenberg-Marquardt on the complex error, every coefficient and the delay free.

use super::super::{Complex64, Response, ResponseError, laplace};
use super::linear::scale;
use super::{Order, TransferFit, TransferFunction, horner, power, raise};
use nalgebra::{DMatrix, DVector};

/// Most steps taken.
const STEPS: usize = 60;

/// Improves a start until it no longer gets better, and says how well each coefficient is known.
pub(super) fn polish(
    response: &Response,
    weights: &[f64],
    start: TransferFunction,
    order: Order,
) -> Result<TransferFit, ResponseError> {
    let scale = scale(response);
    let with_delay = order.longest_delay > 0.0;
    let (mut here, mut damping) = (start, 1e-3);
    let mut cost = here.chi2(response);
    for _ in 0..STEPS {
        let (jacobian, residual) = linearised(response, weights, &here, with_delay, scale);
        let normal = jacobian.tr_mul(&jacobian);
        let gradient = jacobian.tr_mul(&residual);
        let mut damped = normal.clone();
        for i in 0..damped.nrows() {
            damped[(i, i)] += damping * normal[(i, i)].max(1e-12);
        }
        let Some(step) = damped.cholesky().map(|c| c.solve(&gradient)) else { break };
        let there = stepped(&here, &step, with_delay, order.longest_delay, scale);
        let new = there.chi2(response);
        if new.is_finite() && new < cost {
            let gained = (cost - new) / cost.max(f64::MIN_POSITIVE);
            (here, cost, damping) = (there, new, (damping * 0.2).max(1e-12));
            if gained < 1e-10 {
                break;
            }
        } else {
            damping *= 5.0;
            if damping > 1e8 {
                break;
            }
        }
    }
    let std = deviations(response, weights, &here, with_delay, scale)?;
    Ok(TransferFit { function: here, std, chi2: cost })
}

/// What one unit of the i-th scaled coefficient is in its own unit.
fn unit(function: &TransferFunction, i: usize, scale: f64) -> f64 {
    let n = function.denominator.len();
    let numerators = function.numerator.len();
    match i.checked_sub(numerators) {
        None => raise(scale, n, i),
        Some(j) if j < function.denominator.len() => raise(scale, n, j),
        Some(_) => 1.0 / scale,
    }
}

/// Derivatives of the weighted response and its error, real and imaginary parts one under the other.
fn linearised(
    response: &Response,
    weights: &[f64],
    at: &TransferFunction,
    with_delay: bool,
    scale: f64,
) -> (DMatrix<f64>, DVector<f64>) {
    let (m, n) = (at.numerator.len(), at.denominator.len());
    let columns = m + n + usize::from(with_delay);
    let mut jacobian = DMatrix::zeros(2 * response.points.len(), columns);
    let mut residual = DVector::zeros(2 * response.points.len());
    for (r, (p, &weight)) in response.points.iter().zip(weights).enumerate() {
        let s = laplace(p.frequency);
        let value = at.at(p.frequency);
        let denominator = horner(&at.denominator, s) + power(s, n);
        let unit_numerator = (-s * at.delay).exp() / (denominator * power(s, at.integrators));
        let derivative = |i: usize| -> Complex64 {
            match i.checked_sub(m) {
                None => unit_numerator * power(s, i),
                Some(j) if j < n => -value * power(s, j) / denominator,
                Some(_) => -s * value,
            }
        };
        for i in 0..columns {
            let d = weight * derivative(i) * unit(at, i, scale);
            jacobian[(2 * r, i)] = d.re;
            jacobian[(2 * r + 1, i)] = d.im;
        }
        let error = weight * (p.value - value);
        (residual[2 * r], residual[2 * r + 1]) = (error.re, error.im);
    }
    (jacobian, residual)
}

fn stepped(at: &TransferFunction, step: &DVector<f64>, with_delay: bool, longest: f64, scale: f64) -> TransferFunction {
    let moved = |i: usize, value: f64| value + step[i] * unit(at, i, scale);
    let (m, n) = (at.numerator.len(), at.denominator.len());
    TransferFunction {
        numerator: at.numerator.iter().enumerate().map(|(i, b)| moved(i, *b)).collect(),
        denominator: at.denominator.iter().enumerate().map(|(j, a)| moved(m + j, *a)).collect(),
        integrators: at.integrators,
        delay: if with_delay { moved(m + n, at.delay).clamp(0.0, longest) } else { at.delay },
    }
}

/// Standard deviations from the inverse of the normal matrix. A point's std is that of the whole complex value, so each
/// part has half its variance; where the fit is worse than the noise, its error counts instead.
fn deviations(
    response: &Response,
    weights: &[f64],
    at: &TransferFunction,
    with_delay: bool,
    scale: f64,
) -> Result<Vec<f64>, ResponseError> {
    let (jacobian, residual) = linearised(response, weights, at, with_delay, scale);
    let freedom = (jacobian.nrows() - jacobian.ncols()).max(1) as f64;
    let variance = (residual.norm_squared() / freedom).max(0.5);
    let inverse = jacobian.tr_mul(&jacobian).try_inverse().ok_or(ResponseError::Singular)?;
    Ok((0..jacobian.ncols()).map(|i| (variance * inverse[(i, i)].max(0.0)).sqrt() * unit(at, i, scale)).collect())
}
