//! The accumulator empties under sustained flow and the pump refills it: pressure, and with its square root gain and
//! velocity limit, sag after long fast motion.
//!
//! The pressure is relative to its start; running at the limit for long it falls by `depth`. A second pump, or one whose stroke a
//! compensator sets, gives more once the accumulator is emptied by a share of that.

use super::{Effect, Ends, Entry, Family, Flow, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "supply_droop",
    equation: "p' = (1 - p - D abs(v)/v_max + D r s((1 - p)/D - c))/T, s from 0 to 1; gain and v_max times sqrt(p)",
    stage: Stage::Flow,
    family: Family::Flow,
    parameters: &[
        Parameter {
            key: "depth",
            unit: "1",
            rigid_unit: "1",
            meaning: "relative pressure lost under sustained motion at the velocity limit; beyond 1 the pump cannot sustain it",
            signal_scale: SignalScale::One,
            low: 0.005,
            high: 20.0,
            starts: &[0.02, 0.3],
            positive: true,
            simple: Ends::Low,
            role: Role::Shared,
        },
        Parameter {
            key: "recovery",
            unit: "s",
            rigid_unit: "s",
            meaning: "time constant of the recovery",
            signal_scale: SignalScale::One,
            low: 0.05,
            high: 600.0,
            starts: &[0.4, 3.0],
            positive: true,
            simple: Ends::High,
            role: Role::Shared,
        },
        Parameter {
            key: "reserve",
            unit: "1",
            rigid_unit: "1",
            meaning: "what a second pump gives, relative to the motion at the velocity limit: r",
            signal_scale: SignalScale::One,
            low: NONE,
            high: 10.0,
            starts: &[NONE],
            positive: true,
            simple: Ends::Low,
            role: Role::Refined,
        },
        Parameter {
            key: "cut_in",
            unit: "1",
            rigid_unit: "1",
            meaning: "share of the depth at which the second pump comes in: c",
            signal_scale: SignalScale::One,
            low: 0.02,
            high: 1.0,
            starts: &[0.2, 0.4],
            positive: true,
            simple: Ends::High,
            role: Role::Refined,
        },
    ],
    kinds: &[Kind::Servo],
    frees: &[],
    signature: "gain and limit sag after fast motion and recover in seconds",
    mistaken_for: &["gain_drift", "flow_softening", "load_dependent_flow"],
    test: "back-to-back ramps; supply pressure logged",
    order: Order::Second,
    contains: &[],
    counter: Some(|parameters, countered| {
        if let &[depth, recovery, ..] = parameters {
            countered.droop = (depth, recovery);
        }
    }),
};

/// A second pump that is none.
const NONE: f64 = 1e-3;
/// Share of the depth within which a second pump comes in.
const RAMP: f64 = 0.02;

/// An accumulator that empties.
#[derive(Debug, Clone)]
pub(crate) struct SupplyDroop<S> {
    depth: S,
    recovery: S,
    /// What a second pump gives, and from which share of the depth on.
    second: Option<(S, S)>,
}

impl<S: Scalar> SupplyDroop<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[depth, recovery, reserve, cut_in] = parameters else { return None };
        Some(Self { depth, recovery, second: Some((reserve, cut_in)).filter(|_| reserve.value() > NONE) })
    }

    /// What a second pump gives at a pressure, in units of the depth.
    fn reserve(&self, pressure: S) -> S {
        let Some((reserve, cut_in)) = self.second else { return S::from(0.0) };
        let emptied = (-pressure + 1.0) / self.depth;
        reserve * (((emptied - cut_in) / (2.0 * RAMP)).tanh() + 1.0) * 0.5
    }
}

impl<S: Scalar> Effect<S> for SupplyDroop<S> {
    fn hooks(&self) -> Hooks {
        Hooks { flow: true, follow: true, ..Hooks::default() }
    }
    fn states(&self) -> usize {
        1
    }
    fn rest(&self, _displacement: S, y: &mut [S]) {
        y.fill(S::from(1.0));
    }
    fn flow(&self, _at: &Instant<S>, y: &[S], flow: &mut Flow<S>) {
        if let Some(&pressure) = y.first() {
            let root = pressure.max(S::from(0.02)).sqrt();
            flow.gain = flow.gain * root;
            flow.limit = flow.limit * root;
        }
    }
    fn follow(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) {
        if let (Some(&pressure), Some(rate)) = (y.first(), dy.first_mut()) {
            let drawn = at.velocity.abs() / at.velocity_limit - self.reserve(pressure);
            *rate = (-pressure + 1.0 - self.depth * drawn) / self.recovery;
        }
    }
    fn supply_pressure(&self, y: &[S]) -> Option<S> {
        y.first().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Under steady motion the pressure settles where outflow and inflow are equal: a second pump gives it back from its share of the depth on.
    #[test]
    fn a_second_pump_comes_in_at_its_share_of_the_depth() {
        let settled = |reserve: f64, cut_in: f64, velocity: f64| {
            let droop = SupplyDroop::<f64>::new(&[0.4, 2.0, reserve, cut_in]).unwrap();
            let at = Instant { time: 0.0, displacement: 0.0, velocity, sensed_velocity: velocity, velocity_limit: 1.0 };
            let (mut pressure, mut rate) = ([1.0], [0.0]);
            for _ in 0..200_000 {
                droop.follow(&at, &pressure, &mut rate);
                pressure[0] += 1e-3 * rate[0];
            }
            pressure[0]
        };
        assert!((settled(NONE, 0.5, 0.8) - 0.68).abs() < 1e-9, "none: 1 - 0.4 0.8");
        assert!((settled(0.2, 0.5, 0.3) - 0.88).abs() < 1e-4, "not called for: 1 - 0.4 0.3");
        assert!((settled(0.2, 0.5, 0.8) - 0.76).abs() < 1e-3, "whole: 1 - 0.4 (0.8 - 0.2)");
        assert!((settled(0.2, 0.5, 0.6) - 0.8).abs() < 8e-3, "it holds the pressure where it comes in");
    }
}
