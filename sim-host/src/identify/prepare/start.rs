//! Whether a recording begins in the middle of a motion: then the velocity at its start is not zero but unknown, and a fit
//! that takes it for zero pays with its other values.

use super::super::data::{Channel, Run};
use super::Prepared;
use nalgebra::{DMatrix, DVector};

/// Samples looked at, from the fewest that say anything of a velocity beside an acceleration and a jerk.
const WINDOWS: [usize; 4] = [8, 16, 32, 64];
/// Standard deviations of the slope at the first sample: what starts from rest a few samples late bends a cubic, too.
const CERTAIN: f64 = 10.0;
/// Least way in the direction of that slope, in noise: what sets off late never goes there.
const WAY: f64 = 20.0;
/// By how many of its standard deviations the mean square of what a cubic leaves may exceed the noise.
const ROUGH: f64 = 3.0;

impl Prepared {
    /// What a reader should know of how the runs were taken, one sentence each.
    pub fn remarks(&self) -> Vec<String> {
        let moving = self.fit.iter().chain(&self.holdout).filter(|run| run.moving_start && run.motion.is_none());
        let of = |run: &Run| {
            format!(
                "Run {} begins in the middle of a motion: its velocity at the start was fitted, not taken as zero.",
                run.name
            )
        };
        moving.map(of).collect()
    }
}

/// True where the measured displacement's slope at the first sample is certainly not zero.
pub(super) fn in_motion(run: &Run) -> bool {
    let Some(measured) = run.channel(Channel::Displacement).filter(|_| run.motion.is_none()) else { return false };
    WINDOWS.iter().filter_map(|&n| measured.values.get(..n)).any(|x| moves(x, measured.noise))
}

/// The same of these samples, by the cubic that fits them best.
fn moves(displacement: &[f64], noise: f64) -> bool {
    let n = displacement.len();
    let free = n as f64 - 4.0;
    let powers = DMatrix::from_fn(n, 4, |k, power| (k as f64 / n as f64).powi(power as i32));
    let x = DVector::from_column_slice(displacement);
    let Some(inverse) = powers.tr_mul(&powers).try_inverse() else { return false };
    let cubic = &inverse * powers.tr_mul(&x);
    let fitted = &powers * &cubic;
    let left = (&x - &fitted).norm_squared() / free / noise.powi(2);
    let way = fitted.iter().map(|x| (x - cubic[0]) * cubic[1].signum()).fold(0.0, f64::max);
    cubic[1].abs() > CERTAIN * noise * inverse[(1, 1)].sqrt()
        && way > WAY * noise
        && left < 1.0 + ROUGH * (2.0 / free).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    const DT: f64 = 1e-3;
    const NOISE: f64 = 1e-6;

    fn noisy(seed: u64, displacement: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut uniform = || f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
        (0..96).map(|k| displacement(f64::from(k) * DT) + NOISE * 12f64.sqrt() * uniform()).collect()
    }

    fn found(displacement: impl Fn(f64) -> f64 + Copy) -> usize {
        let moves = |x: &[f64]| WINDOWS.iter().any(|&n| moves(&x[..n], NOISE));
        (0..500).filter(|&seed| moves(&noisy(seed, displacement))).count()
    }

    #[test]
    fn a_velocity_at_the_start_is_seen_in_the_midst_of_an_acceleration() {
        assert_eq!(found(|t| 0.006 * t + 0.5 * 0.8 * t * t), 500);
        assert_eq!(found(|t| -0.01 * t + 0.5 * 0.8 * t * t), 500);
    }

    #[test]
    fn what_starts_from_rest_is_not_in_motion() {
        assert_eq!(found(|_| 0.01), 0);
        assert_eq!(found(|t| 0.5 * 2.0 * t * t - 3.0 * t * t * t), 0);
        assert_eq!(found(|t| 1e4 * t.powi(4)), 0);
        for (late, acceleration) in [(0.001, 5.0), (0.003, 2.0), (0.008, 0.5), (0.02, 20.0)] {
            assert_eq!(found(move |t| if t < late { 0.0 } else { 0.5 * acceleration * (t - late).powi(2) }), 0);
        }
    }
}
