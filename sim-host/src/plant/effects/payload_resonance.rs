//! A one-storey structure on the table, reacting on it, whose stiffness may change with its drift: joints that crack and
//! open soften, columns that go into tension stiffen, and its frequency moves with the size of the motion.

use super::{Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "payload_resonance",
    equation: "f = mu (w_s^2 k(d) d + 2 zeta_s w_s d'), d = x - x_s, k = 1 + h d^2/(1 + |h| d^2); x_s'' = f/mu",
    stage: Stage::Payload,
    family: Family::Structure,
    parameters: &[
        Parameter {
            key: "mass_ratio",
            unit: "1",
            rigid_unit: "1",
            meaning: "payload mass over table mass",
            signal_scale: SignalScale::One,
            low: 1e-3,
            high: 5.0,
            starts: &[0.15],
            positive: true,
            simple: Ends::Low,
            role: Role::Shared,
        },
        Parameter {
            key: "frequency",
            unit: "Hz",
            rigid_unit: "Hz",
            meaning: "natural frequency of the payload on a still table",
            signal_scale: SignalScale::One,
            low: 0.3,
            high: 40.0,
            starts: &[0.8, 1.5, 2.5, 4.0, 6.0, 7.8, 10.0, 14.0],
            positive: true,
            simple: Ends::Neither,
            role: Role::Shared,
        },
        Parameter {
            key: "damping",
            unit: "1",
            rigid_unit: "1",
            meaning: "damping ratio of the payload",
            signal_scale: SignalScale::One,
            low: 1e-3,
            high: 0.7,
            starts: &[0.3],
            positive: true,
            simple: Ends::Neither,
            role: Role::Shared,
        },
        Parameter {
            key: "hardening",
            unit: "1/m2",
            rigid_unit: "1/m2",
            meaning: "relative change of stiffness per square of drift: h",
            signal_scale: SignalScale::One,
            low: -1e6,
            high: 1e6,
            starts: &[0.0],
            positive: false,
            simple: Ends::Neither,
            role: Role::Refined,
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass, Kind::ForceBalance],
    frees: &[],
    signature: "a notch and a peak in the response, ringing after the motion ends",
    mistaken_for: &["oil_compliance", "base_compliance"],
    test: "bare and loaded table; an accelerometer on the payload",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// A one-storey structure.
#[derive(Debug, Clone)]
pub(crate) struct PayloadResonance<S> {
    mass_ratio: S,
    frequency: S,
    damping: S,
    hardening: S,
}

impl<S: Scalar> PayloadResonance<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[mass_ratio, hertz, damping, hardening] = parameters else { return None };
        Some(Self { mass_ratio, frequency: hertz * std::f64::consts::TAU, damping, hardening })
    }
}

impl<S: Scalar> Effect<S> for PayloadResonance<S> {
    fn hooks(&self) -> Hooks {
        // A derivative by the hardening is not linear in the state even where the hardening is nothing.
        let linear = (0..S::PARTS).all(|i| self.hardening.part(i) == 0.0);
        Hooks { force: true, linear, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        self.frequency.value()
    }
    fn states(&self) -> usize {
        2
    }
    fn rest(&self, displacement: S, y: &mut [S]) {
        if let Some(first) = y.first_mut() {
            *first = displacement;
        }
    }
    fn force(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) -> S {
        let (&[place, speed], [place_rate, speed_rate]) = (y, dy) else { return S::from(0.0) };
        let drift = at.displacement - place;
        let bent = self.hardening * drift * drift;
        let spring = drift * (bent / (bent.abs() + 1.0) + 1.0) * self.frequency * self.frequency;
        let dashpot = (at.velocity - speed) * self.damping * self.frequency * 2.0;
        *place_rate = speed;
        *speed_rate = spring + dashpot;
        (spring + dashpot) * self.mass_ratio
    }
}
