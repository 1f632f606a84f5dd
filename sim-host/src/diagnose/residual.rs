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

/// Residual of the longest run, in the first of these channels that it has, in units of its noise, and the run's step (s).
pub(super) fn of_longest(
    fit: &Fit,
    runs: &[Run],
    channels: &[Channel],
) -> Result<Option<(Vec<f64>, f64)>, SimulateError> {
    let Some((run, local)) = runs.iter().zip(&fit.locals).max_by_key(|(run, _)| run.len()) else { return Ok(None) };
    let Some(&channel) = channels.iter().find(|&&channel| run.channel(channel).is_some()) else { return Ok(None) };
    let predicted = predict(&fit.model, run, local)?;
    Ok(residual(run, &predicted, channel).map(|series| (series, run.dt)))
}

/// Sums of the residuals' squares of all judged channels over parts of a run, of which each sample belongs to one.
pub(super) fn squares_in(run: &Run, predicted: &Predicted, parts: usize, part: impl Fn(usize) -> usize) -> Vec<f64> {
    let mut squares = vec![0.0; parts];
    for residual in judged_channels(run).into_iter().filter_map(|channel| residual(run, predicted, channel)) {
        for (k, r) in residual.iter().enumerate().filter(|(_, r)| r.is_finite()) {
            squares[part(k)] += r * r;
        }
    }
    squares
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

/// Power of a whole series from 0 to half its rate, missing samples as none.
pub(super) fn padded_spectrum(series: &[f64]) -> Vec<f64> {
    let size = series.len().next_power_of_two().max(16);
    let mut padded = series.to_vec();
    padded.resize(size, 0.0);
    spectrum(&padded, size)
}
