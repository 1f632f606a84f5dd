//! Another reading of what was stated of the set-up, put into the runs for a trial and into the experiment where it holds.

use crate::identify::data::{Channel, Run};
use crate::plant::simulate::SimulatedLaw;
use crate::recording::signal::shifted;
use crate::recording::{self, Doubt, Experiment, RecordedLaw, SetUpFinding};

/// What may have been stated wrong.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Reading {
    /// Values of the model that no fit may move.
    Values(Vec<&'static str>),
    /// The reference was recorded so many samples late, early where negative.
    LateReference(i32),
    /// A channel was.
    Late(Channel, i32),
    /// The gain of the controller that no value of the model takes up is so many times what was stated: the integral one of a PI law, the
    /// outer one of a cascade.
    Gain(f64),
}

impl Reading {
    /// Numbers that it takes from the data.
    pub(super) fn parameters(&self) -> usize {
        match self {
            Self::Values(names) => names.len(),
            Self::LateReference(_) | Self::Late(..) => 0,
            Self::Gain(_) => 1,
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
                Self::Gain(factor) => match &mut run.law {
                    SimulatedLaw::Pi { ki: gain, .. } | SimulatedLaw::Cascade { kp: gain, .. } => *gain *= factor,
                    SimulatedLaw::Recorded => {}
                },
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
                Self::Gain(factor) => match &mut run.law {
                    RecordedLaw::ProportionalIntegral { ki: gain, .. } | RecordedLaw::Cascade { kp: gain, .. } => {
                        *gain *= factor;
                    }
                    RecordedLaw::Open | RecordedLaw::Core { .. } => {}
                },
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
            Self::Gain(factor) => match run.law {
                RecordedLaw::ProportionalIntegral { ki, .. } => {
                    Some(SetUpFinding::gain(Doubt::ControllerKi, ki, factor * ki, "unit of u per m s"))
                }
                RecordedLaw::Cascade { kp, .. } => {
                    Some(SetUpFinding::gain(Doubt::ControllerKp, kp, factor * kp, "1/s"))
                }
                RecordedLaw::Open | RecordedLaw::Core { .. } => None,
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
    use crate::identify::fit::tests::{TRUTH, model, recorded};

    /// What a model's own gain takes up is left as it was stated: the proportional gain of a PI law, the inner one of a cascade.
    #[test]
    fn the_gain_that_no_value_takes_up_is_read_otherwise() {
        let read = |law| {
            let run = Run { law, ..recorded(&model(TRUTH), 1) };
            Reading::Gain(1.1).of(&[run])[0].law
        };
        let (pi, cascade) = (SimulatedLaw::Pi { kp: 2.0, ki: 3.0 }, SimulatedLaw::Cascade { kp: 2.0, kv: 3.0 });
        assert!(matches!(read(pi), SimulatedLaw::Pi { kp: 2.0, ki } if (ki - 3.3).abs() < 1e-12));
        assert!(matches!(read(cascade), SimulatedLaw::Cascade { kp, kv: 3.0 } if (kp - 2.2).abs() < 1e-12));
        assert_eq!(read(SimulatedLaw::Recorded), SimulatedLaw::Recorded);
    }

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
