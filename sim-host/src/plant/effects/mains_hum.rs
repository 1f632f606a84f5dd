//! The mains couple into the accelerometer's line, at their frequency or its alias.
//!
//! The phase differs from run to run: two amplitudes are fitted for each run, and the size over all runs is reported.

use super::{Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "mains_hum",
    equation: "a + A sin(2 pi f t + phase)",
    stage: Stage::Sensor,
    family: Family::Sensors,
    parameters: &[
        Parameter {
            key: "frequency",
            unit: "Hz",
            rigid_unit: "Hz",
            meaning: "frequency as sampled",
            signal_scale: SignalScale::Line,
            low: 0.98,
            high: 1.02,
            starts: &[1.0],
            positive: true,
            simple: Ends::Both,
            role: Role::Shared,
        },
        Parameter {
            key: "amplitude",
            unit: "m/s2",
            rigid_unit: "m/s2",
            meaning: "amplitude",
            signal_scale: SignalScale::One,
            low: 0.0,
            high: 50.0,
            starts: &[0.0],
            positive: false,
            simple: Ends::Both,
            role: Role::Size,
        },
        Parameter {
            key: "in_phase",
            unit: "m/s2",
            rigid_unit: "m/s2",
            meaning: "sine amplitude in one run",
            signal_scale: SignalScale::One,
            low: -50.0,
            high: 50.0,
            starts: &[0.0],
            positive: false,
            simple: Ends::Neither,
            role: Role::PerRun,
        },
        Parameter {
            key: "quadrature",
            unit: "m/s2",
            rigid_unit: "m/s2",
            meaning: "cosine amplitude in one run",
            signal_scale: SignalScale::One,
            low: -50.0,
            high: 50.0,
            starts: &[0.0],
            positive: false,
            simple: Ends::Neither,
            role: Role::PerRun,
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "one line in the spectrum, whether the table moves or not",
    mistaken_for: &["acceleration_bias"],
    test: "the table at rest with the power on",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// Mains in the accelerometer's line.
#[derive(Debug, Clone)]
pub(crate) struct MainsHum<S> {
    frequency: S,
    in_phase: S,
    quadrature: S,
}

impl<S: Scalar> MainsHum<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[hertz, amplitude, in_phase, quadrature] = parameters else { return None };
        Some(Self { frequency: hertz * std::f64::consts::TAU, in_phase: in_phase + amplitude, quadrature })
    }
}

impl<S: Scalar> Effect<S> for MainsHum<S> {
    fn hooks(&self) -> Hooks {
        Hooks { acceleration: true, linear: true, ..Hooks::default() }
    }
    fn sense_acceleration(&self, acceleration: S, at: &Instant<S>) -> S {
        let angle = self.frequency * at.time;
        acceleration + self.in_phase * angle.sin() + self.quadrature * angle.cos()
    }
}
