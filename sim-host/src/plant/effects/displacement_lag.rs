//! The displacement sensor's filter lags.

use super::{Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "displacement_lag",
    equation: "tau y' = x - y, tau_2 z' = y - z",
    stage: Stage::Sensor,
    family: Family::Sensors,
    parameters: &[TIME_CONSTANT, SECOND],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "displacement trails the accelerometer; the loop loses phase",
    mistaken_for: &["command_delay", "valve_lag"],
    test: "accelerometer against LVDT phase at 20 Hz and up",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// The time constant of a sensor.
pub(super) const TIME_CONSTANT: Parameter = Parameter {
    key: "time",
    unit: "s",
    rigid_unit: "s",
    meaning: "time constant",
    signal_scale: SignalScale::One,
    low: 1e-4,
    high: 0.1,
    starts: &[0.001, 0.008, 0.03],
    positive: true,
    simple: Ends::Low,
    role: Role::Shared,
};

/// A second pole, as filters of measuring amplifiers have.
pub(super) const SECOND: Parameter = Parameter {
    key: "second",
    meaning: "time constant of a second pole",
    low: NONE,
    starts: &[NONE],
    role: Role::Refined,
    ..TIME_CONSTANT
};

/// A second pole that is none: one faster than what is resolved, s.
const NONE: f64 = 5e-5;

/// A lag in the displacement sensor.
#[derive(Debug, Clone)]
pub(crate) struct DisplacementLag<S> {
    time: S,
    second: Option<S>,
}

impl<S: Scalar> DisplacementLag<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[time, second] = parameters else { return None };
        Some(Self { time, second: Some(second).filter(|second| second.value() > TIME_CONSTANT.low) })
    }
}

impl<S: Scalar> Effect<S> for DisplacementLag<S> {
    fn hooks(&self) -> Hooks {
        Hooks { follow: true, displacement: true, linear: true, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        1.0 / self.second.unwrap_or(self.time).min(self.time).value().max(1e-4)
    }
    fn states(&self) -> usize {
        1 + usize::from(self.second.is_some())
    }
    fn rest(&self, displacement: S, y: &mut [S]) {
        y.fill(displacement);
    }
    fn follow(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) {
        let mut ahead = at.displacement;
        for ((shown, rate), time) in y.iter().zip(dy).zip([Some(self.time), self.second].into_iter().flatten()) {
            *rate = (ahead - *shown) / time;
            ahead = *shown;
        }
    }
    fn sense_displacement(&self, displacement: S, y: &[S]) -> S {
        y.last().copied().unwrap_or(displacement)
    }
}
