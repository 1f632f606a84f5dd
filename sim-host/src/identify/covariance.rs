//! How far estimates may be off: errors that hold for coloured and misfitting residuals, estimated from how much each stretch of
//! a run moves each parameter.
//!
//! Three things make the plain sandwich of curvature and scores too sure of itself, and all three are at home where a
//! parameter shows for moments only: at an end stop, at a limit, at a reversal. A stretch that alone knows a parameter pulls
//! the fit to itself, so that its score says nothing of its error: scores are divided by what the others know. A spread told
//! from few stretches is itself uncertain: it is widened as Student's distribution is against the normal one. And the
//! misfit that counts for a parameter is that of the stretches that know it, not that of the run.
//!
//! Source: R. M. Bell, D. F. McCaffrey, "Bias reduction in standard errors for linear regression with multi-stage samples",
//! Survey Methodology 28 (2002) 169-181.

use super::normal::{Block, Normal};
use nalgebra::{DMatrix, DVector};

/// Half width of a 90 % interval in standard deviations.
pub const NINETY: f64 = 1.645;
/// Most of what is known of a parameter that one stretch counts for when its score is corrected.
const MOST: f64 = 0.9;
/// Fewest stretches that a spread counts to be estimated from.
const FEWEST: f64 = 2.0;

/// A parameter's variance, told in two ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Variance {
    /// From how far each stretch moves it.
    spread: f64,
    /// Equal stretches that the spread is worth.
    parts: f64,
    /// From the curvature of the squares and the misfit where it shows.
    curved: f64,
}

impl Variance {
    /// The one to count with: where residuals are white the curvature alone is the sharper estimate; the larger of the two is honest.
    pub(super) fn honest(self) -> f64 {
        (self.spread * (student(self.parts) / NINETY).powi(2)).max(self.curved)
    }

    /// That of the difference of two, whose stretches tell one spread: of more stretches, and chosen once as the larger. Its degrees of
    /// freedom are those of B. L. Welch, "The generalization of `Student's' problem when several different population variances are
    /// involved", Biometrika 34 (1947) 28-35.
    pub(super) fn with(self, other: Self) -> Self {
        let spread = self.spread + other.spread;
        let unsure = self.spread.powi(2) / self.parts + other.spread.powi(2) / other.parts;
        Self { spread, parts: spread.powi(2) / unsure.max(f64::MIN_POSITIVE), curved: self.curved + other.curved }
    }
}

/// Covariance of all parameters, in the order of the normal equations; none where the data do not determine them.
pub(super) fn covariance(normal: &Normal) -> Option<DMatrix<f64>> {
    let (spread, variances) = told_twice(normal)?;
    Some(DMatrix::from_fn(
        spread.nrows(),
        spread.nrows(),
        |i, j| if i == j { variances[i].honest() } else { spread[(i, j)] },
    ))
}

/// The variance of every parameter, in the order of the normal equations; none where the data do not determine them.
pub(super) fn variances(normal: &Normal) -> Option<Vec<Variance>> {
    told_twice(normal).map(|(_, variances)| variances)
}

/// The covariance that the stretches tell, and the variances with what the curvature says beside.
fn told_twice(normal: &Normal) -> Option<(DMatrix<f64>, Vec<Variance>)> {
    let n = normal.gradient.len();
    let inverse = normal.inverse()?;
    let chi2 = (normal.squares / (normal.rows as f64 - n as f64).max(1.0)).max(1.0);
    let mut spread = DMatrix::zeros(n, n);
    let (mut misfit, mut concentration) = (DVector::<f64>::zeros(n), DVector::<f64>::zeros(n));
    for block in normal.blocks.iter().filter(|block| block.rows > 0) {
        let (shares, moved) = told(block, &inverse);
        spread += &moved * moved.transpose();
        misfit += &shares * (block.squares / block.rows as f64);
        concentration += shares.map(|share| share * share);
    }
    let variance = |i: usize| Variance {
        spread: spread[(i, i)],
        parts: (1.0 / concentration[i]).max(FEWEST),
        curved: inverse[(i, i)] * chi2.max(misfit[i]),
    };
    let variances = (0..n).map(variance).collect();
    Some((spread, variances))
}

/// What share of all that is known of each parameter a block knows, and by how much its residuals alone would move each
/// from where the others have it.
fn told(block: &Block, inverse: &DMatrix<f64>) -> (DVector<f64>, DVector<f64>) {
    let own = block.columns(inverse);
    let known = &own * &block.matrix;
    let share = |i: usize| known.row(i).dot(&own.row(i)) / inverse[(i, i)].max(f64::MIN_POSITIVE);
    let shares = DVector::from_fn(inverse.nrows(), |i, _| share(i));
    let mut moved = &own * &block.gradient;
    moved.iter_mut().zip(shares.iter()).for_each(|(moved, &share)| *moved /= 1.0 - share.min(MOST));
    (shares, moved)
}

/// Half width of a 90 % interval in standard deviations estimated from so many equal parts: Student's distribution by the
/// expansion of Cornish and Fisher, right to three parts in a hundred from two degrees on.
fn student(parts: f64) -> f64 {
    let (z, inverse) = (NINETY, 1.0 / parts.max(FEWEST));
    let terms = [
        (z.powi(3) + z) / 4.0,
        (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
        (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
    ];
    z + terms.into_iter().rev().fold(0.0, |sum, term| (sum + term) * inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One parameter of slope `slopes[b]` in 50 rows of each block, whose residuals are all `residuals[b]`.
    fn normal(slopes: &[f64], residuals: &[f64]) -> Normal {
        let mut sum = Normal::zeros(1);
        for (&slope, &residual) in slopes.iter().zip(residuals) {
            let of = |value: f64| DMatrix::from_element(1, 1, 50.0 * value);
            let gradient = DVector::from_element(1, 50.0 * slope * residual);
            let (matrix, squares) = (of(slope * slope), 50.0 * residual * residual);
            let block = Block { places: (1, 1), matrix: matrix.clone(), gradient: gradient.clone(), squares, rows: 50 };
            sum.add(Normal { matrix, gradient, squares, rows: 50, blocks: vec![block] }, 1, 1);
        }
        sum
    }

    #[test]
    fn students_widths_are_the_tables() {
        for (parts, width) in [(2.0, 2.920), (3.0, 2.353), (5.0, 2.015), (10.0, 1.812), (30.0, 1.697), (1e9, 1.645)] {
            assert!((student(parts) / width - 1.0).abs() < 0.03, "{parts}: {} {width}", student(parts));
        }
    }

    /// Two spreads of two stretches each are one of four; the larger of spread and curvature is chosen once.
    #[test]
    fn a_difference_pools_what_both_tell() {
        let one = Variance { spread: 1.0, parts: 2.0, curved: 0.5 };
        assert_eq!(one.with(one), Variance { spread: 2.0, parts: 4.0, curved: 1.0 });
        assert!(one.with(one).honest() < 2.0 * one.honest());
        let curved = Variance { curved: 9.0, ..one };
        assert!((one.with(curved).honest() - 9.5).abs() < 1e-12);
    }

    /// Residuals that are alike through a block count once a block: the spread of the blocks' means is the error.
    #[test]
    fn many_blocks_give_the_spread_of_their_means() {
        let residuals: Vec<f64> = (0..400).map(|b| if b % 2 == 0 { 3.0 } else { -3.0 }).collect();
        let variance = covariance(&normal(&[1.0; 400], &residuals)).unwrap()[(0, 0)];
        assert!((variance / (9.0 / 400.0) - 1.0).abs() < 0.02, "{variance}");
    }

    /// What two blocks of a hundred know is as unsure as what is estimated from two, whatever the other ninety-eight say.
    #[test]
    fn few_blocks_that_know_a_parameter_are_few() {
        let knows = |b: usize| b < 2;
        let slopes: Vec<f64> = (0..100).map(|b| if knows(b) { 1.0 } else { 1e-3 }).collect();
        let residuals: Vec<f64> = (0..100).map(|b| if knows(b) { 2.0 - 4.0 * b as f64 } else { 0.1 }).collect();
        let variance = covariance(&normal(&slopes, &residuals)).unwrap()[(0, 0)];
        // Each moves the estimate by 1; each knows half, so from where the other has it by 2; Student's width for two.
        let exact = 2.0 * 4.0 * (2.920_f64 / NINETY).powi(2);
        assert!((variance / exact - 1.0).abs() < 0.05, "{variance} {exact}");
    }

    /// A block that alone knows a parameter has no residual left to speak of: its misfit speaks.
    #[test]
    fn the_misfit_that_counts_is_where_the_parameter_shows() {
        let slopes: Vec<f64> = (0..100).map(|b| if b == 0 { 1.0 } else { 0.0 }).collect();
        let mut quiet = normal(&slopes, &[0.1; 100]);
        quiet.blocks[0].squares = 50.0 * 9.0;
        quiet.blocks[0].gradient.fill(0.0);
        let variance = covariance(&quiet).unwrap()[(0, 0)];
        assert!((variance - 9.0 / 50.0).abs() < 1e-9, "{variance}");
    }
}
