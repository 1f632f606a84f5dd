//! The spool cannot move faster than its pilot stage lets it, which may be another rate either way.
//!
//! The pilot's flow grows with the distance that the spool has still to go, up to what its orifice passes: far from its
//! command the spool moves at its greatest rate, close to it as a first-order lag (Merritt, *Hydraulic Control Systems*,
//! 1967, section 7-5). A pilot that works against a supply of its own on one side alone, or a piston of unequal areas, moves the spool
//! at another rate back than forth.

use super::{Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "valve_rate_limit",
    equation: "s' = clamp((u - s)/tau, -k R, R)",
    stage: Stage::Valve,
    family: Family::Valve,
    parameters: &[
        Parameter {
            key: "rate",
            unit: "unit of u per s",
            rigid_unit: "unit of u per s",
            meaning: "fastest rise of the command that the spool follows: R",
            signal_scale: SignalScale::CommandRate,
            low: 0.002,
            high: 20.0,
            starts: &[0.9, 0.65, 0.45, 0.3, 0.2, 0.12, 0.06],
            positive: true,
            simple: Ends::High,
            role: Role::Shared,
        },
        Parameter {
            key: "time",
            unit: "s",
            rigid_unit: "s",
            meaning: "time constant with which the spool comes to rest on its command",
            signal_scale: SignalScale::One,
            low: 1e-5,
            high: 5e-3,
            // A pilot stage of some 300 Hz, as servovalves of this size have.
            starts: &[5e-4],
            positive: true,
            simple: Ends::Low,
            role: Role::Refined,
        },
        Parameter {
            key: "fall",
            unit: "1",
            rigid_unit: "1",
            meaning: "fastest fall of it over its fastest rise: k",
            signal_scale: SignalScale::One,
            low: 0.1,
            high: 10.0,
            starts: &[1.0],
            positive: true,
            simple: Ends::Both,
            role: Role::Refined,
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "large fast commands come out as ramps; small ones are untouched",
    mistaken_for: &["valve_lag", "command_delay"],
    test: "one frequency at growing amplitude",
    order: Order::Second,
    contains: &[],
    counter: None,
};

/// A limit on the spool's speed.
#[derive(Debug, Clone)]
pub(crate) struct ValveRateLimit<S> {
    rise: S,
    fall: S,
    time: S,
    spool: S,
}

impl<S: Scalar> ValveRateLimit<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[rise, time, fall] = parameters else { return None };
        Some(Self { rise, fall: rise * fall, time, spool: S::from(0.0) })
    }
}

impl<S: Scalar> Effect<S> for ValveRateLimit<S> {
    fn hooks(&self) -> Hooks {
        Hooks { command: true, linear: true, ..Hooks::default() }
    }
    fn under_way(&mut self, command: S) {
        self.spool = command;
    }
    /// Exact for a command held over the step: first the ramp, then the exponential.
    fn command(&mut self, u: S, h: f64) -> S {
        let away = self.spool - u;
        let (side, rate) = if away.value() < 0.0 { (-1.0, self.rise) } else { (1.0, self.fall) };
        let near = rate * self.time;
        let ramp = ((away * side - near) / rate).clamp(S::from(0.0), S::from(h));
        let travel = rate * ramp * side;
        let left = away - travel;
        let rest = -ramp + h;
        let decay = (-(rest / self.time)).exp();
        self.spool = u + left * decay;
        let area = (away - travel * 0.5) * ramp + left * self.time * (-decay + 1.0);
        u + area / h
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step of 1 at a rate of 10 and 2 ms: a ramp to 0.98 in 98 ms, then an exponential.
    #[test]
    fn a_step_is_a_ramp_and_then_an_exponential() {
        let mut valve = ValveRateLimit::new(&[10.0, 2e-3, 1.0]).unwrap();
        let (h, mut mean) = (7e-3, 0.0);
        for k in 0..20 {
            mean += valve.command(1.0, h) * h;
            let t = f64::from(k + 1) * h;
            let exact = if t <= 0.098 { 10.0 * t } else { 1.0 - 0.02 * (-(t - 0.098) / 2e-3).exp() };
            assert!((valve.spool - exact).abs() < 1e-12, "{t}: {} for {exact}", valve.spool);
        }
        // What is missed of the command: 0.98 times half the ramp, 0.02 over it, and 0.02 times the time constant.
        let missed = 0.98 * 0.049 + 0.02 * 0.098 + 0.02 * 2e-3;
        assert!((0.14 - mean - missed).abs() < 1e-9, "{mean}");
    }

    /// At a rate of 10 up and 4 down, without a lag to speak of, half a second up and half a second down end at 5 - 2 = 3.
    #[test]
    fn a_spool_falls_at_another_rate_than_it_rises() {
        let mut valve = ValveRateLimit::new(&[10.0, 1e-6, 0.4]).unwrap();
        let h = 1e-3;
        for (command, spool) in [(100.0, 5.0), (-100.0, 3.0)] {
            for _ in 0..500 {
                valve.command(command, h);
            }
            assert!((valve.spool - spool).abs() < 1e-9, "{}", valve.spool);
        }
    }

    /// What is slow enough passes with no more than the pilot's own lag.
    #[test]
    fn a_limit_out_of_reach_leaves_a_short_lag() {
        let mut valve = ValveRateLimit::new(&[1e6, 1e-5, 1.0]).unwrap();
        assert!((valve.command(0.3, 1e-3) - 0.3).abs() < 0.3 * 0.011);
        assert!((valve.command(0.3, 1e-3) - 0.3).abs() < 1e-12);
    }
}
