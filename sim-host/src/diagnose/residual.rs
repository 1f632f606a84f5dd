//! What a model leaves of a run, by channel and by frequency.

use crate::identify::data::{Channel, Run};
use crate::identify::evaluate::{Predicted, predict};
use crate::identify::fit::Fit;
use crate::plant::simulate::SimulateError;
use realfft::RealFftPlanner;

/// Residual of a channel in units of its noise.
pub(super) fn residual(run: &Run, predicted: &Predicted, channel: Channel) -> Option<Vec<f64>> {
    let place = run.measured.iter().position(|m| m.channel == channel)?;
    let measured = &run.measured[place];
    Some(measured.values.iter().zip(&predicted.channels[place]).map(|(y, m)| (y - m) / measured.noise).collect())
}

/// The channels a location looks at, the most telling first.
pub(super) fn judged_channels(run: &Run) -> Vec<Channel> {
    run.measured.iter().filter(|m| m.judged).map(|m| m.channel).collect()
}

/// Power spectrum of a series, one-sided, over its mean segments of `size` with a Hann window; white noise of unit
/// variance gives 1 everywhere.
pub(super) fn spectrum(series: &[f64], size: usize) -> Vec<f64> {
    let mut planner = RealFftPlanner::<f64>::new();
    let transform = planner.plan_fft_forward(size);
    let window: Vec<f64> =
        (0..size).map(|i| (std::f64::consts::PI * (i as f64 + 0.5) / size as f64).sin().powi(2)).collect();
    let weight: f64 = window.iter().map(|w| w * w).sum();
    let mut power = vec![0.0; size / 2 + 1];
    let mut segments = 0.0;
    let mut start = 0;
    while start + size <= series.len() {
        let clean = |x: f64| if x.is_finite() { x } else { 0.0 };
        let mut input: Vec<f64> = series[start..start + size].iter().zip(&window).map(|(&x, w)| clean(x) * w).collect();
        let mut output = transform.make_output_vec();
        if transform.process(&mut input, &mut output).is_ok() {
            power.iter_mut().zip(&output).for_each(|(p, c)| *p += c.norm_sqr() / weight);
            segments += 1.0;
        }
        start += size / 2;
    }
    for p in &mut power {
        *p /= f64::max(segments, 1.0);
    }
    power
}

/// Power over the median of the neighbourhood from which a bin is a line: one of 10^9 bins of white noise exceeds it.
const PROMINENT: f64 = 30.0;

/// The strongest line in the accelerometer's residual, Hz: where a hum would start from.
pub(super) fn strongest_line(runs: &[Run], baseline: &Fit) -> Result<f64, SimulateError> {
    let Some((run, local)) = runs.iter().zip(&baseline.locals).max_by_key(|(r, _)| r.len()) else { return Ok(50.0) };
    let predicted = predict(&baseline.model, run, local)?;
    let Some(series) = residual(run, &predicted, Channel::Acceleration) else { return Ok(50.0) };
    let size = run.len().next_power_of_two().max(16);
    let mut padded = series;
    padded.resize(size, 0.0);
    let power = spectrum(&padded, size);
    let hz = 1.0 / (size as f64 * run.dt);
    let lowest = (5.0 / hz) as usize;
    // A line stands above its own neighbourhood, a resonance does not.
    let neighbourhood = ((1.0 / hz) as usize).max(4);
    let prominence = |i: usize| {
        let around = &power[i.saturating_sub(neighbourhood)..(i + neighbourhood).min(power.len())];
        let mut sorted = around.to_vec();
        sorted.sort_by(f64::total_cmp);
        power[i] / sorted[sorted.len() / 2].max(1e-300)
    };
    let bins = || lowest.min(power.len())..power.len();
    // Among lines the strongest, for a harmonic may rise higher above its quieter neighbourhood.
    let lines: Vec<usize> = bins().filter(|&i| prominence(i) > PROMINENT).collect();
    let strongest = lines.into_iter().max_by(|&a, &b| power[a].total_cmp(&power[b]));
    let line = strongest.or_else(|| bins().max_by(|&a, &b| prominence(a).total_cmp(&prominence(b))));
    Ok(line.map_or(50.0, |i| i as f64 * hz))
}
