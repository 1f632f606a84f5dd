//! The oil beneath an effect that loads it: a spring so stiff that it shows only as a detail of that effect.

use super::{Compliance, Ends, Parameter, Role, SignalScale};
use crate::scalar::Scalar;

/// From here on the oil does not give at all, Hz.
const STIFF: f64 = 1000.0;

/// How stiff it is.
pub(super) const OIL: Parameter = Parameter {
    key: "oil_frequency",
    unit: "Hz",
    rigid_unit: "Hz",
    meaning: "natural frequency of the table on the oil beneath; from 1000 on the oil does not give",
    signal_scale: SignalScale::One,
    low: 80.0,
    high: STIFF,
    starts: &[STIFF],
    positive: true,
    simple: Ends::High,
    role: Role::Refined,
};

/// How the table is damped on it.
pub(super) const DAMPING: Parameter = Parameter {
    key: "oil_damping",
    unit: "1",
    rigid_unit: "1",
    meaning: "damping ratio of the table on the oil beneath",
    signal_scale: SignalScale::One,
    low: 0.005,
    high: 2.0,
    starts: &[0.2],
    positive: true,
    simple: Ends::Both,
    role: Role::Refined,
};

/// Lets the actuator yield by oil of this natural frequency, Hz, and damping ratio where it gives and nothing softer does.
pub(super) fn beneath<S: Scalar>(frequency: S, damping: S, compliance: &mut Compliance<S>) {
    let w = frequency * std::f64::consts::TAU;
    let softer = compliance.oil.is_some_and(|(stiffness, _)| stiffness.value() < w.value() * w.value());
    if frequency.value() < STIFF && !softer {
        compliance.oil = Some((w * w, w * damping * 2.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_softer_oil_counts_and_the_stiffest_does_not() {
        let mut compliance = Compliance::STIFF;
        beneath(STIFF, 0.2, &mut compliance);
        assert!(compliance.oil.is_none());
        for frequency in [200.0, 100.0, 300.0, STIFF] {
            beneath(frequency, 0.2, &mut compliance);
        }
        let (stiffness, damping) = compliance.oil.unwrap();
        let w = 100.0 * std::f64::consts::TAU;
        assert_eq!((stiffness, damping), (w * w, w * 0.4));
    }
}
