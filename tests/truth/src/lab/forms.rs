//! The listed effects in the forms that the field has for them. Each form is a law of its own in a file below; the table says
//! which effect it is a form of, where its equation comes from, and what it asks of the experiment.

pub mod backlash;
pub mod column;
pub mod friction;
pub mod sensors;

use super::plant::Plant;
use crate::effect::Draw;

/// Sizes of the motion that strengths are scaled by, of the experiment without any flaw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Largest command (its unit).
    pub command: f64,
    /// Largest change of the command per second.
    pub command_rate: f64,
    /// Largest displacement from the origin in the run held out (m).
    pub stroke: f64,
    /// Velocity exceeded by one sample in a hundred (m/s).
    pub velocity: f64,
    /// Acceleration exceeded by one sample in a hundred (m/s2).
    pub acceleration: f64,
    /// Length of the shortest run (s).
    pub duration: f64,
    /// Crossover of the loop (rad/s).
    pub crossover: f64,
    /// Velocity limit (m/s); of a rigid mass its largest velocity.
    pub limit: f64,
    /// Pole of the baseline (1/s).
    pub pole: f64,
    /// Mass that forces are stated by: 1 for the servo model, kg for a rigid mass.
    pub mass: f64,
    /// Largest frequency of the references (Hz).
    pub top: f64,
}

/// How a form is set: its strength in (0, 1], what was drawn for it, and the motion's sizes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dial {
    /// Strength (1).
    pub s: f64,
    /// Drawn numbers.
    pub draw: Draw,
    /// Sizes.
    pub scales: Scales,
}

/// Parameters in the keys and units of the file formats.
pub type Parameters = Vec<(&'static str, f64)>;

/// What a form asks of the experiment.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Needs {
    /// Runs at the velocity limit.
    pub saturation: bool,
    /// An accelerometer.
    pub accelerometer: bool,
    /// A servo model: it has no meaning on a rigid mass.
    pub servo: bool,
    /// The stated model's damping may not be free: it would swallow the effect.
    pub damping_known: bool,
}

/// A form of a listed effect.
#[derive(Debug, Clone, Copy)]
pub struct Form {
    /// Identifier of the effect.
    pub effect: &'static str,
    /// Name of the form.
    pub name: &'static str,
    /// Where its equation comes from, or what real device it follows.
    pub source: &'static str,
    /// Puts it into a plant.
    pub build: fn(&mut Plant, &Dial) -> Parameters,
    /// What it asks for.
    pub needs: Needs,
}

/// No demands.
pub(crate) const ANY: Needs = Needs { saturation: false, accelerometer: false, servo: false, damping_known: false };
/// Seen by the accelerometer.
pub(crate) const ACCELEROMETER: Needs = Needs { accelerometer: true, ..ANY };
/// Of the servo model only.
pub(crate) const SERVO: Needs = Needs { servo: true, ..ANY };
/// Seen at the velocity limit.
pub(crate) const SATURATION: Needs = Needs { saturation: true, servo: true, ..ANY };

/// Every form of every listed effect.
pub fn all() -> Vec<Form> {
    [friction::FORMS, backlash::FORMS, sensors::FORMS].concat()
}

/// Identifiers of the listed effects that have a form, each once.
pub fn effects() -> Vec<&'static str> {
    let mut ids: Vec<_> = all().iter().map(|f| f.effect).collect();
    ids.dedup();
    ids.sort_unstable();
    ids.dedup();
    ids
}

/// The forms of an effect.
pub fn of(effect: &str) -> Vec<Form> {
    all().into_iter().filter(|form| form.effect == effect).collect()
}
