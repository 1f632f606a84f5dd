//! The displacement sensor's filter lags.

use super::{Effect, Ends, Entry, Hooks, Instant, Order, Parameter, Role, Stage, Yardstick};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub const ENTRY: Entry = Entry {
    id: "displacement_lag",
    equation: "tau y' = x - y",
    stage: Stage::Sensor,
    parameters: &[TIME_CONSTANT],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "displacement trails the accelerometer; the loop loses phase",
    mistaken_for: &["command_delay", "valve_lag"],
    test: "accelerometer against LVDT phase at 20 Hz and up",
    order: Order::Fourth,
    counter: None,
};

/// The time constant of a sensor.
pub(super) const TIME_CONSTANT: Parameter = Parameter {
    key: "time",
    unit: "s",
    rigid_unit: "s",
    meaning: "time constant",
    yardstick: Yardstick::One,
    low: 1e-4,
    high: 0.1,
    starts: &[0.001, 0.008],
    positive: true,
    simple: Ends::Low,
    role: Role::Shared,
};

/// A lag in the displacement sensor.
#[derive(Debug, Clone)]
pub struct DisplacementLag<S> {
    time: S,
}

impl<S: Scalar> DisplacementLag<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub fn new(parameters: &[S]) -> Option<Self> {
        let &[time] = parameters else { return None };
        Some(Self { time })
    }
}

impl<S: Scalar> Effect<S> for DisplacementLag<S> {
    fn hooks(&self) -> Hooks {
        Hooks { follow: true, displacement: true, linear: true, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        1.0 / self.time.value().max(1e-4)
    }
    fn states(&self) -> usize {
        1
    }
    fn rest(&self, displacement: S, y: &mut [S]) {
        y.fill(displacement);
    }
    fn follow(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) {
        if let (&[shown], [rate]) = (y, dy) {
            *rate = (at.displacement - shown) / self.time;
        }
    }
    fn sense_displacement(&self, displacement: S, y: &[S]) -> S {
        y.first().copied().unwrap_or(displacement)
    }
}
