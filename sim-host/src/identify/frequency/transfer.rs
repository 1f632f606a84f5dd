//! Transfer functions with delay fitted to a measured response.
//!
//! `H(s) = exp(-s tau) (b_0 + b_1 s + ... + b_m s^m) / (s^k (a_0 + ... + a_(n-1) s^(n-1) + s^n))`, k integrators being
//! given (one for a servo valve's table, Eq. 7). Three steps: Levy's linear fit, made unbiased by Sanathanan and
//! Koerner's reweighting, over a grid of delays; then Levenberg-Marquardt on the complex error in units of its standard
//! deviation. Frequencies are scaled to their geometric mean, so that high orders stay solvable.
//!
//! Sources: E. C. Levy, "Complex-curve fitting", IRE Trans. AC-4 (1959) 37-43; C. K. Sanathanan, J. Koerner, "Transfer
//! function synthesis as a ratio of two complex polynomials", IEEE Trans. AC-8 (1963) 56-58.

use super::{Complex64, Response, ResponseError, laplace};
use std::fmt;

mod linear;
mod polish;

/// What is to be fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Order {
    /// Degree m of the numerator.
    pub numerator: usize,
    /// Degree n of the denominator beside the integrators.
    pub denominator: usize,
    /// Poles at zero, k.
    pub integrators: usize,
    /// Largest delay that is tried, s; zero for none.
    pub longest_delay: f64,
}

/// A transfer function.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunction {
    /// `b_0, b_1, ...`, by rising power of s.
    pub numerator: Vec<f64>,
    /// `a_0, ..., a_(n-1)`, by rising power of s; the highest coefficient is one.
    pub denominator: Vec<f64>,
    /// Poles at zero.
    pub integrators: usize,
    /// Delay, s.
    pub delay: f64,
}

/// A fitted transfer function.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFit {
    /// The function.
    pub function: TransferFunction,
    /// Standard deviations of the numerator's coefficients, then the denominator's, then the delay's.
    pub std: Vec<f64>,
    /// Mean squared error in units of the points' standard deviation: 1 where noise alone is left.
    pub chi2: f64,
}

impl TransferFunction {
    /// The response at a frequency in Hz.
    pub fn at(&self, frequency: f64) -> Complex64 {
        let s = laplace(frequency);
        let numerator = horner(&self.numerator, s);
        let denominator = horner(&self.denominator, s) + power(s, self.denominator.len());
        (-s * self.delay).exp() * numerator / (denominator * power(s, self.integrators))
    }

    /// The poles beside the integrators, 1/s.
    pub fn poles(&self) -> Vec<Complex64> {
        roots(&self.denominator)
    }

    /// True where every pole beside the integrators decays.
    pub fn is_stable(&self) -> bool {
        self.poles().iter().all(|p| p.re < 0.0)
    }

    /// Mean squared error against a response in units of its standard deviation.
    pub fn chi2(&self, response: &Response) -> f64 {
        let weights = weights(response);
        let errors =
            response.points.iter().zip(&weights).map(|(p, w)| (w * (p.value - self.at(p.frequency))).norm_sqr());
        errors.sum::<f64>() / response.points.len().max(1) as f64
    }
}

impl fmt::Display for TransferFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = |coefficients: &[f64]| -> String {
            let terms = coefficients.iter().enumerate().rev().map(|(power, c)| match power {
                0 => format!("{c:.5}"),
                1 => format!("{c:.5} s"),
                _ => format!("{c:.5} s^{power}"),
            });
            terms.collect::<Vec<_>>().join(" + ")
        };
        let mut denominator = self.denominator.clone();
        denominator.push(1.0);
        write!(f, "({}) / (", side(&self.numerator))?;
        if self.integrators > 0 {
            write!(f, "s^{} (", self.integrators)?;
        }
        write!(f, "{})", side(&denominator))?;
        if self.integrators > 0 {
            f.write_str(")")?;
        }
        if self.delay == 0.0 { Ok(()) } else { write!(f, " exp(-{:.5} s)", self.delay) }
    }
}

/// Fits one order.
pub(crate) fn fit(response: &Response, order: Order) -> Result<TransferFit, ResponseError> {
    let free = order.numerator + 1 + order.denominator + usize::from(order.longest_delay > 0.0);
    let least = free.div_ceil(2) + 1;
    if response.points.len() < least {
        return Err(ResponseError::TooFew { what: "frequencies", found: response.points.len(), least });
    }
    let weights = weights(response);
    let start = linear::best_start(response, &weights, order)?;
    polish::polish(response, &weights, start, order)
}

/// One order and how it did.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// The order.
    pub order: Order,
    /// Its fit.
    pub fit: TransferFit,
    /// Mean squared error on the response held out.
    pub held_back: f64,
}

/// Fits every order to one response and judges each on another that was held out: another record, or another
/// amplitude's repeat. The trials come back with the chosen one first: the lowest order (fewest coefficients) whose
/// error held out is within one standard error of the best.
pub(crate) fn choose(response: &Response, held_back: &Response, orders: &[Order]) -> Result<Vec<Trial>, ResponseError> {
    let mut trials: Vec<Trial> = orders
        .iter()
        .filter_map(|&order| {
            let fit = fit(response, order).ok()?;
            let held_back = fit.function.chi2(held_back);
            held_back.is_finite().then_some(Trial { order, fit, held_back })
        })
        .collect();
    let best = trials.iter().map(|t| t.held_back).fold(f64::INFINITY, f64::min);
    if !best.is_finite() {
        return Err(ResponseError::Singular);
    }
    // A mean of n squares of complex normal numbers scatters by its value over sqrt(n).
    let tolerance = best * (1.0 + 1.0 / (held_back.points.len().max(1) as f64).sqrt());
    let size = |t: &Trial| t.order.numerator + t.order.denominator + usize::from(t.order.longest_delay > 0.0);
    trials.sort_by(|a, b| {
        let rank = |t: &Trial| if t.held_back <= tolerance { (0, size(t)) } else { (1, 0) };
        rank(a).cmp(&rank(b)).then(a.held_back.total_cmp(&b.held_back))
    });
    Ok(trials)
}

/// One over each point's standard deviation; a point that claims to be exact counts as known to a millionth.
fn weights(response: &Response) -> Vec<f64> {
    response.points.iter().map(|p| 1.0 / p.std.max(1e-6 * p.value.norm()).max(f64::MIN_POSITIVE)).collect()
}

/// A whole power.
fn power(s: Complex64, n: usize) -> Complex64 {
    s.powu(n as u32)
}

/// `scale^(up - down)`.
fn raise(scale: f64, up: usize, down: usize) -> f64 {
    scale.powf(up as f64 - down as f64)
}

/// A polynomial by rising power.
fn horner(coefficients: &[f64], s: Complex64) -> Complex64 {
    coefficients.iter().rev().fold(Complex64::new(0.0, 0.0), |sum, c| sum * s + c)
}

/// Roots of a monic polynomial by Durand and Kerner's simultaneous iteration.
fn roots(coefficients: &[f64]) -> Vec<Complex64> {
    let n = coefficients.len();
    // Scaled so that the product of the roots has size one.
    let scale = coefficients.first().map_or(1.0, |a| a.abs().powf(1.0 / n.max(1) as f64)).max(f64::MIN_POSITIVE);
    let scaled: Vec<f64> = coefficients.iter().enumerate().map(|(i, a)| a / raise(scale, n, i)).collect();
    let mut roots: Vec<Complex64> = (0..n).map(|k| power(Complex64::new(0.4, 0.9), k)).collect();
    for _ in 0..200 {
        for k in 0..n {
            let here = roots[k];
            let value = horner(&scaled, here) + power(here, n);
            let others: Complex64 = (0..n).filter(|j| *j != k).map(|j| here - roots[j]).product();
            if others.norm() > 0.0 {
                roots[k] = here - value / others;
            }
        }
    }
    roots.iter().map(|r| r * scale).collect()
}
