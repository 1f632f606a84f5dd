//! A curve on its way into the page: thinned so that every extreme stays, and written in few bytes.

use serde::Serialize;

/// Most samples of one curve that go into a page: several for every pixel, so zooming in still shows more.
pub(crate) const MOST_SAMPLES: usize = 10_000;

/// Abscissa values, in the shortest of three forms.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub(crate) enum Abscissa {
    /// `from + step * (0, 1, ... count - 1)`.
    Uniform { from: f64, step: f64, count: usize },
    /// `from + step * (running sum of skips)`: samples picked out of a uniform axis.
    Picked { from: f64, step: f64, skips: Vec<usize> },
    /// Each value on its own.
    Listed { values: Vec<f64> },
}

/// A curve ready to be written; `None` is a gap.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Curve {
    /// Abscissa.
    pub(crate) x: Abscissa,
    /// Ordinate, as long as the abscissa.
    pub(crate) y: Vec<Option<f64>>,
    /// The samples there were, where fewer are here.
    pub(crate) thinned_from: Option<usize>,
}

/// Which axes are logarithmic, and so cannot show zero or less.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Logs {
    pub(crate) x: bool,
    pub(crate) y: bool,
}

impl Curve {
    /// Drops samples without a place on the abscissa, thins what is long, rounds to what a screen can show.
    pub(crate) fn new(x: &[f64], y: &[f64], logs: Logs) -> Self {
        let drawable = |v: f64, log: bool| v.is_finite() && (!log || v > 0.0);
        let placed: Vec<usize> = (0..x.len().min(y.len())).filter(|&i| drawable(x[i], logs.x)).collect();
        let xs: Vec<f64> = placed.iter().map(|&i| x[i]).collect();
        let ys: Vec<Option<f64>> = placed.iter().map(|&i| drawable(y[i], logs.y).then(|| round(y[i], 5))).collect();
        let ordered = xs.windows(2).all(|w| w[0] <= w[1]);
        let kept = if ordered { thin(&ys, MOST_SAMPLES) } else { (0..xs.len()).collect() };
        Self {
            x: abscissa(&xs, &kept),
            y: kept.iter().map(|&i| ys[i]).collect(),
            thinned_from: (kept.len() < xs.len()).then_some(xs.len()),
        }
    }

    /// Smallest and largest ordinate, if there is any.
    pub(crate) fn range(&self) -> Option<(f64, f64)> {
        self.y.iter().flatten().fold(None, |range, &v| match range {
            None => Some((v, v)),
            Some((low, high)) => Some((v.min(low), v.max(high))),
        })
    }
}

/// Indices to keep: of each stretch its smallest and largest value and one gap, so that no spike and no gap is lost.
fn thin(y: &[Option<f64>], most: usize) -> Vec<usize> {
    if y.len() <= most {
        return (0..y.len()).collect();
    }
    let stretch = y.len().div_ceil(most / 3);
    let mut kept = vec![0];
    for start in (0..y.len()).step_by(stretch) {
        let range = start..(start + stretch).min(y.len());
        let values = || range.clone().filter_map(|i| y[i].map(|v| (i, v)));
        let lowest = values().min_by(|a, b| a.1.total_cmp(&b.1));
        let highest = values().max_by(|a, b| a.1.total_cmp(&b.1));
        let gap = range.clone().find(|&i| y[i].is_none());
        let mut chosen: Vec<usize> = [lowest.map(|p| p.0), highest.map(|p| p.0), gap].into_iter().flatten().collect();
        chosen.sort_unstable();
        kept.extend(chosen);
    }
    kept.push(y.len() - 1);
    kept.dedup();
    kept
}

/// The shortest form of the values of `x` at the indices `kept`.
fn abscissa(x: &[f64], kept: &[usize]) -> Abscissa {
    let listed = || Abscissa::Listed { values: kept.iter().map(|&i| round(x[i], 7)).collect() };
    let (Some(&from), Some(&to)) = (x.first(), x.last()) else { return listed() };
    if x.len() < 3 {
        return listed();
    }
    let step = (to - from) / (x.len() - 1) as f64;
    let uniform = step > 0.0 && x.iter().enumerate().all(|(i, v)| (v - from - step * i as f64).abs() < 1e-4 * step);
    let (from, step) = (round(from, 12), round(step, 12));
    match (uniform, kept.len() == x.len()) {
        (false, _) => listed(),
        (true, true) => Abscissa::Uniform { from, step, count: x.len() },
        (true, false) => {
            let skips = kept.iter().scan(0, |last, &i| Some(i - std::mem::replace(last, i))).collect();
            Abscissa::Picked { from, step, skips }
        }
    }
}

/// `value` with so many significant digits.
fn round(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn samples(abscissa: &Abscissa) -> Vec<f64> {
        match abscissa {
            Abscissa::Uniform { from, step, count } => (0..*count).map(|i| from + step * i as f64).collect(),
            Abscissa::Picked { from, step, skips } => {
                let indices = skips.iter().scan(0, |sum, skip| {
                    *sum += skip;
                    Some(*sum)
                });
                indices.map(|i| from + step * i as f64).collect()
            }
            Abscissa::Listed { values } => values.clone(),
        }
    }

    #[test]
    fn one_spike_in_a_million_samples_stays() {
        let x: Vec<f64> = (0..1_000_000).map(|i| f64::from(i) * 1e-3).collect();
        let mut y = vec![0.0; x.len()];
        y[456_789] = 7.5;
        y[456_790] = -3.25;
        let curve = Curve::new(&x, &y, Logs::default());
        assert!(curve.y.len() <= MOST_SAMPLES + 2, "{}", curve.y.len());
        assert_eq!(curve.range(), Some((-3.25, 7.5)));
        assert_eq!(curve.thinned_from, Some(1_000_000));
        let place = curve.y.iter().position(|&v| v == Some(7.5)).unwrap();
        assert!((samples(&curve.x)[place] - 456.789).abs() < 1e-6);
    }

    #[test]
    fn a_gap_stays_a_gap() {
        let x: Vec<f64> = (0..50_000).map(f64::from).collect();
        let mut y = x.clone();
        y[30_000] = f64::NAN;
        assert!(Curve::new(&x, &y, Logs::default()).y.contains(&None));
    }

    #[test]
    fn logarithmic_axes_drop_what_they_cannot_show() {
        let curve = Curve::new(&[0.0, 1.0, 10.0], &[1.0, -1.0, 1.0], Logs { x: true, y: true });
        assert_eq!(samples(&curve.x), [1.0, 10.0]);
        assert_eq!(curve.y, [None, Some(1.0)]);
    }

    #[test]
    fn a_loop_keeps_its_order() {
        let x = [0.0, 1.0, 0.5, -1.0];
        let curve = Curve::new(&x, &[1.0, 2.0, 3.0, 4.0], Logs::default());
        assert_eq!(samples(&curve.x), x);
    }

    proptest! {
        #[test]
        fn extremes_and_ends_survive_thinning(y in prop::collection::vec(-1e6..1e6_f64, 1..5_000), most in 9_usize..500) {
            let values: Vec<Option<f64>> = y.iter().copied().map(Some).collect();
            let kept = thin(&values, most);
            let of = |v: &mut dyn Iterator<Item = f64>| v.fold((f64::MAX, f64::MIN), |r, v| (r.0.min(v), r.1.max(v)));
            prop_assert_eq!(of(&mut y.iter().copied()), of(&mut kept.iter().map(|&i| y[i])));
            prop_assert_eq!((kept[0], *kept.last().unwrap()), (0, y.len() - 1));
            prop_assert!(kept.windows(2).all(|w| w[0] < w[1]));
            prop_assert!(kept.len() <= most + 2 || y.len() <= most);
        }

        #[test]
        fn what_is_written_is_what_was_measured(
            from in -1e3..1e3_f64,
            step in 1e-4..10.0_f64,
            y in prop::collection::vec(-1e3..1e3_f64, 3..300),
        ) {
            let x: Vec<f64> = (0..y.len()).map(|i| from + step * i as f64).collect();
            let curve = Curve::new(&x, &y, Logs::default());
            for ((a, b), (c, d)) in samples(&curve.x).iter().zip(&curve.y).zip(x.iter().zip(&y)) {
                prop_assert!((a - c).abs() <= 1e-3 * step, "{} {}", a, c);
                prop_assert!((b.unwrap() - d).abs() <= 1e-4 * d.abs());
            }
        }
    }
}
