//! The step of a converter, found from the values it gave.

use super::signal::quantile;

/// Spacing that all values are multiples of, apart from an offset, in the samples' unit; none where they have none.
///
/// Only neighbouring values count: every gap between two that follow each other in size must be a whole number of
/// steps. Values written with few decimals have a step too, a small one.
pub(crate) fn quantisation_step(samples: &[f64]) -> Option<f64> {
    let mut values: Vec<f64> = samples.iter().copied().filter(|x| x.is_finite()).collect();
    values.sort_unstable_by(f64::total_cmp);
    let (first, last) = (*values.first()?, *values.last()?);
    let tiny = 1e-9 * (last - first).max(last.abs().max(first.abs()) * 1e-4);
    values.dedup_by(|a, b| (*a - *b).abs() <= tiny);
    if values.len() < 3 {
        return None;
    }
    let gaps: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).collect();
    let smallest = gaps.iter().copied().fold(f64::INFINITY, f64::min);
    step_of(&gaps, smallest, EXACT).or_else(|| {
        // A step that was written with few decimals is a decimal more here and less there: most gaps are one step, rounded.
        let middle = quantile(&gaps, 0.5);
        step_of(&gaps, refined(&gaps, middle), ROUNDED)
    })
}

/// How far a gap may be from a whole number of steps, in steps: as the converter gave it, and as it was written with few decimals.
const EXACT: f64 = 0.05;
const ROUNDED: f64 = 0.2;

/// The step near this one, where nearly all gaps of a few steps are whole numbers of it.
fn step_of(gaps: &[f64], near: f64, tolerance: f64) -> Option<f64> {
    let whole = |gap: &f64| {
        let count = gap / near;
        count.round() >= 1.0 && (count - count.round()).abs() < tolerance
    };
    // Values of a continuous signal have gaps of every size; the smallest one then fits few of the others.
    let small: Vec<&f64> = gaps.iter().filter(|g| **g < 20.0 * near).collect();
    let fitting = small.iter().filter(|g| whole(g)).count();
    let enough = small.len() >= (gaps.len() / 4).max(2);
    (enough && fitting * 50 >= small.len() * 49).then(|| refined(gaps, near))
}

/// The mean step over all gaps of a few steps, which rounding of single values does not touch.
fn refined(gaps: &[f64], smallest: f64) -> f64 {
    let near: Vec<(f64, f64)> =
        gaps.iter().map(|g| (*g, (g / smallest).round())).filter(|(_, count)| *count < 20.0).collect();
    near.iter().map(|(gap, _)| gap).sum::<f64>() / near.iter().map(|(_, count)| count).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_step_written_with_few_decimals_is_found() {
        let step = 0.011_285;
        let written = |k: i32| (f64::from(k) * step * 1e4).round() / 1e4;
        let samples: Vec<f64> = (0..4000).map(|k| written((300.0 * (f64::from(k) * 0.013).sin()) as i32)).collect();
        assert!((quantisation_step(&samples).unwrap() / step - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_converter_s_step_is_found_and_a_smooth_signal_has_none() {
        let smooth: Vec<f64> = (0..5000).map(|k| 0.03 * (f64::from(k) * 0.013).sin()).collect();
        let coarse: Vec<f64> = smooth.iter().map(|x| 4e-5 * (x / 4e-5 + 0.5).floor()).collect();
        assert!((quantisation_step(&coarse).unwrap() / 4e-5 - 1.0).abs() < 1e-6);
        assert_eq!(quantisation_step(&smooth), None);
        assert_eq!(quantisation_step(&[1.0; 20]), None);
    }

    proptest! {
        #[test]
        fn any_step_is_found(step in 1e-7..1e-2f64, offset in -1.0..1.0f64, counts in prop::collection::vec(-40i32..40, 300)) {
            let samples: Vec<f64> = counts.iter().map(|c| offset + f64::from(*c) * step).collect();
            prop_assert!((quantisation_step(&samples).unwrap() / step - 1.0).abs() < 1e-3);
        }
    }
}
