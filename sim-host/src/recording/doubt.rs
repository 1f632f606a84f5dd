//! Doubt of the set-up: what was said of controller, clock and sensors is tested against the recordings before any physics is.
//!
//! Everything here compares recorded channels with each other and with the stated controller; no model of the table takes
//! part. What two channels alone disagree about is a fault of the set-up, never physics: the recorded command, the reference
//! and the recorded displacement must be linked by the controller's law, and an accelerometer's slow drift has no counterpart
//! in a displacement that stays within its stroke. Each fault is reported with its stated and its found value, corrected in a
//! copy of the experiment, and the work goes on with the copy.

use super::channel::Channel;
use super::check::{Fault, Finding, Severity, check};
use super::experiment::Experiment;
use crate::digits;
use serde::Serialize;

mod acceleration;
mod clipped;
mod clock;
mod controller;
mod displacement;
mod gaps;
mod hum;
mod motion;
mod outliers;
mod replay;

/// What kind of fault of the set-up was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Doubt {
    /// Proportional gain of the controller.
    ControllerKp,
    /// Integral gain of the controller.
    ControllerKi,
    /// Velocity gain of a cascade.
    ControllerKv,
    /// Feed-forward of the reference's velocity.
    ControllerKvf,
    /// The controller acts later than stated.
    ControllerDelay,
    /// A channel is recorded a whole number of samples late or early.
    SampleShift,
    /// A sensor drifts slowly in the recording alone.
    Drift,
    /// A sensor's recorded zero is not the one that the controller saw.
    Offset,
    /// A sensor shows more or less than the motion that another shows.
    SensorGain,
    /// A channel went through a low-pass of first order.
    SensorLag,
    /// Single samples that no neighbour supports.
    Outliers,
    /// Peaks cut off at the end of a sensor's range.
    Clipped,
    /// A line of the mains in a channel.
    Hum,
    /// A saw-tooth in a channel.
    SawTooth,
    /// The time stamps scatter about an even grid.
    ClockJitter,
    /// The clock that stamped the rows runs at another rate.
    ClockRate,
    /// Rows are missing.
    LostRows,
    /// The noise of a channel is not as stated.
    Noise,
    /// The noise of a channel grows with the motion.
    NoiseGrowth,
    /// A value of the model is far from what was stated.
    ModelValue,
}

/// A fault of the stated set-up, with the value stated and the value found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SetUpFinding {
    /// What is wrong.
    pub what: Doubt,
    /// The run, where it concerns a run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run: Option<String>,
    /// The channel, where it concerns one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<&'static str>,
    /// The parameter, where it concerns one of the model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parameter: Option<String>,
    /// What was stated, in `unit`; none where nothing was.
    pub stated: Option<f64>,
    /// What was found, in `unit`.
    pub found: f64,
    /// Standard deviation of what was found, in `unit`; none where it has none.
    pub std: Option<f64>,
    /// Unit of the three.
    pub unit: String,
    /// True where the diagnosis goes on with the found value.
    pub corrected: bool,
}

impl SetUpFinding {
    fn new(what: Doubt, found: f64, unit: impl Into<String>) -> Self {
        let unit = unit.into();
        Self { what, run: None, channel: None, parameter: None, stated: None, found, std: None, unit, corrected: true }
    }

    fn of_run(self, run: &str) -> Self {
        Self { run: Some(run.to_owned()), ..self }
    }

    pub(crate) fn of_channel(self, channel: Channel) -> Self {
        Self { channel: Some(channel.name()), ..self }
    }

    /// Of a channel by its name; the diagnosis does not go on with what was found.
    fn only_said_of(self, channel: &'static str) -> Self {
        Self { channel: Some(channel), corrected: false, ..self }
    }

    fn against(self, stated: f64) -> Self {
        Self { stated: Some(stated), ..self }
    }

    fn within(self, std: f64) -> Self {
        Self { std: Some(std), ..self }
    }

    /// The noise of a channel, stated and found, in the channel's SI unit.
    pub fn noise(channel: &'static str, stated: f64, found: f64, std: f64, unit: &str) -> Self {
        let it = Self::new(Doubt::Noise, found, unit).against(stated).within(std);
        Self { channel: Some(channel), ..it }
    }

    /// Amplitude of a hum of the mains in a channel, in the channel's SI unit.
    pub fn hum(channel: &'static str, amplitude: f64, unit: &str) -> Self {
        Self::new(Doubt::Hum, amplitude, unit).against(0.0).only_said_of(channel)
    }

    /// Amplitude of a saw-tooth in a channel, in the channel's SI unit.
    pub fn saw_tooth(channel: &'static str, amplitude: f64, unit: &str) -> Self {
        Self::new(Doubt::SawTooth, amplitude, unit).against(0.0).only_said_of(channel)
    }

    /// Single samples of a channel that are wrong in a run.
    pub fn outliers(channel: &'static str, run: &str, count: usize) -> Self {
        Self::new(Doubt::Outliers, count as f64, "samples").against(0.0).of_run(run).only_said_of(channel)
    }

    /// Time constant of a channel's low-pass, s.
    pub fn sensor_lag(channel: &'static str, time: f64, std: f64) -> Self {
        Self::new(Doubt::SensorLag, time, "s").against(0.0).within(std).only_said_of(channel)
    }

    /// By what share the noise of a channel is larger in strong motion than in weak.
    pub fn noise_growth(channel: &'static str, share: f64, std: f64) -> Self {
        Self { channel: Some(channel), ..Self::new(Doubt::NoiseGrowth, share, "1").against(0.0).within(std) }
    }

    /// The sampling period, stated and found, s.
    pub fn clock_rate(stated: f64, found: f64, std: Option<f64>) -> Self {
        Self { std, ..Self::new(Doubt::ClockRate, found, "s").against(stated) }
    }

    /// A value of the model, stated and found.
    pub fn model_value(parameter: &str, stated: f64, found: f64, std: Option<f64>, unit: &str) -> Self {
        let it = Self::new(Doubt::ModelValue, found, unit).against(stated);
        Self { parameter: Some(parameter.to_owned()), std, ..it }
    }

    /// A channel that was recorded late by `found` (s), early where negative.
    pub(crate) fn of_shift(found: f64) -> Self {
        Self::new(Doubt::SampleShift, found, "s").against(0.0)
    }

    /// A gain of the controller, stated and found.
    pub(crate) fn gain(what: Doubt, stated: f64, found: f64, unit: &str) -> Self {
        Self::new(what, found, unit).against(stated)
    }

    /// In a sentence.
    pub fn sentence(&self) -> String {
        let unit = if self.unit == "1" { String::new() } else { format!(" {}", self.unit) };
        let stated = self.stated.map_or_else(String::new, |s| format!(", stated {}{unit}", digits::stated(s)));
        // A count is whole.
        let counted = self.std.is_none() && self.found.fract() == 0.0;
        let found = if counted { self.found.to_string() } else { digits::with_spread(self.found, self.std) };
        let place = match (&self.run, self.channel, &self.parameter) {
            (_, _, Some(parameter)) => format!(" ({parameter})"),
            (Some(run), Some(channel), None) => format!(" ({channel}, {run})"),
            (Some(run), None, None) => format!(" ({run})"),
            (None, Some(channel), None) => format!(" ({channel})"),
            (None, None, None) => String::new(),
        };
        let end = if self.corrected { "" } else { "; not corrected" };
        format!("{}{place}: {found}{unit}{stated}{end}", self.what.name())
    }
}

impl Doubt {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::ControllerKp => "proportional gain of the controller",
            Self::ControllerKi => "integral gain of the controller",
            Self::ControllerKv => "velocity gain of the controller",
            Self::ControllerKvf => "velocity feed-forward of the controller",
            Self::ControllerDelay => "delay of the controller",
            Self::SampleShift => "channel recorded late",
            Self::Drift => "slow drift of a sensor over the run",
            Self::Offset => "offset of a sensor",
            Self::SensorGain => "gain of a sensor against the displacement",
            Self::SensorLag => "time of a low-pass in a channel",
            Self::Outliers => "single samples wrong",
            Self::Clipped => "peaks cut off at the end of the range",
            Self::Hum => "amplitude of mains hum",
            Self::SawTooth => "amplitude of a saw-tooth in a sensor",
            Self::ClockJitter => "jitter of the time stamps",
            Self::ClockRate => "sampling period",
            Self::LostRows => "rows missing",
            Self::Noise => "noise of a channel",
            Self::NoiseGrowth => "noise that grows with the motion, by share",
            Self::ModelValue => "stated value of the model",
        }
    }
}

/// An experiment with its set-up corrected, and what was corrected.
#[derive(Debug, Clone)]
pub struct SetUp {
    /// The experiment with every correction applied.
    pub experiment: Experiment,
    /// What was found, in the order it was looked for.
    pub findings: Vec<SetUpFinding>,
}

/// Tests what was said of the set-up and corrects it.
///
/// All runs take part, those that only score too: a controller's gains and a converter's delay are no physics, and no choice
/// between models rests on what is found here.
pub fn doubt(experiment: &Experiment) -> SetUp {
    let mut experiment = experiment.clone();
    let mut findings = clock::doubt(&mut experiment);
    findings.extend(gaps::doubt(&mut experiment));
    findings.extend(clipped::doubt(&mut experiment));
    findings.extend(outliers::doubt(&mut experiment));
    findings.extend(controller::doubt(&mut experiment));
    findings.extend(displacement::doubt(&mut experiment));
    findings.extend(acceleration::doubt(&mut experiment));
    findings.extend(hum::doubt(&mut experiment));
    findings.extend(motion::doubt(&mut experiment));
    SetUp { experiment, findings }
}

/// The experiment without the samples that the end of a sensor's range cut off, and a remark on each such channel: the rest of the
/// recording serves. Where most is cut off, or the loop is closed over the sensor, nothing is left out.
pub(crate) fn without_clipped(experiment: &Experiment) -> (Experiment, Vec<Finding>) {
    let mut rest = experiment.clone();
    let left_out = clipped::doubt(&mut rest);
    if left_out.is_empty() {
        return (rest, Vec::new());
    }
    let among = |f: &Finding| left_out.iter().any(|l| l.run.as_ref() == Some(&f.run) && l.channel == Some(f.channel));
    let remarks = check(experiment).into_iter().filter(|f| f.fault == Fault::Clipped && among(f)).map(|f| Finding {
        severity: Severity::Remark,
        remedy: format!("these samples are left out; raise the range of {} before the next test", f.channel),
        ..f
    });
    let remarks = remarks.collect();
    (rest, remarks)
}

#[cfg(test)]
pub(crate) mod tests;
