//! A proposed test as a laboratory plays it.

use crate::identify::data::Run;
use crate::plant::simulate::SimulatedLaw;
use serde::Serialize;

/// A proposed test.
#[derive(Debug, Clone, Serialize)]
pub struct NextTest {
    /// What it would settle, with the predicted separation in noise units.
    pub why: String,
    /// What to run.
    pub record: String,
    /// Predicted distance of the two models on it, in standard deviations of the noise; none where it was not predicted.
    pub separation: Option<f64>,
    /// Predicted chance that it settles the question, whichever of the models is the table; none where it was not predicted.
    pub chance: Option<f64>,
    /// The test as it is played.
    #[serde(skip)]
    pub planned: Option<Planned>,
    /// The tests that come next, each with its predicted distance.
    pub others: Vec<(String, f64)>,
}

/// A proposed test: what the reference is at each sample, and the loop that runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Sampling interval, s.
    pub dt: f64,
    /// Reference displacement, m.
    pub reference: Vec<f64>,
    /// The loop's law with its gains in this test.
    pub law: SimulatedLaw,
    /// True where its outer gains are half of those of the runs at hand.
    pub halved: bool,
}

impl Planned {
    pub(super) fn of(run: &Run, halved: bool) -> Self {
        Self { dt: run.dt, reference: run.input.clone(), law: run.law, halved }
    }

    /// The controller as an experiment states it; none where nothing was closed.
    pub fn controller(&self) -> Option<String> {
        match self.law {
            SimulatedLaw::Pi { kp, ki } => Some(format!("{{ kp = {kp}, ki = {ki} }}")),
            SimulatedLaw::Cascade { kp, kv } => Some(format!("{{ kind = \"cascade\", kp = {kp}, kv = {kv} }}")),
            SimulatedLaw::Recorded => None,
        }
    }
}
