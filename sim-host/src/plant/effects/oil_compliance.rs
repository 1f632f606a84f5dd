//! The oil column is a spring between piston flow and table mass.

use super::{Compliance, Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "oil_compliance",
    equation: "A p_L/m = p; p' = w_h^2 (q/A - v) - 2 zeta_h w_h p; v' = p - f",
    stage: Stage::Actuator,
    family: Family::OilColumn,
    parameters: &[
        Parameter {
            key: "frequency",
            unit: "Hz",
            rigid_unit: "Hz",
            meaning: "natural frequency of the table on the oil column",
            signal_scale: SignalScale::One,
            low: 3.0,
            high: 150.0,
            starts: &[8.0, 15.0, 28.0, 50.0, 90.0],
            positive: true,
            simple: Ends::High,
            role: Role::Shared,
        },
        Parameter {
            key: "damping",
            unit: "1",
            rigid_unit: "1",
            meaning: "damping ratio of that resonance",
            signal_scale: SignalScale::One,
            low: 0.005,
            high: 0.4,
            starts: &[0.2],
            positive: true,
            simple: Ends::Neither,
            role: Role::Shared,
        },
    ],
    kinds: &[Kind::Servo],
    frees: &[],
    signature: "a resonance between command and table, ringing after every sharp change",
    mistaken_for: &["payload_resonance", "base_compliance", "valve_lag", "command_delay"],
    test: "bare and loaded table, three stroke offsets; a floor accelerometer",
    order: Order::Fourth,
    contains: &[],
    counter: Some(|parameters, countered| {
        if let &[frequency, damping] = parameters {
            countered.oil = Some((frequency, damping));
        }
    }),
};

/// A compressible oil column.
#[derive(Debug, Clone)]
pub(crate) struct OilCompliance<S> {
    frequency: S,
    damping: S,
}

impl<S: Scalar> OilCompliance<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[hertz, damping] = parameters else { return None };
        Some(Self { frequency: hertz * std::f64::consts::TAU, damping })
    }
}

impl<S: Scalar> Effect<S> for OilCompliance<S> {
    fn hooks(&self) -> Hooks {
        Hooks { linear: true, ..Hooks::default() }
    }
    fn yields(&self, compliance: &mut Compliance<S>) {
        compliance.oil = Some((self.frequency * self.frequency, self.frequency * self.damping * 2.0));
    }
}
