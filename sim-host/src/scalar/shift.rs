//! A sampled series moved in time by a part of its step.

use crate::scalar::Scalar;

/// The series as it is `by` samples later, brought to now, by cubic interpolation; its ends are held. Its derivative by
/// `by` is the interpolant's own.
pub(crate) fn earlier<S: Scalar>(series: &[S], by: S) -> Vec<S> {
    let whole = by.value().floor();
    let t = by - whole;
    let last = series.len().saturating_sub(1) as f64;
    let at = |k: f64| series.get(k.clamp(0.0, last) as usize).copied().unwrap_or(S::from(0.0));
    let between = |k: f64| {
        let (a, b, c, d) = (at(k - 1.0), at(k), at(k + 1.0), at(k + 2.0));
        let bend = (b - c) * 3.0 + d - a;
        let curve = a * 2.0 - b * 5.0 + c * 4.0 - d;
        b + t * 0.5 * (c - a + t * (curve + t * bend))
    };
    (0..series.len()).map(|k| between(k as f64 + whole)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    /// A parabola is moved exactly, and so is what moving it a little further would change.
    #[test]
    fn a_parabola_moves_exactly() {
        let parabola = |t: f64| 0.3 * t * t - t + 2.0;
        let series: Vec<Dual<4>> = (0..20).map(|k| Dual::from(parabola(f64::from(k)))).collect();
        for by in [-2.7, -0.25, 0.0, 0.4, 3.1] {
            let mut shift = Dual::<4>::from(by);
            shift.tangent[0] = 1.0;
            let moved = earlier(&series, shift);
            for (k, moved) in moved.iter().enumerate().take(13).skip(5) {
                let t = k as f64 + by;
                assert!((moved.value() - parabola(t)).abs() < 1e-12, "{by}, {k}");
                assert!((f64::from(moved.tangent[0]) - (0.6 * t - 1.0)).abs() < 1e-6, "{by}, {k}");
            }
        }
    }
}
