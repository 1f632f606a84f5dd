//! A cushion near the end of the stroke.

use super::{Effect, Ends, Entry, Hooks, Instant, Order, Parameter, Role, Stage, Yardstick};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub const ENTRY: Entry = Entry {
    id: "end_stop",
    equation: "f = k max(abs(x) - x_c, 0) sgn(x)",
    stage: Stage::Table,
    parameters: &[
        Parameter {
            key: "position",
            unit: "m",
            rigid_unit: "m",
            meaning: "displacement where the cushion begins",
            yardstick: Yardstick::Displacement,
            low: 0.33,
            high: 2.0,
            starts: &[0.985, 0.92, 0.75, 0.5],
            positive: true,
            simple: Ends::High,
            role: Role::Shared,
        },
        Parameter {
            key: "stiffness",
            unit: "1/s2",
            rigid_unit: "1/s2",
            meaning: "cushion stiffness per table mass",
            yardstick: Yardstick::One,
            low: 1.0,
            high: 1e5,
            starts: &[30.0, 1000.0],
            positive: true,
            simple: Ends::Both,
            role: Role::Shared,
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "a force beyond one displacement, on both sides",
    mistaken_for: &["displacement_nonlinearity"],
    test: "slow sweeps of growing amplitude",
    order: Order::Second,
    counter: None,
};

/// A cushion near the end of the stroke.
#[derive(Debug, Clone)]
pub struct EndStop<S> {
    position: S,
    stiffness: S,
}

impl<S: Scalar> EndStop<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub fn new(parameters: &[S]) -> Option<Self> {
        let &[position, stiffness] = parameters else { return None };
        Some(Self { position, stiffness })
    }
}

impl<S: Scalar> Effect<S> for EndStop<S> {
    fn hooks(&self) -> Hooks {
        Hooks { force: true, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        self.stiffness.value().abs().sqrt()
    }
    fn force(&self, at: &Instant<S>, _y: &[S], _dy: &mut [S]) -> S {
        (at.displacement - at.displacement.clamp(-self.position, self.position)) * self.stiffness
    }
}
