//! The displacement sensor is not linear over its stroke.

use super::{Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "displacement_nonlinearity",
    equation: "x (1 + c3 x^2)",
    stage: Stage::Sensor,
    family: Family::Sensors,
    parameters: &[Parameter {
        key: "cubic",
        unit: "1/m2",
        rigid_unit: "1/m2",
        meaning: "relative change of sensitivity per square of displacement",
        signal_scale: SignalScale::Curvature,
        low: -0.3,
        high: 1.0,
        starts: &[0.0],
        positive: false,
        simple: Ends::Neither,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "third harmonics at large stroke; accelerometer and LVDT disagree there",
    mistaken_for: &["end_stop", "acceleration_gain"],
    test: "a second displacement sensor",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// A cubic displacement sensor.
#[derive(Debug, Clone)]
pub(crate) struct DisplacementNonlinearity<S> {
    cubic: S,
}

impl<S: Scalar> DisplacementNonlinearity<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[cubic] = parameters else { return None };
        Some(Self { cubic })
    }
}

impl<S: Scalar> Effect<S> for DisplacementNonlinearity<S> {
    fn hooks(&self) -> Hooks {
        Hooks { displacement: true, linear: true, ..Hooks::default() }
    }
    fn sense_displacement(&self, displacement: S, _y: &[S]) -> S {
        displacement * (self.cubic * displacement * displacement + 1.0)
    }
}
