//! The valve passes more flow in one direction than in the other: unequal piston areas, ports or amplifier stages.

use super::{Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "asymmetric_gain",
    equation: "u' = u (1 + d sgn(u))",
    stage: Stage::Valve,
    family: Family::Valve,
    parameters: &[Parameter {
        key: "difference",
        unit: "1",
        rigid_unit: "1",
        meaning: "half the difference between the gains of the two directions, over their mean: d",
        signal_scale: SignalScale::One,
        low: -0.6,
        high: 0.6,
        starts: &[0.0],
        positive: false,
        simple: Ends::Neither,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "one direction is faster at any amplitude; even harmonics that grow with the command",
    mistaken_for: &["null_bias", "asymmetric_limit"],
    test: "ramps both ways at several speeds",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// A gain for each direction.
#[derive(Debug, Clone)]
pub(crate) struct AsymmetricGain<S> {
    difference: S,
}

impl<S: Scalar> AsymmetricGain<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[difference] = parameters else { return None };
        Some(Self { difference })
    }
}

impl<S: Scalar> Effect<S> for AsymmetricGain<S> {
    fn hooks(&self) -> Hooks {
        Hooks { valve: true, ..Hooks::default() }
    }
    fn valve(&self, u: S, _y: &[S], _dy: &mut [S]) -> S {
        u + self.difference * u.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_direction_has_its_own_gain() {
        let gain = AsymmetricGain::new(&[0.1]).unwrap();
        assert!((gain.valve(2.0, &[], &mut []) - 2.2).abs() < 1e-12);
        assert!((gain.valve(-2.0, &[], &mut []) + 1.8).abs() < 1e-12);
    }
}
