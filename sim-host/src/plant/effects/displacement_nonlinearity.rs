//! The displacement sensor is not linear over its stroke.

use super::{Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "displacement_nonlinearity",
    equation: "x + c3 d^3/(1 + s |c3| d^2), d = x - x0",
    stage: Stage::Sensor,
    family: Family::Sensors,
    parameters: &[
        Parameter {
            key: "cubic",
            unit: "1/m2",
            rigid_unit: "1/m2",
            meaning: "relative change of sensitivity per square of displacement: c3",
            signal_scale: SignalScale::Curvature,
            low: -0.3,
            high: 1.0,
            starts: &[0.0],
            positive: false,
            simple: Ends::Neither,
            role: Role::Shared,
        },
        Parameter {
            key: "centre",
            unit: "m",
            rigid_unit: "m",
            meaning: "where the coils are centred: x0",
            signal_scale: SignalScale::Displacement,
            low: -1.0,
            high: 1.0,
            starts: &[0.0, 0.3],
            positive: false,
            simple: Ends::Neither,
            role: Role::Refined,
        },
        Parameter {
            key: "saturation",
            unit: "1",
            rigid_unit: "1",
            meaning: "how soon the change of sensitivity comes to its end, up to 0.01 never: s",
            signal_scale: SignalScale::One,
            low: CUBIC,
            high: 4.0,
            starts: &[CUBIC],
            positive: true,
            simple: Ends::Low,
            role: Role::Refined,
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "third harmonics at large stroke; accelerometer and LVDT disagree there",
    mistaken_for: &["end_stop", "acceleration_gain"],
    test: "a second displacement sensor",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// Saturation at which the law is a cubic.
const CUBIC: f64 = 0.01;

/// A displacement sensor whose sensitivity changes away from its centre.
#[derive(Debug, Clone)]
pub(crate) struct DisplacementNonlinearity<S> {
    cubic: S,
    centre: S,
    saturation: S,
}

impl<S: Scalar> DisplacementNonlinearity<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[cubic, centre, saturation] = parameters else { return None };
        Some(Self { cubic, centre, saturation })
    }

    /// What the sensor shows more than there is (m) at this distance from its centre.
    fn more(&self, away: S) -> S {
        let bend = self.cubic * away * away;
        let end = if self.saturation.value() > CUBIC { self.saturation * bend.abs() + 1.0 } else { S::from(1.0) };
        bend * away / end
    }
}

impl<S: Scalar> Effect<S> for DisplacementNonlinearity<S> {
    fn hooks(&self) -> Hooks {
        Hooks { displacement: true, linear: true, ..Hooks::default() }
    }
    fn sense_displacement(&self, displacement: S, _y: &[S]) -> S {
        // Its zero is set with the table in the middle.
        displacement + self.more(displacement - self.centre) - self.more(S::from(0.0) - self.centre)
    }
}
