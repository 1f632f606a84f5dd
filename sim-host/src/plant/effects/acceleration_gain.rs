//! The accelerometer's sensitivity is not what is declared.

use super::{Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "acceleration_gain",
    equation: "g a",
    stage: Stage::Sensor,
    family: Family::Sensors,
    parameters: &[Parameter {
        key: "gain",
        unit: "1",
        rigid_unit: "1",
        meaning: "shown over true acceleration",
        signal_scale: SignalScale::One,
        low: 0.2,
        high: 5.0,
        starts: &[1.0],
        positive: false,
        simple: Ends::Neither,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "acceleration out of proportion to the second difference of displacement",
    mistaken_for: &["displacement_nonlinearity", "acceleration_lag"],
    test: "turn the accelerometer over in the field of gravity",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// A wrong accelerometer sensitivity.
#[derive(Debug, Clone)]
pub(crate) struct AccelerationGain<S> {
    gain: S,
}

impl<S: Scalar> AccelerationGain<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[gain] = parameters else { return None };
        Some(Self { gain })
    }
}

impl<S: Scalar> Effect<S> for AccelerationGain<S> {
    fn hooks(&self) -> Hooks {
        Hooks { acceleration: true, linear: true, ..Hooks::default() }
    }
    fn sense_acceleration(&self, acceleration: S, _at: &Instant<S>) -> S {
        acceleration * self.gain
    }
}
