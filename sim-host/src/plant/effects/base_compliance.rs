//! The reaction mass moves on its springs: the accelerometer shows absolute motion, the LVDT motion relative to it. Its springs may
//! change with its travel: soil that slips and cracks softens, a gap that closes stiffens.

use super::bent_spring::bent;
use super::{Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "base_compliance",
    equation: "(1 + mu) x_b'' = -w_b^2 k(x_b) x_b - 2 zeta_b w_b x_b' - mu x'', k = 1 + h x_b^2/(1 + |h| x_b^2)",
    stage: Stage::Table,
    family: Family::Structure,
    parameters: &[
        Parameter {
            key: "frequency",
            unit: "Hz",
            rigid_unit: "Hz",
            meaning: "natural frequency of the base",
            signal_scale: SignalScale::One,
            low: 1.0,
            high: 60.0,
            starts: &[3.0, 6.0, 12.0, 20.0],
            positive: true,
            simple: Ends::Neither,
            role: Role::Shared,
        },
        Parameter {
            key: "damping",
            unit: "1",
            rigid_unit: "1",
            meaning: "damping ratio of the base",
            signal_scale: SignalScale::One,
            low: 1e-3,
            high: 1.0,
            starts: &[0.2],
            positive: true,
            simple: Ends::Neither,
            role: Role::Shared,
        },
        Parameter {
            key: "mass_ratio",
            unit: "1",
            rigid_unit: "1",
            meaning: "table mass over base mass; a base lighter than four fifths of its table is none",
            signal_scale: SignalScale::One,
            low: 1e-4,
            high: 1.25,
            starts: &[0.02],
            positive: true,
            simple: Ends::Low,
            role: Role::Shared,
        },
        Parameter {
            key: "hardening",
            unit: "1/m2",
            rigid_unit: "1/m2",
            meaning: "relative change of stiffness per square of the base's displacement: h",
            signal_scale: SignalScale::One,
            low: -1e10,
            high: 1e10,
            starts: &[0.0],
            positive: false,
            simple: Ends::Neither,
            role: Role::Refined,
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "a resonance in the accelerometer that the LVDT does not show",
    mistaken_for: &["payload_resonance", "oil_compliance"],
    test: "a floor accelerometer",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// A base on springs.
#[derive(Debug, Clone)]
pub(crate) struct BaseCompliance<S> {
    frequency: S,
    damping: S,
    mass_ratio: S,
    hardening: S,
}

impl<S: Scalar> BaseCompliance<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[hertz, damping, mass_ratio, hardening] = parameters else { return None };
        Some(Self { frequency: hertz * std::f64::consts::TAU, damping, mass_ratio, hardening })
    }

    /// The base's velocity from its momentum-like state: the table's velocity jumps with the command, and this form
    /// needs no derivative of it.
    fn base_velocity(&self, momentum: S, table: S) -> S {
        momentum - table * self.mass_ratio / (self.mass_ratio + 1.0)
    }
}

impl<S: Scalar> Effect<S> for BaseCompliance<S> {
    fn hooks(&self) -> Hooks {
        // A derivative by the hardening is not linear in the state even where the hardening is nothing.
        let linear = self.hardening.is_nothing();
        Hooks { follow: true, velocity: true, linear, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        self.frequency.value()
    }
    fn states(&self) -> usize {
        2
    }
    fn follow(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) {
        if let (&[place, momentum], [place_rate, momentum_rate]) = (y, dy) {
            // The table behind a joint with play moves the base, not the actuator before it.
            let speed = self.base_velocity(momentum, at.sensed_velocity);
            *place_rate = speed;
            let spring = place * bent(self.hardening, place) * self.frequency * self.frequency;
            *momentum_rate = -(spring + speed * self.damping * self.frequency * 2.0) / (self.mass_ratio + 1.0);
        }
    }
    fn sense_velocity(&self, velocity: S, y: &[S]) -> S {
        y.get(1).map_or(velocity, |&momentum| velocity + self.base_velocity(momentum, velocity))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What its travel takes of the stiffness or gives to it, up to none left and twice as much.
    #[test]
    fn springs_change_with_travel() {
        let pull = |hardening: f64, place: f64| {
            let base = BaseCompliance::<f64>::new(&[1.0, 0.0, 0.0, hardening]).unwrap();
            let at = Instant { time: 0.0, displacement: 0.0, velocity: 0.0, sensed_velocity: 0.0, velocity_limit: 1.0 };
            let mut rate = [0.0; 2];
            base.follow(&at, &[place, 0.0], &mut rate);
            -rate[1] / (std::f64::consts::TAU.powi(2) * place)
        };
        assert!((pull(0.0, 1e-3) - 1.0).abs() < 1e-12);
        assert!((pull(1e6, 1e-3) - 1.5).abs() < 1e-12 && (pull(-1e6, 1e-3) - 0.5).abs() < 1e-12);
        assert!((pull(1e10, 1e-3) - 2.0).abs() < 1e-3 && pull(-1e10, 1e-3).abs() < 1e-3);
    }
}
