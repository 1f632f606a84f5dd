//! Oil leaks past the piston, in a narrow gap in proportion to load pressure, in a wide one with its root, past a seal that lifts with
//! more than its first power.

use super::{Compliance, Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "leakage",
    equation: "q/A - C a abs(a/a_1)^(n - 1), a = A p_L/m, a_1 = 1 m/s2",
    stage: Stage::Actuator,
    family: Family::OilColumn,
    parameters: &[COEFFICIENT, EXPONENT],
    kinds: &[Kind::Servo],
    frees: &[],
    signature: "velocity sags while force is needed; creep under a held load",
    mistaken_for: &["viscous_friction", "load_dependent_flow", "valve_lag", "command_delay"],
    test: "pressure at constant velocity; a loaded hold",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

const COEFFICIENT: Parameter = Parameter {
    key: "coefficient",
    unit: "s",
    rigid_unit: "s",
    meaning: "velocity lost per load acceleration a, at 1 m/s2: C",
    signal_scale: SignalScale::One,
    low: 1e-5,
    high: 0.2,
    starts: &[3e-4, 0.005],
    positive: true,
    simple: Ends::Low,
    role: Role::Shared,
};

const EXPONENT: Parameter = Parameter {
    key: "exponent",
    unit: "1",
    rigid_unit: "1",
    meaning: "power of the load with which the oil leaks, 1 in a narrow gap, 1/2 through an orifice: n",
    low: 0.5,
    high: 4.0,
    starts: &[1.0],
    simple: Ends::Both,
    role: Role::Refined,
    ..COEFFICIENT
};

/// Leakage past the piston.
#[derive(Debug, Clone)]
pub(crate) struct Leakage<S> {
    coefficient: S,
    exponent: Option<S>,
}

impl<S: Scalar> Leakage<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[coefficient, exponent] = parameters else { return None };
        let laminar = (exponent - 1.0).is_nothing();
        Some(Self { coefficient, exponent: (!laminar).then_some(exponent) })
    }
}

impl<S: Scalar> Effect<S> for Leakage<S> {
    fn hooks(&self) -> Hooks {
        Hooks { linear: self.exponent.is_none(), ..Hooks::default() }
    }
    fn yields(&self, compliance: &mut Compliance<S>) {
        compliance.leakage = Some(self.coefficient);
        compliance.leakage_exponent = self.exponent;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What leaks under the load that lets a velocity leak is that velocity, whatever the power; with the first it is in proportion.
    #[test]
    fn a_load_lets_leak_what_asks_for_it() {
        for exponent in [0.5, 1.0, 2.5] {
            let mut compliance = Compliance::STIFF;
            Leakage::<f64>::new(&[4e-3, exponent]).unwrap().yields(&mut compliance);
            for velocity in [1e-3, 0.02, -0.3] {
                let load = velocity / compliance.leaks_to(velocity);
                let leaks = compliance.leaks_under(load) * load;
                assert!((leaks - velocity).abs() < 1e-3 * velocity.abs(), "{exponent}: {leaks} for {velocity}");
            }
            let [one, four] = [1.0, 4.0].map(|load| compliance.leaks_under(load) * load);
            assert!((four / one - 4f64.powf(exponent)).abs() < 1e-4, "{exponent}: {}", four / one);
        }
    }
}
