//! Models of the table, and the effects a model may be missing.
//!
//! [`paper`] is the paper's plant, exact; `model` names the model a user believes in, `effects` holds the library of
//! physics it may lack, one file an effect, and `simulate` runs any combination of them against a recorded
//! reference, on any `Scalar`, so that every parameter has its exact sensitivity.

pub(crate) mod effects;
pub(crate) mod model;
pub(crate) mod oil_column;
pub mod paper;
pub mod sensors;
pub(crate) mod simulate;
pub(crate) mod slew_rate;
pub(crate) mod stepped;

/// A table that moves under a command held between steps. The plant owns the clock of every simulation.
pub trait Plant {
    /// Length of one step, s.
    fn step_length(&self) -> f64;
    /// Moves on by `steps` steps with `command` held (m for a servo axis, N for a rigid mass).
    fn advance(&mut self, command: f64, steps: usize);
    /// Displacement of the table from centre, m.
    fn displacement(&self) -> f64;
    /// Velocity of the table with `command` acting, m/s: where the command feeds straight through, the velocity jumps
    /// with it.
    fn velocity(&self, command: f64) -> f64;
    /// Load pressure times piston area over table mass, m/s2, where the plant has one: what a pressure-difference sensor
    /// shows, in the unit of the acceleration it makes.
    fn load(&self, _command: f64) -> Option<f64> {
        None
    }
    /// Whether the velocity is at its limit with `command` acting.
    fn saturated(&self, _command: f64) -> bool {
        false
    }
}
