//! Runs as a fit sees them: the input that drives the simulation and the channels it is compared with.

use crate::motion::filter::Cascade;
use crate::plant::simulate::{MeasuredMotion, Shaping, SimulatedLaw};
use crate::recording;

/// A channel a simulation is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    /// Displacement sensor, m.
    Displacement,
    /// Accelerometer, m/s2.
    Acceleration,
    /// Velocity sensor, m/s.
    Velocity,
    /// The controller's command, in its unit.
    Command,
    /// Pressure difference across the piston, in its unit.
    PressureDifference,
    /// Supply pressure, as a ratio to its start.
    SupplyPressure,
}

impl Channel {
    /// The name used in files and results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Acceleration => "acceleration",
            Self::Velocity => "velocity",
            Self::Command => "command",
            Self::PressureDifference => "pressure_difference",
            Self::SupplyPressure => "supply_pressure",
        }
    }
}

impl Channel {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Displacement,
        Self::Acceleration,
        Self::Velocity,
        Self::Command,
        Self::PressureDifference,
        Self::SupplyPressure,
    ];

    /// The channel of a recording that it is compared with.
    pub fn recorded(self) -> recording::Channel {
        match self {
            Self::Displacement => recording::Channel::Displacement,
            Self::Acceleration => recording::Channel::Acceleration,
            Self::Velocity => recording::Channel::Velocity,
            Self::Command => recording::Channel::Command,
            Self::PressureDifference => recording::Channel::PressureDifference,
            Self::SupplyPressure => recording::Channel::SupplyPressure,
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Displacement => "m",
            Self::Acceleration => "m/s2",
            Self::Velocity => "m/s",
            Self::Command => "unit of u",
            Self::PressureDifference => "unit of p",
            Self::SupplyPressure => "1",
        }
    }
}

/// One measured channel of a run.
#[derive(Debug, Clone)]
pub struct Measured {
    /// Which channel.
    pub channel: Channel,
    /// One value a sample; NaN where a sample was dropped.
    pub values: Vec<f64>,
    /// Standard deviation of the noise, in the channel's unit.
    pub noise: f64,
    /// The same as it was stated; none where nobody did: it is then what the recording shows where it rests, or between neighbouring
    /// samples.
    pub stated: Option<f64>,
    /// Whether a fit is judged by it; the others are shown beside.
    pub judged: bool,
}

/// One run.
#[derive(Debug, Clone)]
pub struct Run {
    /// Name in results.
    pub name: String,
    /// Sampling period, s.
    pub dt: f64,
    /// Time of the first sample in its file, s.
    pub from: f64,
    /// Time from the start of that file to it, s: how long the table was at work before.
    pub elapsed: f64,
    /// Controller ticks a sample.
    pub ticks: usize,
    /// Reference displacement, m; the command where the law is [`SimulatedLaw::Recorded`].
    pub input: Vec<f64>,
    /// Declared additions to the command, one a sample; empty for none.
    pub added: Vec<f64>,
    /// Commands recorded before it, one a sample, in the command's unit; empty where none were.
    pub sent_before: Vec<f64>,
    /// The controller that ran.
    pub law: SimulatedLaw,
    /// What surrounds that controller.
    pub shaping: Shaping,
    /// Standard deviation of the displacement noise that the controller saw, m; that of the channel where it is none.
    pub loop_noise: Option<f64>,
    /// True where the run starts in the middle of a motion.
    pub moving_start: bool,
    /// What a simulation is compared with.
    pub measured: Vec<Measured>,
    /// The measured motion that drives a force balance.
    pub motion: Option<MeasuredMotion>,
    /// Both sides are low-passed, zero phase, before they are compared.
    pub filter: Option<Cascade>,
}

impl Run {
    /// Samples.
    pub fn len(&self) -> usize {
        self.input.len()
    }

    /// Its first samples.
    pub(crate) fn beginning(&self, samples: usize) -> Self {
        let first = |series: &[f64]| series[..samples.min(series.len())].to_vec();
        let measured = self.measured.iter().map(|m| Measured { values: first(&m.values), ..m.clone() }).collect();
        let motion = self.motion.as_ref().map(|m| MeasuredMotion {
            displacement: first(&m.displacement),
            velocity: first(&m.velocity),
            acceleration: first(&m.acceleration),
        });
        Self { input: first(&self.input), added: first(&self.added), measured, motion, ..self.clone() }
    }

    /// True without samples.
    pub fn is_empty(&self) -> bool {
        self.input.is_empty()
    }

    /// One channel, where the run has it.
    pub fn channel(&self, channel: Channel) -> Option<&Measured> {
        self.measured.iter().find(|m| m.channel == channel)
    }
}
