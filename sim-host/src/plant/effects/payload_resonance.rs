//! A one-storey structure on the table, reacting on it, whose stiffness may change with its drift: joints that crack and
//! open soften, columns that go into tension stiffen, and its frequency moves with the size of the motion. A second storey adds a
//! second mode, which acts on the table as a one-storey structure of its own beside the first (A. K. Chopra, "Dynamics of
//! Structures", chapter 13, effective modal masses).

use super::bent_spring::bent;
use super::{Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "payload_resonance",
    equation: "f = mu (w_s^2 k(d) d + 2 zeta_s w_s d'), d = x - x_s, k = 1 + h d^2/(1 + |h| d^2); x_s'' = f/mu; a second mode of m_2 mu and r w_s beside it",
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
        Parameter {
            key: "second_mass",
            unit: "1",
            rigid_unit: "1",
            meaning: "mass of the second mode over that of the first, up to 0.001 none: m_2",
            signal_scale: SignalScale::One,
            low: NO_SECOND,
            high: 1.0,
            starts: &[NO_SECOND],
            positive: true,
            simple: Ends::Low,
            role: Role::Refined,
        },
        Parameter {
            key: "second_frequency",
            unit: "1",
            rigid_unit: "1",
            meaning: "frequency of the second mode over that of the first: r",
            signal_scale: SignalScale::One,
            low: 1.2,
            high: 10.0,
            // Two equal storeys have 2.62.
            starts: &[2.6],
            positive: true,
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
    /// Mass over that of the first mode and frequency over its.
    second: Option<(S, S)>,
}

/// Share of the first mode's mass up to which there is no second mode.
const NO_SECOND: f64 = 1e-3;

impl<S: Scalar> PayloadResonance<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[mass_ratio, hertz, damping, hardening, second_mass, ratio] = parameters else { return None };
        let second = (second_mass.value() > NO_SECOND).then_some((second_mass, ratio));
        Some(Self { mass_ratio, frequency: hertz * std::f64::consts::TAU, damping, hardening, second })
    }

    /// What a mode does to the table per its own mass, m/s2; the drift bends the spring of the first.
    fn mode(&self, at: &Instant<S>, &[place, speed]: &[S; 2], frequency: S, bends: bool) -> S {
        let drift = at.displacement - place;
        let straight = drift * frequency * frequency;
        let dashpot = (at.velocity - speed) * self.damping * frequency * 2.0;
        let spring = if bends { straight * bent(self.hardening, drift) } else { straight };
        spring + dashpot
    }
}

impl<S: Scalar> Effect<S> for PayloadResonance<S> {
    fn hooks(&self) -> Hooks {
        // A derivative by the hardening is not linear in the state even where the hardening is nothing.
        let linear = self.hardening.is_nothing();
        Hooks { force: true, linear, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        self.frequency.value() * self.second.map_or(1.0, |(_, ratio)| ratio.value())
    }
    fn states(&self) -> usize {
        if self.second.is_some() { 4 } else { 2 }
    }
    fn rest(&self, displacement: S, y: &mut [S]) {
        y.iter_mut().step_by(2).for_each(|place| *place = displacement);
    }
    fn force(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) -> S {
        let Some((first, further)) = y.split_first_chunk::<2>() else { return S::from(0.0) };
        let mut push = |i: usize, mode: &[S; 2], frequency: S| {
            let push = self.mode(at, mode, frequency, i == 0);
            if let Some([place_rate, speed_rate]) = dy.get_mut(2 * i..2 * i + 2) {
                (*place_rate, *speed_rate) = (mode[1], push);
            }
            push
        };
        let mut sum = push(0, first, self.frequency);
        if let (Some((mass, ratio)), Some(second)) = (self.second, further.first_chunk::<2>()) {
            sum += push(1, second, self.frequency * ratio) * mass;
        }
        sum * self.mass_ratio
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame of two equal storeys acts on the table as two structures: 0.947 and 0.053 of its mass at 0.618 and 1.618 times a storey's
    /// frequency.
    #[test]
    fn two_storeys_are_two_structures() {
        let at = Instant { time: 0.0, displacement: 1e-3, velocity: 0.02, sensed_velocity: 0.0, velocity_limit: 1.0 };
        let y = [2e-4, 0.01, 7e-4, -0.03];
        let force = |parameters: &[f64], y: &[f64]| {
            let payload = PayloadResonance::<f64>::new(parameters).unwrap();
            let mut dy = vec![0.0; payload.states()];
            (payload.force(&at, y, &mut dy), dy)
        };
        let ratio = 1.618 / 0.618;
        let (both, rates) = force(&[0.947, 3.0, 0.02, 0.0, 0.053 / 0.947, ratio], &y);
        let (first, first_rates) = force(&[0.947, 3.0, 0.02, 0.0, NO_SECOND, 2.6], &y[..2]);
        let (second, second_rates) = force(&[0.053, 3.0 * ratio, 0.02, 0.0, NO_SECOND, 2.6], &y[2..]);
        assert!((both - first - second).abs() < 1e-12 * both.abs());
        assert_eq!(rates[..2], first_rates[..]);
        assert!(rates[2..].iter().zip(&second_rates).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}
