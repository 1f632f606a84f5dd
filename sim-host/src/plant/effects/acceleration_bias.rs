//! The accelerometer's zero is off.

use super::{Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "acceleration_bias",
    equation: "a + b",
    stage: Stage::Sensor,
    family: Family::Sensors,
    parameters: &[Parameter {
        key: "offset",
        unit: "m/s2",
        rigid_unit: "m/s2",
        meaning: "constant added to the acceleration",
        signal_scale: SignalScale::One,
        low: -20.0,
        high: 20.0,
        starts: &[0.0],
        positive: false,
        simple: Ends::Neither,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "a constant in the accelerometer",
    mistaken_for: &["tilt_coupling"],
    test: "the table at rest",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// An accelerometer's zero offset.
#[derive(Debug, Clone)]
pub(crate) struct AccelerationBias<S> {
    offset: S,
}

impl<S: Scalar> AccelerationBias<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[offset] = parameters else { return None };
        Some(Self { offset })
    }
}

impl<S: Scalar> Effect<S> for AccelerationBias<S> {
    fn hooks(&self) -> Hooks {
        Hooks { acceleration: true, linear: true, ..Hooks::default() }
    }
    fn sense_acceleration(&self, acceleration: S, _at: &Instant<S>) -> S {
        acceleration + self.offset
    }
}
