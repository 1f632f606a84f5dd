//! A first-order lag of a sampled series, and its undoing.

/// The series behind a lag of so many samples, which answers straight lines between them: it trails a ramp by its time however short
/// that is. A sample that is no number is passed over.
pub(crate) fn lagged(series: &[f64], samples: f64) -> Vec<f64> {
    if samples <= 0.0 {
        return series.to_vec();
    }
    let kept = (-1.0 / samples).exp();
    let mean = samples * (1.0 - kept);
    let mut before = series.first().copied().unwrap_or(0.0);
    let mut state = before;
    let step = |now: &f64| {
        if now.is_finite() {
            state = kept * state + (mean - kept) * before + (1.0 - mean) * now;
            before = *now;
        }
        state
    };
    series.iter().map(step).collect()
}

/// The series as it was before a lag of so many samples. Its slope is of fourth order: a plain difference falls short by a tenth at an
/// eighth of the sampling rate.
pub(crate) fn undone(series: &[f64], samples: f64) -> Vec<f64> {
    let last = series.len().saturating_sub(1);
    let at = |k: usize, by: isize| series.get(k.saturating_add_signed(by).min(last)).copied().unwrap_or(0.0);
    let slope = |k: usize| (8.0 * (at(k, 1) - at(k, -1)) - at(k, 2) + at(k, -2)) / 12.0;
    series.iter().enumerate().map(|(k, x)| x + samples * slope(k)).collect()
}

#[cfg(test)]
mod tests {
    use super::{lagged, undone};

    #[test]
    fn a_lag_undone_leaves_what_there_was() {
        let series: Vec<f64> =
            (0..600).map(|k| (0.11 * f64::from(k)).sin() + 0.3 * (0.4 * f64::from(k)).sin()).collect();
        for samples in [0.4, 3.0, 12.0] {
            let back = undone(&lagged(&series, samples), samples);
            let away = back.iter().zip(&series).skip(100).take(400).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(away < 0.02, "{samples}: {away}");
        }
    }
}
