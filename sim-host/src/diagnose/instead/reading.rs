//! Another reading of what was stated of the set-up, put into the runs for a trial and into the experiment where it holds.

use crate::identify::data::{Channel, Run};
use crate::plant::simulate::SimulatedLaw;
use crate::recording::signal::shifted;
use crate::recording::{self, Doubt, Experiment, SetUpFinding};

/// What may have been stated wrong.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Reading {
    /// Values of the model that no fit may move.
    Values(Vec<&'static str>),
    /// The reference was recorded so many samples late, early where negative.
    LateReference(i32),
    /// A channel was.
    Late(Channel, i32),
    /// The integral gain of the controller is so many times what was stated.
    Integral(f64),
}

impl Reading {
    /// Numbers that it takes from the data.
    pub(super) fn parameters(&self) -> usize {
        match self {
            Self::Values(names) => names.len(),
            Self::LateReference(_) | Self::Late(..) => 0,
            Self::Integral(_) => 1,
        }
    }

    /// The runs by this reading.
    pub(super) fn of(&self, runs: &[Run]) -> Vec<Run> {
        let mut runs = runs.to_vec();
        for run in &mut runs {
            match self {
                Self::Values(_) => {}
                Self::LateReference(by) => run.input = shifted(&run.input, *by),
                Self::Late(channel, by) => {
                    for measured in run.measured.iter_mut().filter(|m| m.channel == *channel) {
                        measured.values = at_its_time(&measured.values, *by);
                    }
                    if *channel == Channel::Command {
                        run.shaping.late_command = run.shaping.late_command.saturating_sub(by.unsigned_abs() as usize);
                    }
                }
                Self::Integral(factor) => {
                    if let SimulatedLaw::Pi { ki, .. } = &mut run.law {
                        *ki *= factor;
                    }
                }
            }
        }
        runs
    }

    /// The experiment by this reading.
    pub(super) fn put_into(&self, experiment: &Experiment) -> Experiment {
        let mut experiment = experiment.clone();
        if let Self::Values(names) = self {
            experiment.model.fit.extend(names.iter().map(|name| (*name).to_owned()));
        }
        for run in &mut experiment.runs {
            match self {
                Self::Values(_) => {}
                Self::LateReference(by) => shift(run, recording::Channel::Reference, |series| shifted(series, *by)),
                Self::Late(channel, by) => shift(run, channel.recorded(), |series| at_its_time(series, *by)),
                Self::Integral(factor) => {
                    if let recording::RecordedLaw::ProportionalIntegral { ki, .. } = &mut run.law {
                        *ki *= factor;
                    }
                }
            }
        }
        experiment
    }

    /// What is said of it; of values of the model the fit has to say it.
    pub(super) fn finding(&self, experiment: &Experiment) -> Option<SetUpFinding> {
        let run = experiment.runs.first()?;
        let late = |channel, by: i32| Some(SetUpFinding::of_shift(f64::from(by) * run.dt).of_channel(channel));
        match self {
            Self::Values(_) => None,
            Self::LateReference(by) => late(recording::Channel::Reference, *by),
            Self::Late(channel, by) => late(channel.recorded(), *by),
            Self::Integral(factor) => match run.law {
                recording::RecordedLaw::ProportionalIntegral { ki, .. } => {
                    Some(SetUpFinding::gain(Doubt::ControllerKi, ki, factor * ki, "unit of u per m s"))
                }
                _ => None,
            },
        }
    }
}

/// A channel that was recorded `by` samples late, at its time; what was never recorded is no number.
fn at_its_time(series: &[f64], by: i32) -> Vec<f64> {
    let mut moved = shifted(series, by);
    let (length, beyond) = (moved.len(), (by.unsigned_abs() as usize).min(moved.len()));
    let unknown = if by > 0 { length - beyond..length } else { 0..beyond };
    moved.iter_mut().take(unknown.end).skip(unknown.start).for_each(|value| *value = f64::NAN);
    moved
}

fn shift(run: &mut recording::Run, channel: recording::Channel, to_its_time: impl Fn(&[f64]) -> Vec<f64>) {
    if let Some(moved) = run.channel(channel).map(to_its_time) {
        run.channels.set(channel, moved);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_recorded_late_is_at_its_time() {
        let series = [1.0, 2.0, 3.0, 4.0];
        assert_eq!(shifted(&series, 1), [2.0, 3.0, 4.0, 4.0]);
        assert_eq!(shifted(&series, -2), [1.0, 1.0, 1.0, 2.0]);
        let open = at_its_time(&series, 2);
        assert_eq!(open[..2], [3.0, 4.0]);
        assert!(open[2..].iter().all(|v| v.is_nan()));
        let early = at_its_time(&series, -1);
        assert!(early[0].is_nan() && early[1..] == [1.0, 2.0, 3.0]);
        assert!(shifted(&[], 1).is_empty() && at_its_time(&[], 1).is_empty());
    }
}
