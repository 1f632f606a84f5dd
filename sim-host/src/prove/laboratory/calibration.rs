//! Whether what is said with a probability is true that often.

use super::super::gates::{Gate, Limit};
use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

/// A bin of the reliability diagram.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bin {
    /// Statements with a probability in this bin.
    pub statements: usize,
    /// Their mean probability.
    pub stated: f64,
    /// Share of them that are true.
    pub right: f64,
}

/// The expected calibration error: the mean distance between what is stated and what is true, over ten bins.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Calibration {
    /// Statements.
    pub statements: usize,
    /// Ten bins of equal width; empty ones are left out.
    pub bins: Vec<Bin>,
    /// The error.
    pub error: f64,
    /// What perfectly calibrated statements of these probabilities show on average.
    pub expected: f64,
    /// Standard deviation of that.
    pub scatter: f64,
}

/// Draws from which expectation and scatter are taken.
const DRAWS: usize = 500;

fn bins(statements: &[(f64, bool)]) -> Vec<Bin> {
    let mut bins = [(0_usize, 0.0, 0_usize); 10];
    for (stated, right) in statements {
        let bin = &mut bins[((stated * 10.0) as usize).min(9)];
        *bin = (bin.0 + 1, bin.1 + stated, bin.2 + usize::from(*right));
    }
    let of = |&(n, sum, right): &(usize, f64, usize)| Bin {
        statements: n,
        stated: sum / n as f64,
        right: right as f64 / n as f64,
    };
    bins.iter().filter(|bin| bin.0 > 0).map(of).collect()
}

fn error(bins: &[Bin]) -> f64 {
    let all: usize = bins.iter().map(|b| b.statements).sum();
    bins.iter().map(|b| b.statements as f64 * (b.stated - b.right).abs()).sum::<f64>() / all.max(1) as f64
}

/// The calibration of statements; none where there are none.
pub(super) fn calibration(statements: &[(f64, bool)]) -> Option<Calibration> {
    if statements.is_empty() {
        return None;
    }
    let mut rng = ChaCha8Rng::seed_from_u64(statements.len() as u64);
    let mut perfect = || -> Vec<(f64, bool)> {
        statements.iter().map(|(p, _)| (*p, (rng.next_u64() >> 11) as f64 / 9_007_199_254_740_992.0 < *p)).collect()
    };
    let drawn: Vec<f64> = (0..DRAWS).map(|_| error(&bins(&perfect()))).collect();
    let expected = drawn.iter().sum::<f64>() / DRAWS as f64;
    let scatter = (drawn.iter().map(|e| (e - expected).powi(2)).sum::<f64>() / DRAWS as f64).sqrt();
    let bins = bins(statements);
    Some(Calibration { statements: statements.len(), error: error(&bins), bins, expected, scatter })
}

/// The gates on it: the error beyond its expectation, and what is said with near certainty.
pub(super) fn gates(statements: &[(f64, bool)]) -> Vec<Gate> {
    const ONE_SIDED: f64 = 1.644_853_626_951_472_2;
    let beyond = calibration(statements);
    let beyond = beyond.map_or((f64::NAN, 0.0), |c| (c.error - c.expected, ONE_SIDED * c.scatter));
    let bounds = (beyond.0 - beyond.1, beyond.0 + beyond.1);
    let sure: Vec<_> = statements.iter().filter(|s| s.0 >= 0.99).collect();
    vec![
        Gate::bounded(
            "calibration error beyond its expectation",
            beyond.0,
            bounds,
            statements.len(),
            Limit::AtMost(0.03),
        ),
        Gate::share(
            "true, of what is said with 0.99 or more",
            sure.iter().filter(|s| s.1).count(),
            sure.len(),
            Limit::AtLeast(0.97),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::{calibration, gates};

    #[test]
    fn honest_statements_meet_the_gate_and_bold_ones_do_not() {
        let of = |stated: f64, right: usize| (0..1000).map(|i| (stated, i < right)).collect::<Vec<_>>();
        let honest = [of(0.9, 905), of(0.6, 595)].concat();
        assert_eq!(gates(&honest)[0].holds, Some(true));
        let bold = of(0.995, 930);
        assert!(gates(&bold).iter().all(|gate| gate.holds == Some(false)));
        let few = [(0.9, true); 5];
        assert_eq!(gates(&few)[0].holds, None);
        assert!(calibration(&[]).is_none());
    }
}
