//! How far gains may be off: by what changes in them where a stretch of the band is left out.
//!
//! Least squares alone would say how far independent noise can move them, timing known. What is left of a log is not that: it holds what
//! fell between its samples and what the law does beside the terms, alike in neighbouring bins, and delay and lags are fitted too. So
//! every stretch of the band is left out in turn, timing fitted anew, and the spread of the gains is taken as the jackknife takes it
//! (Efron and Stein, The jackknife estimate of variance, 1981).

use super::fit::{Fitted, Problem};

/// Stretches of the band, each with the same share of the target's weighted power.
const STRETCHES: usize = 10;

/// Standard errors of a fit's gains; where the least squares' own are larger, those.
pub(super) fn errors(problem: &Problem, active: &[bool], fitted: &Fitted) -> Vec<f64> {
    let edges = problem.edges(STRETCHES);
    let without: Vec<Vec<f64>> = edges
        .windows(2)
        .filter_map(|edge| {
            let rest = problem.without(edge[0], edge[1]);
            rest.near(active, fitted.timing, fitted.timing.lag > 0.0).map(|f| f.gains)
        })
        .collect();
    let count = without.len() as f64;
    (0..active.len())
        .map(|i| {
            let mean = without.iter().map(|gains| gains[i]).sum::<f64>() / count;
            let squares = without.iter().map(|gains| (gains[i] - mean).powi(2)).sum::<f64>();
            let jackknife = ((count - 1.0) / count * squares).sqrt();
            if jackknife.is_finite() { jackknife.max(fitted.std[i]) } else { f64::INFINITY }
        })
        .collect()
}
