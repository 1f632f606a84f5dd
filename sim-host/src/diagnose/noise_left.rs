//! The noise of each channel by what a model that explains the recordings leaves: what was stated of it, and whether it grows with
//! the motion.

use super::residual::{judged_channels, residual};
use super::verdict::Conclusion;
use crate::identify::data::{Channel, Run};
use crate::identify::evaluate::Predicted;
use crate::identify::judge::score;
use crate::identify::prepare::Prepared;
use crate::plant::simulate::SimulateError;
use crate::recording::{Doubt, Experiment, SetUpFinding};

/// Factor between stated and found that is worth a word.
const WORTH: f64 = 1.035;
/// Standard errors beyond which it is no chance.
const CERTAIN: f64 = 5.0;
/// Factor by which the noise of the fastest quarter exceeds that of the slowest, that is worth a word.
const GROWTH: f64 = 1.12;
/// Largest residuals left out, as a share: spikes are reported by themselves.
const TRIMMED: f64 = 0.002;

/// Adds what is found to the findings, in the place of what was thought of the noise before anything was explained.
pub(super) fn report(
    experiment: &Experiment,
    whole: &Prepared,
    conclusion: &Conclusion,
    findings: &mut Vec<SetUpFinding>,
) -> Result<(), SimulateError> {
    if conclusion.unlisted || conclusion.more_missing {
        return Ok(());
    }
    let fitted = score(&conclusion.after.fit.model, &whole.fit)?;
    let mut looks: Vec<(&Run, &Predicted)> = whole.fit.iter().zip(&fitted.predicted).collect();
    if conclusion.held_out {
        looks.extend(conclusion.judging.iter().zip(&conclusion.after.hold.predicted));
    }
    let mut channels: Vec<Channel> = whole.fit.iter().flat_map(judged_channels).collect();
    channels.sort_unstable();
    channels.dedup();
    let colour = fitted.colour.max(conclusion.after.hold.colour).max(1.0);
    for channel in channels.into_iter().filter(|c| *c != Channel::SupplyPressure) {
        let rows = rows(&looks, channel);
        let (Some(found), Some(noise)) = (power(rows.iter().map(|r| r.0)), noise_of(whole, channel)) else { continue };
        if let Some(stated) = stated(experiment, channel) {
            let value = noise * found.sqrt();
            let std = (colour / (2.0 * rows.len() as f64)).sqrt();
            findings.retain(|f| f.what != Doubt::Noise || f.channel != Some(channel.name()));
            if (value / stated).ln().abs() > WORTH.ln().max(CERTAIN * std) {
                findings.push(SetUpFinding::noise(channel.name(), stated, value, value * std, channel.unit()));
            }
        }
        if let Some((factor, std)) = growth(rows, colour).filter(|(f, std)| *f > GROWTH.max(1.0 + CERTAIN * std)) {
            findings.push(SetUpFinding::noise_growth(channel.name(), factor - 1.0, std));
        }
    }
    Ok(())
}

fn noise_of(whole: &Prepared, channel: Channel) -> Option<f64> {
    whole.fit.iter().find_map(|run| run.channel(channel)).map(|m| m.noise)
}

/// What the experiment states of a channel's noise, where it does.
fn stated(experiment: &Experiment, channel: Channel) -> Option<f64> {
    experiment.runs.iter().find_map(|run| run.noise.get(channel.recorded()).copied())
}

/// Residual, in units of the noise, and size of the motion that would shake it, sample by sample.
fn rows(looks: &[(&Run, &Predicted)], channel: Channel) -> Vec<(f64, f64)> {
    let mut rows = Vec::new();
    for (run, predicted) in looks {
        let Some(left) = residual(run, predicted, channel) else { continue };
        let Some(place) = run.measured.iter().position(|m| m.channel == channel) else { continue };
        let shown = &predicted.channels[place];
        let moves = |k: usize| match channel {
            Channel::Displacement => (shown[(k + 1).min(shown.len() - 1)] - shown[k.saturating_sub(1)]).abs() / run.dt,
            _ => shown[k].abs(),
        };
        rows.extend(left.iter().enumerate().filter(|(_, r)| r.is_finite()).map(|(k, r)| (*r, moves(k))));
    }
    rows
}

/// Mean square without the largest.
fn power(residuals: impl Iterator<Item = f64>) -> Option<f64> {
    let mut squares: Vec<f64> = residuals.map(|r| r * r).collect();
    squares.sort_unstable_by(f64::total_cmp);
    let kept = (squares.len() as f64 * (1.0 - TRIMMED)) as usize;
    // Without its largest 0.2 % a normal variable's square is 0.977 on average.
    (kept > 200).then(|| squares[..kept].iter().sum::<f64>() / kept as f64 / 0.977)
}

/// Standard deviation of the residual in the fastest quarter over that in the slowest, with its standard error.
fn growth(mut rows: Vec<(f64, f64)>, colour: f64) -> Option<(f64, f64)> {
    rows.sort_unstable_by(|a, b| a.1.total_cmp(&b.1));
    let quarter = rows.len() / 4;
    let slow = power(rows[..quarter].iter().map(|r| r.0))?;
    let fast = power(rows[rows.len() - quarter..].iter().map(|r| r.0))?;
    Some(((fast / slow).sqrt(), (colour / quarter as f64).sqrt()))
}
