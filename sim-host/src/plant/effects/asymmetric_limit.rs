//! The two directions saturate at different speeds, for piston areas or valve lands differ.

use super::{Effect, Ends, Entry, Family, Flow, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// Exponent from which a corner is hard.
const HARD: f64 = 100.0;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "asymmetric_limit",
    equation: "clamp(w, -v_neg, v_pos), corners rounded as w / (1 + abs(w/v)^n)^(1/n)",
    stage: Stage::Flow,
    family: Family::Flow,
    parameters: &[
        Parameter {
            key: "positive",
            unit: "m/s",
            rigid_unit: "m/s",
            meaning: "velocity limit for positive motion",
            signal_scale: SignalScale::Speed,
            low: 0.2,
            high: 3.0,
            starts: &[0.9],
            positive: true,
            simple: Ends::High,
            role: Role::Shared,
        },
        Parameter {
            key: "negative",
            unit: "m/s",
            rigid_unit: "m/s",
            meaning: "velocity limit for negative motion",
            signal_scale: SignalScale::Speed,
            low: 0.2,
            high: 3.0,
            starts: &[0.9],
            positive: true,
            simple: Ends::High,
            role: Role::Shared,
        },
        Parameter {
            key: "sharpness",
            unit: "1",
            rigid_unit: "1",
            meaning: "exponent n of the corners; hard ones at the end of its range",
            signal_scale: SignalScale::One,
            low: 3.0,
            high: HARD,
            starts: &[HARD],
            positive: true,
            simple: Ends::High,
            role: Role::Refined,
        },
    ],
    kinds: &[Kind::Servo],
    frees: &[],
    signature: "one direction saturates earlier; even harmonics, drift under large motion",
    mistaken_for: &["null_bias", "flow_softening"],
    test: "ramps both ways; zero-command drift at two amplitudes",
    order: Order::Second,
    contains: &[],
    counter: Some(|parameters, countered| {
        if let &[positive, negative, sharpness] = parameters {
            countered.limits = Some((positive, negative));
            if sharpness < HARD {
                countered.sharpness = sharpness;
            }
        }
    }),
};

/// A velocity limit for each direction.
#[derive(Debug, Clone)]
pub(crate) struct AsymmetricLimit<S> {
    positive: S,
    negative: S,
    /// Exponent of rounded corners; none where they are hard.
    sharpness: Option<S>,
}

impl<S: Scalar> AsymmetricLimit<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[positive, negative, sharpness] = parameters else { return None };
        Some(Self { positive, negative, sharpness: Some(sharpness).filter(|n| n.value() < HARD) })
    }
}

impl<S: Scalar> Effect<S> for AsymmetricLimit<S> {
    fn hooks(&self) -> Hooks {
        Hooks { flow: true, linear: self.sharpness.is_none(), ..Hooks::default() }
    }
    fn flow(&self, _at: &Instant<S>, _y: &[S], flow: &mut Flow<S>) {
        flow.positive = self.positive;
        flow.negative = self.negative;
        flow.sharpness = flow.sharpness.or(self.sharpness);
    }
}

#[cfg(test)]
mod tests {
    use crate::plant::model::Baseline;
    use crate::plant::simulate::EffectParameters;
    use crate::plant::{Plant as _, stepped::Stepped};

    /// Alike in both directions and with rounded corners it is the softened limit.
    #[test]
    fn rounded_corners_are_those_of_the_softened_limit() {
        let paper = Baseline::Servo { b1: 0.69, b0: 138.0, a1: 57.65, velocity_limit: 0.242 };
        let made = |id: &'static str, parameters: &[f64]| {
            let placed = EffectParameters { id, parameters: parameters.to_vec() };
            let mut plant = Stepped::new(&paper, &[placed], 5e-4, 0.0).unwrap();
            let step = |k: i32| {
                plant.advance(0.15 * (f64::from(k) * 0.01).sin(), 1);
                plant.displacement()
            };
            (0..2000).map(step).collect::<Vec<f64>>()
        };
        let softened = made("flow_softening", &[6.0]);
        assert_eq!(made("asymmetric_limit", &[0.242, 0.242, 6.0]), softened);
        let hard = made("asymmetric_limit", &[0.242, 0.242, super::HARD]);
        assert!(hard.iter().zip(&softened).any(|(a, b)| (a - b).abs() > 1e-4), "the corner shows");
    }
}
