//! The table tilts as it travels, and gravity shows in the accelerometer.

use super::{Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::{GRAVITY, Kind};
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "tilt_coupling",
    equation: "a cos(k x) + g sin(k x)",
    stage: Stage::Sensor,
    family: Family::Sensors,
    parameters: &[Parameter {
        key: "angle_per_displacement",
        unit: "rad/m",
        rigid_unit: "rad/m",
        meaning: "tilt per displacement",
        signal_scale: SignalScale::One,
        low: -25.0,
        high: 25.0,
        starts: &[0.0],
        positive: false,
        simple: Ends::Neither,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "a copy of the displacement in the accelerometer",
    mistaken_for: &["acceleration_bias", "acceleration_gain"],
    test: "slow large motion: the accelerometer follows the displacement",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// Gravity through tilt.
#[derive(Debug, Clone)]
pub(crate) struct TiltCoupling<S> {
    angle: S,
}

impl<S: Scalar> TiltCoupling<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[angle] = parameters else { return None };
        Some(Self { angle })
    }
}

impl<S: Scalar> Effect<S> for TiltCoupling<S> {
    fn hooks(&self) -> Hooks {
        Hooks { acceleration: true, linear: true, ..Hooks::default() }
    }
    fn sense_acceleration(&self, acceleration: S, at: &Instant<S>) -> S {
        let tilt = self.angle * at.displacement;
        acceleration * tilt.cos() + tilt.sin() * GRAVITY
    }
}
