//! The spool follows its command as a second-order system.

use super::{Effect, Ends, Entry, Hooks, Order, Parameter, Role, Stage, Yardstick};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub const ENTRY: Entry = Entry {
    id: "valve_lag",
    equation: "s'' = w_v^2 (u - s) - 2 zeta w_v s'",
    stage: Stage::Valve,
    parameters: &[
        Parameter {
            key: "frequency",
            unit: "Hz",
            rigid_unit: "Hz",
            meaning: "natural frequency of the spool",
            yardstick: Yardstick::One,
            low: 2.0,
            high: 300.0,
            starts: &[12.0, 35.0, 90.0],
            positive: true,
            simple: Ends::High,
            role: Role::Shared,
        },
        Parameter {
            key: "damping",
            unit: "1",
            rigid_unit: "1",
            meaning: "damping ratio of the spool",
            yardstick: Yardstick::One,
            low: 0.35,
            high: 2.0,
            starts: &[0.7],
            positive: true,
            simple: Ends::Neither,
            role: Role::Shared,
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "phase lost and, above its frequency, amplitude too",
    mistaken_for: &["command_delay", "acceleration_lag", "displacement_lag"],
    test: "sines of 20 Hz and up at small amplitude and high gain",
    order: Order::Fourth,
    counter: None,
};

/// Second-order spool.
#[derive(Debug, Clone)]
pub struct ValveLag<S> {
    frequency: S,
    damping: S,
}

impl<S: Scalar> ValveLag<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub fn new(parameters: &[S]) -> Option<Self> {
        let &[hertz, damping] = parameters else { return None };
        Some(Self { frequency: hertz * std::f64::consts::TAU, damping })
    }
}

impl<S: Scalar> Effect<S> for ValveLag<S> {
    fn hooks(&self) -> Hooks {
        Hooks { valve: true, linear: true, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        self.frequency.value() * self.damping.value().max(1.0) * 2.0
    }
    fn states(&self) -> usize {
        2
    }
    fn valve(&self, u: S, y: &[S], dy: &mut [S]) -> S {
        if let (&[spool, speed], [spool_rate, speed_rate]) = (y, dy) {
            *spool_rate = speed;
            *speed_rate = (u - spool) * self.frequency * self.frequency - speed * self.damping * self.frequency * 2.0;
            spool
        } else {
            u
        }
    }
}
