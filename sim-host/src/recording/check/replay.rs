//! Does the stated controller, given the recorded reference and motion, produce the recorded command?

use super::missing::longest;
use super::ticks::Ticks;
use super::{Fault, Finding, Severity};
use crate::recording::channel::{Channel, PerChannel};
use crate::recording::law::{RecordedLaw, Shaping};
use crate::recording::run::Run;
use crate::recording::signal::{deviation, filled, quantile};
use nalgebra::{DMatrix, DVector};
use shakedown_core::{Controller, Sample, Settings};
use std::borrow::Cow;

/// The stated law reproduces the command where it misses less than this part of it.
const REPRODUCED: f64 = 0.15;

/// Other gains are believed where they miss less than this part.
const REFITTED: f64 = 0.1;

/// The recorded command beside the one the stated law gives.
#[derive(Debug, Clone)]
pub(super) struct Replay {
    /// Recorded minus replayed, the free offset taken off.
    pub(super) residual: Vec<f64>,
    /// RMS of the residual over RMS of the recorded command.
    pub(super) stated_error: f64,
    /// The same with both gains free.
    free_error: f64,
    /// Gains that fit best, in the order and sense of the law's own.
    gains: [f64; 2],
    /// The stated gains.
    stated: [f64; 2],
    /// Their names.
    names: [&'static str; 2],
}

impl Replay {
    /// Replays a run; none where it states no law or lacks a channel.
    pub(super) fn of(signals: &PerChannel<Cow<'_, [f64]>>, run: &Run) -> Option<Self> {
        // What surrounds a law is tested where the set-up is doubted.
        if run.shaping != Shaping::default() {
            return None;
        }
        let get = |channel| signals.get(channel).map(|s| filled(s));
        let ticks = Ticks::of(run);
        let (reference, displacement) = (get(Channel::Reference)?, get(Channel::Displacement)?);
        let mut command = get(Channel::Command)?;
        if let Some(known) = get(Channel::Disturbance) {
            command.iter_mut().zip(&known).for_each(|(u, d)| *u -= d);
        }
        let needed = [Channel::Reference, Channel::Displacement, Channel::Command].map(|c| signals.get(c));
        let stride = if let Ticks::Slower(count, _) = ticks { count } else { 1 };
        command.iter_mut().zip(known(needed, stride)).filter(|(_, known)| !known).for_each(|(u, _)| *u = f64::NAN);
        let error: Vec<f64> = reference.iter().zip(&displacement).map(|(r, x)| r - x).collect();
        // A cut run starts with an unknown integral; every run has an unknown null of the converter.
        match &run.law {
            RecordedLaw::Open => None,
            RecordedLaw::ProportionalIntegral { kp, ki } => {
                let terms = ticks.seen(&error, |error, dt| [error.to_vec(), integral(error, dt)]);
                Some(Self::linear(&command, &terms, [*kp, *ki], ["kp", "ki"]))
            }
            RecordedLaw::Cascade { kp, kv } => {
                let [error, _] = ticks.seen(&error, |error, _| [error.to_vec(), Vec::new()]);
                let [velocity, _] = ticks.seen(&displacement, |x, dt| [backward(x, dt), Vec::new()]);
                let terms = [error, velocity.iter().map(|v| -v).collect()];
                Some(Self::linear(&command, &terms, [kp * kv, *kv], ["kp kv", "kv"]))
            }
            RecordedLaw::Core { settings, .. } => {
                let replayed = core(settings, &reference, &displacement, signals)?;
                let terms = [replayed, vec![0.0; command.len()]];
                Some(Self::linear(&command, &terms, [1.0, 0.0], ["core", ""]))
            }
        }
    }

    /// By a law that is linear in `terms`; a command that is no number is not compared.
    fn linear(command: &[f64], terms: &[Vec<f64>; 2], stated: [f64; 2], names: [&'static str; 2]) -> Self {
        let size = deviation(command).max(f64::MIN_POSITIVE);
        let residual = |gains: [f64; 2]| -> Vec<f64> {
            let miss: Vec<f64> =
                (0..command.len()).map(|k| command[k] - gains[0] * terms[0][k] - gains[1] * terms[1][k]).collect();
            let offset = quantile(&miss, 0.5);
            miss.iter().map(|m| if m.is_finite() { m - offset } else { 0.0 }).collect()
        };
        let gains = least_squares(command, terms).unwrap_or(stated);
        let (stated_residual, free_residual) = (residual(stated), residual(gains));
        Self {
            stated_error: rms(&stated_residual) / size,
            free_error: rms(&free_residual) / size,
            residual: stated_residual,
            gains,
            stated,
            names,
        }
    }

    /// The stated law explains the command.
    pub(super) fn reproduces(&self) -> bool {
        self.stated_error < REPRODUCED
    }

    /// The same law with other gains of the same sign explains it.
    pub(super) fn reproduces_with_other_gains(&self) -> bool {
        self.free_error < REFITTED && self.gains[0] * self.stated[0] > 0.0
    }
}

/// Samples of which each of these channels was recorded, and those from which a law of one tick every `stride` samples made its output: the
/// tick's and the one before, whose difference it may take. A sample that is believed to be wrong is missing; the controller may have
/// been given it all the same.
fn known(channels: [Option<&Cow<'_, [f64]>>; 3], stride: usize) -> Vec<bool> {
    let there = |k: usize| channels.iter().flatten().all(|samples| samples.get(k).is_some_and(|x| x.is_finite()));
    let length = channels.iter().flatten().map(|samples| samples.len()).min().unwrap_or(0);
    let tick = |k: usize| k - k % stride;
    (0..length).map(|k| there(k) && there(tick(k)) && there(tick(k).saturating_sub(stride))).collect()
}

fn rms(samples: &[f64]) -> f64 {
    (samples.iter().map(|x| x * x).sum::<f64>() / samples.len().max(1) as f64).sqrt()
}

fn integral(error: &[f64], dt: f64) -> Vec<f64> {
    let mut sum = 0.0;
    error
        .iter()
        .map(|e| {
            sum += e * dt;
            sum
        })
        .collect()
}

fn backward(samples: &[f64], dt: f64) -> Vec<f64> {
    // What stood before the first sample of a part is not recorded: the slope there is the next one's.
    let first = samples.first().map_or(0.0, |first| 2.0 * first - samples.get(1).unwrap_or(first));
    std::iter::once(first)
        .chain(samples.iter().copied())
        .zip(samples)
        .map(|(before, &now)| (now - before) / dt)
        .collect()
}

fn core(
    settings: &Settings,
    reference: &[f64],
    displacement: &[f64],
    signals: &PerChannel<Cow<'_, [f64]>>,
) -> Option<Vec<f64>> {
    // The guard holds the law until it is armed; the recording was made with it armed.
    let mut controller = Controller::new(&Settings { guard: None, ..*settings }).ok()?;
    let acceleration = signals.get(Channel::Acceleration).map(|s| filled(s));
    let step = |k: usize| {
        let sample = Sample {
            reference: reference[k] as f32,
            displacement: displacement[k] as f32,
            acceleration: acceleration.as_ref().map_or(0.0, |a| a[k] as f32),
            ..Sample::default()
        };
        f64::from(controller.step(&sample).valve)
    };
    Some((0..reference.len()).map(step).collect())
}

/// Gains of two terms, a constant beside them, by the samples of the command that are numbers; none where a term is nothing or both are one.
fn least_squares(command: &[f64], terms: &[Vec<f64>; 2]) -> Option<[f64; 2]> {
    let sizes = [deviation(&terms[0]), deviation(&terms[1])];
    if sizes.iter().any(|s| *s <= 0.0) {
        return None;
    }
    let known: Vec<usize> = (0..command.len()).filter(|&k| command[k].is_finite()).collect();
    let column = |row: usize, j: usize| if j < 2 { terms[j][known[row]] / sizes[j] } else { 1.0 };
    let matrix = DMatrix::from_fn(known.len(), 3, column);
    let normal = matrix.tr_mul(&matrix);
    let right = matrix.tr_mul(&DVector::from_iterator(known.len(), known.iter().map(|&k| command[k])));
    let solved = normal.cholesky()?.solve(&right);
    Some([solved[0] / sizes[0], solved[1] / sizes[1]])
}

/// Gains of a law and what they miss, RMS over the command's RMS.
type Fitted = ([f64; 2], f64);

/// The plain laws fitted to a recorded command.
pub(crate) struct FittedGains {
    /// kp, ki.
    pub(crate) proportional_integral: Option<Fitted>,
    /// kp kv, kv.
    pub(crate) cascade: Option<Fitted>,
}

/// Fits both plain laws to a command, all in SI, samples `dt` apart.
pub(crate) fn fitted_gains(reference: &[f64], displacement: &[f64], command: &[f64], dt: f64) -> FittedGains {
    let error: Vec<f64> = reference.iter().zip(displacement).map(|(r, x)| r - x).collect();
    let fit = |terms: [Vec<f64>; 2]| {
        let gains = least_squares(command, &terms)?;
        Some((gains, Replay::linear(command, &terms, gains, ["", ""]).stated_error))
    };
    let velocity = backward(displacement, dt).iter().map(|v| -v).collect();
    FittedGains { proportional_integral: fit([error.clone(), integral(&error, dt)]), cascade: fit([error, velocity]) }
}

/// Reports a command that the stated controller did not send.
pub(super) fn check(run: &Run) -> Option<Finding> {
    let mut signals = PerChannel::default();
    for (channel, samples) in run.channels.iter() {
        signals.set(channel, Cow::Borrowed(samples.as_slice()));
    }
    let replay = Replay::of(&signals, run)?;
    let command = run.channel(Channel::Command)?;
    if replay.reproduces() {
        return None;
    }
    let percent = 100.0 * replay.stated_error;
    let missed = format!("{} misses the recorded command by {percent:.0} %", run.law.describe());
    let whole = |fault, severity| Finding::whole(run, Channel::Command, fault, severity);
    if replay.free_error < REFITTED {
        let [a, b] = replay.gains;
        let [first, second] = replay.names;
        let turned = if replay.gains[0] * replay.stated[0] < 0.0 { "; the sign is turned" } else { "" };
        return Some(whole(Fault::WrongController, Severity::BadData).saying(
            format!(
                "{missed}; {first} = {a:.4}, {second} = {b:.4} miss it by {:.1} %{turned}",
                100.0 * replay.free_error
            ),
            "correct `controller`, or leave it out so that the recorded command drives the model",
        ));
    }
    if limited(command, &replay) {
        return Some(whole(Fault::LimitedCommand, Severity::Remark).saying(
            format!("{missed}, but only where the command is at its largest or smallest value"),
            "the controller limits its output; state it as `{ core = ... }`, or leave `controller` out",
        ));
    }
    let far: Vec<bool> = replay.residual.iter().map(|r| r.abs() > 0.25 * deviation(command)).collect();
    let (from, length) = (far.iter().position(|f| *f).unwrap_or(0), longest(&far).1);
    let to = far.iter().rposition(|f| *f).unwrap_or(run.len());
    Some(whole(Fault::MissingInput, Severity::BadData).between(run, from, to).saying(
        format!(
            "{missed}, whatever its gains ({:.0} %): the command holds something else, {:.3} RMS, for up to {:.3} s at a time",
            100.0 * replay.free_error,
            rms(&replay.residual),
            length as f64 * run.dt
        ),
        "give the input that was added as channel `disturbance`, correct the law, or leave `controller` out",
    ))
}

/// True where the replay is right wherever the command is not at one of its extremes.
fn limited(command: &[f64], replay: &Replay) -> bool {
    let (low, high) = (quantile(command, 0.0), quantile(command, 1.0));
    let inside = |u: &f64| *u > low + 1e-9 * (high - low) && *u < high - 1e-9 * (high - low);
    let rest: Vec<f64> = replay.residual.iter().zip(command).filter(|(_, u)| inside(u)).map(|(r, _)| *r).collect();
    let at_limit = command.len() - rest.len();
    at_limit > 10 && rest.len() > command.len() / 5 && rms(&rest) < REPRODUCED * deviation(command)
}

#[cfg(test)]
mod tests {
    use super::backward;

    /// A part that begins in motion is not blamed for a jump that no sample shows.
    #[test]
    fn the_slope_before_a_part_is_that_within_it() {
        let slopes = backward(&[1.0, 1.2, 1.4, 1.4], 0.1);
        let wanted = [2.0, 2.0, 2.0, 0.0];
        assert!(slopes.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9), "{slopes:?}");
        assert!(backward(&[], 0.1).is_empty());
    }
}
