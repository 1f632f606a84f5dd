//! The valve passes more flow in one direction than in the other: unequal piston areas, ports or amplifier stages.
//!
//! An amplifier's stage has a pole of its own, faster than any spool.

use super::{Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "asymmetric_gain",
    equation: "u' = w (1 + d sgn(w)), T dw/dt = u - w",
    stage: Stage::Valve,
    family: Family::Valve,
    parameters: &[
        Parameter {
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
        },
        Parameter {
            key: "lag",
            unit: "s",
            rigid_unit: "s",
            meaning: "time constant of the amplifier's stages: T",
            signal_scale: SignalScale::One,
            low: NONE,
            high: 2e-3,
            starts: &[NONE],
            positive: true,
            simple: Ends::Low,
            role: Role::Refined,
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "one direction is faster at any amplitude; even harmonics that grow with the command",
    mistaken_for: &["null_bias", "asymmetric_limit"],
    test: "ramps both ways at several speeds",
    order: Order::Second,
    contains: &[],
    counter: None,
};

/// A lag that is none, and the fastest that is resolved, s.
const NONE: f64 = 5e-5;
const FASTEST: f64 = 1e-4;
/// Rate of steps short enough, 1/s, as for a delay: what passes within a step acts as its mean.
const PASSED: f64 = 2000.0;

/// A gain for each direction.
#[derive(Debug, Clone)]
pub(crate) struct AsymmetricGain<S> {
    difference: S,
    stage: Option<Stages<S>>,
}

/// Stages that lag, exactly for a command that is held over a step.
#[derive(Debug, Clone)]
struct Stages<S> {
    lag: S,
    passed: S,
    /// A step, s, and the shares of what was passed at its start that are left at its end and over it on average.
    step: (f64, S, S),
}

impl<S: Scalar> Stages<S> {
    fn new(lag: S) -> Self {
        let zero = S::from(0.0);
        Self { lag, passed: zero, step: (0.0, zero, zero) }
    }

    /// What they pass on average over a step of `h` seconds.
    fn pass(&mut self, u: S, h: f64) -> S {
        if self.step.0 != h {
            let left = (S::from(-h) / self.lag).exp();
            self.step = (h, left, (S::from(1.0) - left) * self.lag / h);
        }
        let (_, left, mean) = self.step;
        let away = self.passed - u;
        self.passed = u + away * left;
        u + away * mean
    }
}

impl<S: Scalar> AsymmetricGain<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[difference, lag] = parameters else { return None };
        Some(Self { difference, stage: Some(lag).filter(|lag| lag.value() > FASTEST).map(Stages::new) })
    }
}

impl<S: Scalar> Effect<S> for AsymmetricGain<S> {
    fn hooks(&self) -> Hooks {
        Hooks { valve: true, command: self.stage.is_some(), ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        self.stage.as_ref().map_or(0.0, |stage| (1.0 / stage.lag.value()).min(PASSED))
    }
    fn under_way(&mut self, command: S) {
        if let Some(stage) = &mut self.stage {
            stage.passed = command;
        }
    }
    fn command(&mut self, u: S, h: f64) -> S {
        self.stage.as_mut().map_or(u, |stage| stage.pass(u, h))
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
        let gain = AsymmetricGain::new(&[0.1, NONE]).unwrap();
        assert!(!gain.hooks().command);
        assert!((gain.valve(2.0, &[], &mut []) - 2.2).abs() < 1e-12);
        assert!((gain.valve(-2.0, &[], &mut []) + 1.8).abs() < 1e-12);
    }

    /// A step of the command arrives as it does in a first-order system, on average over each step; what was sent before is there.
    #[test]
    fn stages_lag_exactly() {
        let mut gain = AsymmetricGain::new(&[0.1, 2e-3]).unwrap();
        let passed: Vec<f64> = (0..4).map(|_| gain.command(1.0, 1e-3)).collect();
        for (k, passed) in passed.into_iter().enumerate() {
            let integral = |t: f64| t + 2e-3 * (-t / 2e-3).exp();
            let (from, to) = (1e-3 * k as f64, 1e-3 * (k as f64 + 1.0));
            let mean = (integral(to) - integral(from)) / 1e-3;
            assert!((passed - mean).abs() < 1e-12, "{passed} {mean}");
        }
        gain.under_way(0.5);
        assert!((gain.command(0.5, 1e-3) - 0.5).abs() < 1e-12);
    }
}
