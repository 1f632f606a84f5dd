//! Bridges over missing samples of an input, and how far they err.

use super::signal::filled;

/// Missing samples of an input filled by the cubic through the slopes on either side; none where every sample is missing.
pub(crate) fn bridged(values: &[f64]) -> Option<Vec<f64>> {
    let known: Vec<usize> = (0..values.len()).filter(|&i| values[i].is_finite()).collect();
    if known.is_empty() {
        return None;
    }
    let mut full = filled(values);
    for pair in known.windows(2).filter(|pair| pair[1] > pair[0] + 1) {
        bridge(values, pair[0], pair[1], &mut full);
    }
    Some(full)
}

/// Fills what lies between two samples, where the slopes on either side are known.
fn bridge(values: &[f64], a: usize, b: usize, full: &mut [f64]) {
    let slope = |i: usize, j: usize, k: usize| {
        let all = values[i].is_finite() && values[j].is_finite() && values[k].is_finite();
        all.then(|| 1.5 * values[i] - 2.0 * values[j] + 0.5 * values[k])
    };
    if a + 1 < SIDE || b + SIDE > values.len() {
        return;
    }
    let (Some(leaves), Some(enters)) = (slope(a, a - 1, a - 2), slope(b, b + 1, b + 2)) else { return };
    let (length, rise) = ((b - a) as f64, values[b] - values[a]);
    let (m0, m1) = (leaves * length, -enters * length);
    for (i, value) in full.iter_mut().enumerate().take(b).skip(a + 1) {
        let t = (i - a) as f64 / length;
        *value = values[a] + t * (m0 + t * (3.0 * rise - 2.0 * m0 - m1 + t * (m0 + m1 - 2.0 * rise)));
    }
}

/// Places beside a gap where a bridge is tried, and how far off they are at most, s.
const TRIED: usize = 12;
const BESIDE: f64 = 3.0;

/// Samples on either side that say its slope.
const SIDE: usize = 3;

/// By how much a bridge over a gap may be off: the root mean square of what bridges of its length err by over known samples within a
/// few seconds of it, in the unit of the values; none where too few are known.
pub(crate) fn bridging_error(values: &[f64], (from, length): (usize, usize), dt: f64) -> Option<f64> {
    let reach = (BESIDE / dt) as usize;
    let (low, high) = (from.saturating_sub(reach).max(SIDE), (from + length + reach).min(values.len()));
    let stride = ((high - low) / TRIED).max(1);
    let (mut squares, mut count) = (0.0, 0usize);
    for start in (low..high).step_by(stride) {
        let Some(known) = values.get(start - SIDE..start + length + SIDE) else { continue };
        if known.iter().all(|x| x.is_finite()) {
            let mut full = known.to_vec();
            bridge(known, SIDE - 1, SIDE + length, &mut full);
            squares += full.iter().zip(known).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            count += length;
        }
    }
    (count > 0).then(|| (squares / count as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bridge_errs_where_the_motion_is_faster_than_it() {
        let dt = 0.01;
        let sine = |frequency: f64| -> Vec<f64> {
            (0..3000).map(|k| (std::f64::consts::TAU * frequency * f64::from(k) * dt).sin()).collect()
        };
        let error = |frequency: f64| bridging_error(&sine(frequency), (1500, 15), dt).unwrap();
        assert!(error(0.3) < 2e-3 && error(5.0) > 0.1, "{} {}", error(0.3), error(5.0));
        let mut missing = sine(0.3);
        missing[1500..1515].fill(f64::NAN);
        let full = bridged(&missing).unwrap();
        let off = full.iter().zip(sine(0.3)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 5.0 * error(0.3), "{off}");
    }
}
