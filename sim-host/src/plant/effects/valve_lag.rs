//! The spool follows its command as a second-order system, whose driving force may be limited: a torque motor or a pilot stage
//! gives less than in proportion where the spool is far from its command.

use super::{Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "valve_lag",
    equation: "s'' = w_v^2 e/(1 + k |e|) - 2 zeta w_v s', e = u - s",
    stage: Stage::Valve,
    family: Family::Valve,
    parameters: &[
        Parameter {
            key: "frequency",
            unit: "Hz",
            rigid_unit: "Hz",
            meaning: "natural frequency of the spool",
            signal_scale: SignalScale::One,
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
            signal_scale: SignalScale::One,
            low: 0.35,
            high: 2.0,
            starts: &[0.7],
            positive: true,
            simple: Ends::Neither,
            role: Role::Shared,
        },
        Parameter {
            key: "weakness",
            unit: "1 per unit of u",
            rigid_unit: "1/N",
            meaning: "one over the distance from which half the force is missing",
            signal_scale: SignalScale::One,
            low: 0.0,
            high: 1e4,
            starts: &[0.0],
            positive: false,
            simple: Ends::Low,
            role: Role::Refined,
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "phase lost and, above its frequency, amplitude too",
    mistaken_for: &["command_delay", "acceleration_lag", "displacement_lag"],
    test: "sines of 20 Hz and up at small amplitude and high gain",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// Second-order spool.
#[derive(Debug, Clone)]
pub(crate) struct ValveLag<S> {
    frequency: S,
    damping: S,
    weakness: S,
    /// Whether the force is in proportion, derivatives included.
    linear: bool,
}

impl<S: Scalar> ValveLag<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[hertz, damping, weakness] = parameters else { return None };
        let linear = weakness.is_nothing();
        Some(Self { frequency: hertz * std::f64::consts::TAU, damping, weakness, linear })
    }
}

impl<S: Scalar> Effect<S> for ValveLag<S> {
    fn hooks(&self) -> Hooks {
        Hooks { valve: true, linear: self.linear, ..Hooks::default() }
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
            let mut away = u - spool;
            if !self.linear {
                away = away / (away.abs() * self.weakness + 1.0);
            }
            *speed_rate = away * self.frequency * self.frequency - speed * self.damping * self.frequency * 2.0;
            spool
        } else {
            u
        }
    }
}
