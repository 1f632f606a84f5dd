//! An experiment before any flaw: machine, loop, references, rate and length, and the sizes of its motion.

mod draw;
pub mod test;

pub use draw::{Kind, Wish, rounded};

use super::forms::Scales;
use super::setup::Misstated;
use super::setup::sensing::Sensor;
use super::stated::Run;
use crate::plant::Machine;
use crate::refit::{Parameter, Sigma};

/// The experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Kind of machine.
    pub kind: Kind,
    /// True parameters.
    pub truth: Machine,
    /// Parameters as stated.
    pub stated: Machine,
    /// Parameters that the experiment lets be re-estimated.
    pub fit: Vec<Parameter>,
    /// Runs, as they truly ran; of several the last is held out.
    pub runs: Vec<Run>,
    /// Sensors, as they truly are.
    pub sensor: Sensor,
    /// Whole effective standard deviation of displacement and acceleration, with what the loop feeds back: the stated model's,
    /// until it is known what else is in the loop.
    pub sigma: Sigma,
    /// Sizes of its motion.
    pub scales: Scales,
    /// What the experiment states.
    pub says: Says,
    /// What of that is wrong.
    pub misstated: Vec<Misstated>,
}

/// What the experiment states of its set-up.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Says {
    /// Noise of displacement (m) and acceleration (m/s2); none where it states none.
    pub noise: (Option<f64>, Option<f64>),
    /// Factor on each controller gain as it is: kp, ki or kv, kvf.
    pub gains: [f64; 3],
    /// True sample interval over the one that the time column shows (1).
    pub clock: f64,
    /// Standard deviation of the time stamps (s), and number of places where rows are lost.
    pub stamps: (f64, usize),
    /// Whether lost rows are left out of the file, or are there as NaN.
    pub rows_left_out: bool,
    /// Channels of the files: displacement, acceleration, command.
    pub channels: [bool; 3],
    /// Pressure difference and supply pressure.
    pub pressures: (bool, bool),
    /// Millimetres and g instead of metres and m/s2.
    pub laboratory_units: bool,
}

impl Scene {
    /// Runs that are fitted: all but the last of several.
    pub fn fit_runs(&self) -> usize {
        self.runs.len().saturating_sub(1).max(1)
    }

    /// Rows of all runs.
    pub fn rows(&self) -> usize {
        self.runs.iter().map(|run| run.reference.len()).sum()
    }
}
