//! What the physics that was found changes for who runs the table: how well it tracks, how fast it goes, whether its gains
//! still stand.

use super::verdict::Conclusion;
use crate::identify::data::{Channel, Measured, Run};
use crate::identify::evaluate::{Local, predict};
use crate::identify::fit::Fit;
use crate::identify::model::Model;
use crate::identify::prepare::Prepared;
use crate::plant::simulate::{SimulateError, SimulatedLaw};
use crate::recording::signal::rms;
use rayon::prelude::*;
use serde::Serialize;

/// Gain margin at which gains stand, as a factor: the customary 6 dB.
pub(crate) const CUSTOMARY: f64 = 2.0;
/// Factors on what the controller sends that are tried: the least, the step from one to the next, the most.
const FACTORS: (f64, f64, f64) = (0.25, 1.12, 10.0);
/// The step that a loop is to settle after: share of the travel seen, when, and how long it is watched, s.
const STEP: (f64, f64, f64) = (0.05, 0.1, 6.0);
/// Share of the step that may still move in the last quarter of that time.
const SETTLED: f64 = 0.02;
/// Longest time for which the largest command is held, s.
const HELD: f64 = 1.0;

/// What changes.
#[derive(Debug, Clone, Serialize)]
pub struct Change {
    /// Each run that judges, where a reference drove it.
    pub tracking: Vec<Tracking>,
    /// The speeds that the largest command seen leads to within the travel seen; none where no command is simulated.
    pub reach: Option<Reach>,
    /// By what factor all that the controller sends can be raised before the loop no longer settles; none where the runs were
    /// driven by a recorded command.
    pub gains: Option<GainMargins>,
}

/// RMS of reference less displacement in one run, m.
#[derive(Debug, Clone, Serialize)]
pub struct Tracking {
    /// The run.
    pub run: String,
    /// As recorded.
    pub measured: f64,
    /// As the stated model has it.
    pub stated: f64,
    /// As the model with what was found has it.
    pub found: f64,
}

/// Greatest speeds, m/s.
#[derive(Debug, Clone, Serialize)]
pub struct Reach {
    /// The command held, in its unit, to either side.
    pub command: f64,
    /// Stated model under the positive and the negative command.
    pub stated: [f64; 2],
    /// Model with what was found.
    pub found: [f64; 2],
}

/// Gain margins as factors; none where the loop settles at every factor tried, which is up to ten.
#[derive(Debug, Clone, Serialize)]
pub struct GainMargins {
    /// Of the stated model.
    pub stated: Option<f64>,
    /// Of the model with what was found.
    pub found: Option<f64>,
    /// Whether the found one is at least [`CUSTOMARY`].
    pub stand: bool,
}

/// What the accepted model changes against the stated one; none where nothing was accepted or measured motion drives.
pub(super) fn change(prepared: &Prepared, conclusion: &Conclusion) -> Result<Option<Change>, SimulateError> {
    let (stated, found) = (&conclusion.stated.fit, &conclusion.accepted.fit);
    let Some(pattern) = prepared.fit.first().filter(|run| run.motion.is_none()) else { return Ok(None) };
    if stated.model.ids() == found.model.ids() {
        return Ok(None);
    }
    let gains = if pattern.law.simulates_reference() {
        let travel = prepared.signal_scales.displacement;
        let [stated, found] = [margin(&stated.model, pattern, travel)?, margin(&found.model, pattern, travel)?];
        Some(GainMargins { stated, found, stand: found.is_none_or(|factor| factor >= CUSTOMARY) })
    } else {
        None
    };
    Ok(Some(Change { tracking: tracking(conclusion), reach: reach(prepared, stated, found)?, gains }))
}

fn tracking(conclusion: &Conclusion) -> Vec<Tracking> {
    let of = |(i, run): (usize, &Run)| {
        let place = run.measured.iter().position(|m| m.channel == Channel::Displacement)?;
        let error = |shown: &[f64]| rms(run.input.iter().zip(shown).map(|(reference, x)| reference - x));
        Some(Tracking {
            run: run.name.clone(),
            measured: error(&run.measured[place].values),
            stated: error(&conclusion.stated.hold.predicted[i].channels[place]),
            found: error(&conclusion.accepted.hold.predicted[i].channels[place]),
        })
    };
    let driven = |(_, run): &(usize, &Run)| run.law.simulates_reference();
    conclusion.judging.iter().enumerate().filter(driven).filter_map(of).collect()
}

/// The largest command that the found model needs for the runs fitted, held to either side.
fn reach(prepared: &Prepared, stated: &Fit, found: &Fit) -> Result<Option<Reach>, SimulateError> {
    let command = |(run, local): (&Run, &Local)| -> Result<f64, SimulateError> {
        let added = run.added.clone();
        let run = Run { added, ..watching(run, &[Channel::Command], run.input.clone(), run.law) };
        let seen = predict(&found.model, &run, local)?;
        Ok(seen.channels[0].iter().filter(|u| u.is_finite()).fold(0.0, |most: f64, u| most.max(u.abs())))
    };
    let each: Result<Vec<f64>, _> = prepared.fit.par_iter().zip(&found.locals).map(command).collect();
    let command = each?.into_iter().fold(0.0, f64::max);
    let Some(pattern) = prepared.fit.first().filter(|_| command > 0.0) else { return Ok(None) };
    let sides = |model: &Model| -> Result<[f64; 2], SimulateError> {
        let of = |u| speed(model, pattern, u, prepared.signal_scales.displacement);
        Ok([of(command)?, of(-command)?])
    };
    Ok(Some(Reach { command, stated: sides(&stated.model)?, found: sides(&found.model)? }))
}

/// Greatest speed under a held command, as long as the table is within `travel` of where it stood.
fn speed(model: &Model, pattern: &Run, command: f64, travel: f64) -> Result<f64, SimulateError> {
    let samples = (HELD / pattern.dt) as usize;
    let run =
        watching(pattern, &[Channel::Velocity, Channel::Displacement], vec![command; samples], SimulatedLaw::Recorded);
    let seen = predict(model, &run, &Local::start(model, &run))?;
    let within = seen.channels[0].iter().zip(&seen.channels[1]).take_while(|(_, x)| x.abs() <= travel);
    Ok(within.map(|(v, _)| v.abs()).filter(|v| v.is_finite()).fold(0.0, f64::max))
}

/// The largest factor on what the controller sends below which the loop settles throughout.
fn margin(model: &Model, pattern: &Run, travel: f64) -> Result<Option<f64>, SimulateError> {
    let (least, ratio, most) = FACTORS;
    let factors: Vec<f64> =
        std::iter::successors(Some(least), |f| Some(f * ratio)).take_while(|f| *f <= most).collect();
    let settles = |&factor: &f64| settles(model, pattern, factor, STEP.0 * travel);
    let each: Vec<bool> = factors.par_iter().map(settles).collect::<Result<_, _>>()?;
    let lost = each.iter().position(|settles| !settles);
    Ok(lost.map(|i| i.checked_sub(1).map_or(0.0, |before| factors[before])))
}

/// Whether the loop comes to rest after a step of the reference, a steady drift aside.
fn settles(model: &Model, pattern: &Run, factor: f64, step: f64) -> Result<bool, SimulateError> {
    let (_, at, duration) = STEP;
    let samples = (duration / pattern.dt) as usize;
    let middle = pattern.input.first().copied().unwrap_or(0.0);
    let reference = |k: usize| if k as f64 * pattern.dt < at { middle } else { middle + step };
    let input = (0..samples).map(reference).collect();
    let run = watching(pattern, &[Channel::Displacement], input, pattern.law.times(factor));
    let seen = predict(model, &run, &Local::start(model, &run))?;
    let last = &seen.channels[0][samples - samples / 4..];
    Ok(last.iter().all(|x| x.is_finite()) && rms(about_trend(last).into_iter()) < SETTLED * step)
}

/// A series less the straight line through it.
fn about_trend(series: &[f64]) -> Vec<f64> {
    let n = series.len() as f64;
    let at = |k: usize| k as f64 - 0.5 * (n - 1.0);
    let mean = series.iter().sum::<f64>() / n.max(1.0);
    let (along, of) = series.iter().enumerate().fold((0.0, 0.0), |(a, o), (k, x)| (a + at(k) * x, o + at(k).powi(2)));
    let slope = along / f64::max(of, f64::MIN_POSITIVE);
    series.iter().enumerate().map(|(k, x)| x - mean - slope * at(k)).collect()
}

/// A run like `pattern` but for what drives it, from rest, nothing filtered, that shows these channels.
fn watching(pattern: &Run, channels: &[Channel], input: Vec<f64>, law: SimulatedLaw) -> Run {
    let noise = pattern.channel(Channel::Displacement).map_or(0.0, |m| m.noise);
    let of = |&channel: &Channel| Measured { channel, values: Vec::new(), noise, stated: Some(noise), judged: true };
    let measured = channels.iter().map(of).collect();
    Run { measured, input, law, added: Vec::new(), moving_start: false, filter: None, ..pattern.clone() }
}

#[cfg(test)]
mod tests;
