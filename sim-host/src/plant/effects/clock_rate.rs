//! The clock that stamped the rows runs at another rate than the controller's and the table's: a fault of the set-up, no physics.
//!
//! By the stamps everything moves faster or slower by one factor, and an acceleration is not what the displacement's second
//! difference says. It stands among a diagnosis's hypotheses so that it is weighed like any other, and is corrected where it wins.

use super::{Compliance, Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, SignalScale, Stage};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "clock_rate",
    equation: "dt (1 + r)",
    stage: Stage::Sensor,
    family: Family::Sensors,
    parameters: &[Parameter {
        key: "rate",
        unit: "1",
        rigid_unit: "1",
        meaning: "true over stated sampling period, less one",
        signal_scale: SignalScale::One,
        low: -0.012,
        high: 0.012,
        starts: &[0.0],
        positive: false,
        simple: Ends::Neither,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "everything a little fast or slow, acceleration twice as much",
    mistaken_for: &["acceleration_gain", "viscous_friction"],
    test: "a signal of known frequency in the recording",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// A clock at another rate.
#[derive(Debug, Clone)]
pub(crate) struct ClockRate<S> {
    rate: S,
}

impl<S: Scalar> ClockRate<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[rate] = parameters else { return None };
        Some(Self { rate })
    }
}

impl<S: Scalar> Effect<S> for ClockRate<S> {
    fn hooks(&self) -> Hooks {
        Hooks { linear: true, ..Hooks::default() }
    }
    fn yields(&self, compliance: &mut Compliance<S>) {
        compliance.pace = Some(self.rate + 1.0);
    }
}

/// The clock with its parameters; none for another identifier.
pub(super) fn build<S: Scalar>(id: &str, parameters: &[S]) -> Option<Box<dyn Effect<S>>> {
    if id == ENTRY.id { Some(Box::new(ClockRate::new(parameters)?)) } else { None }
}
