//! Lost motion between the actuator, where the LVDT sits, and the table, where the accelerometer sits: the table stays
//! until the gap is crossed, and then follows the sooner the harder the contact.
//!
//! With `d` the actuator's lead over the table and `h` half the gap, `dd/dx = 1 - |d/h|^n` while the lead grows and 1 while
//! it shrinks: Duhem's form of hysteresis, of which ideal play is the limit of large `n`. A joint whose faces meet over
//! their whole area at once has a large one, a worn or elastic one a small. It depends on travel alone.
//!
//! Where the joint is elastic and the table's guide resists in proportion to velocity, the table follows with the time constant `T`
//! of the two: `T v_t = c(d)`, with `c` the joint's extension beyond the gap, rounded over `h/n` at its edges. The table then goes on
//! after a reversal until the joint has relaxed.
//!
//! Source: A. Visintin, "Differential Models of Hysteresis", Springer (1994), chapter V.

use super::displacement_lag::{SECOND, TIME_CONSTANT};
use super::{Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, SignalScale, Stage};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "backlash",
    equation: "x_t = x - d, dd/dx = 1 - |2 d/gap|^n as the lead d grows, 1 as it shrinks; elastic: T v_t = d beyond gap/2",
    stage: Stage::Table,
    family: Family::Contact,
    parameters: &[
        Parameter {
            key: "gap",
            unit: "m",
            rigid_unit: "m",
            meaning: "full width of the lost motion",
            signal_scale: SignalScale::One,
            low: 1e-6,
            high: 0.01,
            starts: &[1.2e-5, 4e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3],
            positive: true,
            simple: Ends::Low,
            role: Role::Shared,
        },
        Parameter {
            key: "contact",
            unit: "1",
            rigid_unit: "1",
            meaning: "how abruptly the gap closes: n",
            signal_scale: SignalScale::One,
            low: 1.0,
            high: 200.0,
            starts: &[6.0],
            positive: true,
            simple: Ends::High,
            role: Role::Shared,
        },
        Parameter {
            key: "relaxation",
            meaning: "time constant of the joint's stiffness and the guide's viscous resistance: T",
            ..SECOND
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "the accelerometer goes quiet after each reversal, then spikes; the LVDT shows nothing",
    mistaken_for: &["valve_deadband", "coulomb_friction"],
    test: "accelerometer against the second difference of the LVDT at reversals",
    order: Order::Second,
    contains: &[],
    counter: None,
};

/// Travel, in half gaps and divided by the exponent, that one step of the lead's equation covers while it bends.
const STRIDE: f64 = 0.4;
/// Share of the motion from which on the lead's equation is linear enough for one step.
const STRAIGHT: f64 = 0.95;
/// Travel, in half gaps, after which the lead has become the gap.
const SETTLED: f64 = 3.0;

/// Share of the gap that is left when it counts as closed.
const CLOSED: f64 = 1e-9;
/// Logarithm of the contact's share below which there is none.
const FREE: f64 = -7.0;

/// Lost motion between actuator and table.
#[derive(Debug, Clone)]
pub(crate) struct Backlash<S> {
    half: S,
    exponent: S,
    /// Time constant with which an elastic joint relaxes, s.
    relaxation: Option<S>,
    /// The actuator's lead over the table, m.
    lead: S,
    before: Option<S>,
}

impl<S: Scalar> Backlash<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[gap, exponent, relaxation] = parameters else { return None };
        let relaxation = Some(relaxation).filter(|time| time.value() > TIME_CONSTANT.low);
        Some(Self { half: gap * 0.5, exponent, relaxation, lead: S::from(0.0), before: None })
    }

    /// The table's velocity behind an elastic joint, whose extension the state is.
    fn followed(&self, y: &[S]) -> Option<S> {
        let (&lead, time) = y.first().zip(self.relaxation)?;
        let [ahead, behind] = [lead, -lead].map(|lead| softplus((lead / self.half - 1.0) * self.exponent));
        Some((ahead - behind) * self.half / (self.exponent * time))
    }

    /// Share of the motion that the table takes part in while the actuator moves at this velocity: 0 inside the gap, 1 in
    /// contact.
    fn share(&self, velocity: S) -> S {
        let close = self.lead.abs() / self.half;
        if self.lead.value() * velocity.value() <= 0.0 { S::from(0.0) } else { close.pow(self.exponent) }
    }

    /// The lead after a travel (m).
    fn led(&self, travel: S) -> S {
        let lead = self.lead;
        let shrinks = lead.value() * travel.value() < 0.0;
        if shrinks && travel.value().abs() <= lead.value().abs() {
            return lead + travel;
        }
        let (from, travel) = if shrinks { (S::from(0.0), travel + lead) } else { (lead, travel) };
        let sign = if travel.value() < 0.0 { -1.0 } else { 1.0 };
        let grown = grow(from.abs() / self.half, (travel * sign) / self.half, self.exponent);
        grown * self.half * sign
    }
}

/// `s` after `ds/dt = 1 - s^n` over `time`, from below 1: straight while nothing of the contact is felt, then by steps of the
/// exponential Rosenbrock-Euler rule, which are exact where the equation is linear, as it becomes near 1, and never pass 1 far.
fn grow<S: Scalar>(mut s: S, time: S, n: S) -> S {
    let mut left = time.min(S::from(SETTLED));
    let touch = (FREE / n.value()).exp();
    if s.value() < touch {
        let straight = left.min(-s + touch);
        s += straight;
        left -= straight;
    }
    while left.value() > 0.0 && s.value() < 1.0 - CLOSED {
        let power = s.pow(n);
        let slope = power * n / s;
        let longest = if power.value() < STRAIGHT { STRIDE / n.value().max(1.0) } else { SETTLED };
        let stride = left.min(S::from(longest));
        s = (s + stride * phi(-(slope * stride)) * (-power + 1.0)).min(S::from(1.0));
        left -= stride;
    }
    s
}

/// `ln(1 + exp(x))`.
fn softplus<S: Scalar>(x: S) -> S {
    let v = x.value();
    let value = v.max(0.0) + (-v.abs()).exp().ln_1p();
    x.chain(value, 1.0 / (1.0 + (-v).exp()))
}

/// `(exp(x) - 1)/x`.
fn phi<S: Scalar>(x: S) -> S {
    let v = x.value();
    if v.abs() < 1e-4 {
        return x.chain(1.0 + 0.5 * v, 0.5 + v / 3.0);
    }
    let value = v.exp_m1() / v;
    x.chain(value, (v.exp() - value) / v)
}

impl<S: Scalar> Effect<S> for Backlash<S> {
    fn hooks(&self) -> Hooks {
        let elastic = self.relaxation.is_some();
        Hooks { after: !elastic, follow: elastic, velocity: true, linear: !elastic, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        self.relaxation.map_or(0.0, |time| 1.0 / time.value())
    }
    fn states(&self) -> usize {
        usize::from(self.relaxation.is_some())
    }
    fn follow(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) {
        if let (Some(followed), Some(rate)) = (self.followed(y), dy.first_mut()) {
            *rate = at.sensed_velocity - followed;
        }
    }
    fn after(&mut self, displacement: S, _time: f64) {
        let travel = displacement - self.before.unwrap_or(displacement);
        self.lead = self.led(travel);
        self.before = Some(displacement);
    }
    fn sense_velocity(&self, velocity: S, y: &[S]) -> S {
        self.followed(y).unwrap_or_else(|| velocity * self.share(velocity))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moved(exponent: f64, to: &[f64], steps: usize) -> f64 {
        let mut joint = Backlash::<f64>::new(&[2e-4, exponent, 0.0]).unwrap();
        let mut at = 0.0;
        joint.after(at, 0.0);
        for &end in to {
            for k in 1..=steps {
                joint.after(at + (end - at) * k as f64 / steps as f64, 0.0);
            }
            at = end;
        }
        at - joint.lead
    }

    /// A hard contact is play: the table follows half a gap behind, and lies still over a whole gap after a reversal; in as few
    /// steps as there are reversals.
    #[test]
    fn a_hard_contact_is_play() {
        for (to, table) in [(vec![1e-3], 0.9e-3), (vec![1e-3, 0.85e-3], 0.9e-3), (vec![1e-3, 0.0], 0.1e-3)] {
            for steps in [1, 400] {
                let at = moved(60.0, &to, steps);
                assert!((at - table).abs() < 4e-6, "{to:?} in {steps}: {at}");
            }
        }
    }

    /// With n = 2 the equation is solved by the hyperbolic tangent.
    #[test]
    fn a_soft_contact_follows_its_equation() {
        let (half, travel) = (1e-4, 0.8e-4);
        let exact = travel - half * (travel / half).tanh();
        for steps in [1, 3, 50] {
            let at = moved(2.0, &[travel], steps);
            assert!((at - exact).abs() < 6e-3 * half, "{steps}: {at} {exact}");
        }
        assert!((moved(2.0, &[travel], 50) - exact).abs() < 1e-3 * half);
    }

    /// Driven at a constant velocity from the middle of its gap an elastic joint carries the table after `half/v`, and with
    /// `1 - exp(-t/T)` of the velocity from there on; where the actuator turns the table goes on until the joint has relaxed.
    #[test]
    fn an_elastic_joint_relaxes() {
        let (velocity, time) = (0.1, 2e-3);
        let joint = Backlash::<f64>::new(&[2e-4, 200.0, time]).unwrap();
        let at = |velocity: f64| Instant {
            time: 0.0,
            displacement: 0.0,
            velocity,
            sensed_velocity: velocity,
            velocity_limit: 1.0,
        };
        let (mut lead, step) = ([0.0], 1e-6);
        let mut rate = [0.0];
        for k in 0..5000 {
            joint.follow(&at(velocity), &lead, &mut rate);
            lead[0] += step * rate[0];
            let contact = (f64::from(k) * step - 1e-4 / velocity).max(0.0);
            let expected = velocity * (1.0 - (-contact / time).exp());
            assert!((joint.sense_velocity(velocity, &lead) - expected).abs() < 1.5e-3, "{k}");
        }
        joint.follow(&at(-velocity), &lead, &mut rate);
        assert!(joint.sense_velocity(-velocity, &lead) > 0.08 && rate[0] < -0.18);
    }

    /// However long the steps, the table's share of the motion is the slope of its place.
    #[test]
    fn a_step_of_any_length_gives_the_share_of_short_ones() {
        let shared = |exponent: f64, travel: f64, steps: usize| {
            let mut joint = Backlash::<f64>::new(&[2e-4, exponent, 0.0]).unwrap();
            for k in 0..=steps {
                joint.after(travel * k as f64 / steps as f64, 0.0);
            }
            joint.share(0.1)
        };
        for exponent in [2.0, 12.0, 60.0] {
            for travel in [0.5e-4, 0.95e-4, 1.05e-4, 2e-4] {
                let (long, short) = (shared(exponent, travel, 1), shared(exponent, travel, 1000));
                assert!((long - short).abs() < 0.02, "n {exponent}, {travel}: {long} {short}");
            }
        }
        let mut joint = Backlash::<f64>::new(&[2e-4, 60.0, 0.0]).unwrap();
        joint.after(0.0, 0.0);
        joint.after(1e-3, 0.0);
        assert!(joint.share(0.1) > 0.99 && joint.share(-0.1) == 0.0, "it lies still when the actuator turns");
    }
}
