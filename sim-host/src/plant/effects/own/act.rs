//! An effect of a user's own at work in the plant.

use super::super::bristle::Bristles;
use super::super::tangent::everywhere;
use super::super::{Dither, Effect, Flow, Hooks, Instant};
use super::memory::Memory;
use super::program::Program;
use super::register::registered;
use super::state::OwnInputs;
use super::{Sense, State};
use crate::scalar::Scalar;

/// Travel over which the contact bends behind `sign(velocity)`, m: as the library's dry friction has it.
const PRESLIDING: f64 = 2e-5;

/// The effect with this identifier; behind its parameters may stand what its expression is divided by. One whose first parameter scales it
/// and is zero runs on plain numbers.
pub(in crate::plant::effects) fn build<S: Scalar>(id: &str, parameters: &[S]) -> Option<Box<dyn Effect<S>>> {
    let known = registered(id)?;
    let count = known.own.stated.parameters.len();
    let divisor = match parameters.len().checked_sub(count)? {
        0 => S::from(1.0),
        1 => *parameters.last()?,
        _ => return None,
    };
    if known.own.program.is_scaled() && parameters[0].value() == 0.0 {
        let mut plain: Vec<f64> = parameters.iter().map(|p| p.value()).collect();
        plain[0] = 1.0;
        return Some(everywhere(build(id, &plain)?, parameters[0]));
    }
    let parameters = parameters[..count].to_vec();
    let bristles = known.own.program.uses(State::VelocitySign).then(|| Bristles::new(S::from(PRESLIDING)));
    let (program, sense) = (&known.own.program, known.own.sense);
    let fastest = fastest(program, &parameters, divisor, sense);
    let (seen, memory, place) = (OwnInputs::none(), Memory::new(program.memories()), None);
    Some(Box::new(Acting { program, sense, parameters, divisor, bristles, memory, seen, place, fastest }))
}

/// True where an effect's expression is in newtons, which a rigid mass divides by its mass.
pub(in crate::plant) fn is_force(id: &str) -> bool {
    registered(id).is_some_and(|known| known.own.sense == Sense::Force)
}

#[derive(Debug)]
struct Acting<S> {
    program: &'static Program,
    sense: Sense,
    parameters: Vec<S>,
    /// The mass of a rigid mass for a force in newtons, else one.
    divisor: S,
    /// Behind `sign(velocity)`.
    bristles: Option<Bristles<S>>,
    /// Behind `lag`, `play` and `relay`.
    memory: Memory<S>,
    /// What was seen last: way and time, and for a command the motion.
    seen: OwnInputs<S>,
    place: Option<S>,
    fastest: f64,
}

impl<S: Scalar> Acting<S> {
    /// The value of what is seen of each state, `elapsed` seconds after what was seen last.
    fn value(&self, seen: impl Fn(State) -> S, elapsed: f64) -> S {
        self.program.value(seen, &self.parameters, &self.memory, elapsed) / self.divisor
    }

    /// Takes what was seen last into the memory.
    fn remember(&mut self, elapsed: f64) {
        let seen = &self.seen;
        self.program.settle(|state| seen.of(state), &self.parameters, &mut self.memory, elapsed);
    }

    /// What is seen of a state at an instant; what an instant does not hold is as it was seen last.
    fn at(&self, at: &Instant<S>, state: State) -> S {
        match state {
            State::Displacement => at.displacement,
            State::Velocity => at.velocity,
            State::VelocitySign => {
                self.bristles.as_ref().map_or(S::from(0.0), |bristles| bristles.share(at.displacement, at.time))
            }
            State::Path => self.seen.path + (at.displacement - self.place.unwrap_or(at.displacement)).abs(),
            State::Time => S::from(at.time),
            State::Acceleration | State::Command => self.seen.of(state),
        }
    }

    /// The value at an instant.
    fn value_at(&self, at: &Instant<S>) -> S {
        self.value(|state| self.at(at, state), at.time - self.seen.time)
    }
}

impl<S: Scalar> Effect<S> for Acting<S> {
    fn hooks(&self) -> Hooks {
        let remembers = self.bristles.is_some() || self.program.uses(State::Path) || self.program.remembers();
        let none = Hooks { after: remembers, command: self.program.uses(State::Command), ..Hooks::default() };
        match self.sense {
            Sense::ForcePerMass | Sense::Force => Hooks { force: true, ..none },
            Sense::Command => Hooks { command: true, after: true, ..none },
            Sense::Gain => Hooks { flow: true, ..none },
            Sense::Displacement => Hooks { displacement: true, after: true, linear: true, ..none },
            Sense::Acceleration => Hooks { acceleration: true, ..none },
        }
    }

    fn fastest(&self) -> f64 {
        self.fastest
    }

    fn dither(&mut self, dither: Dither) {
        if let Some(bristles) = &mut self.bristles {
            bristles.shake(dither.velocity);
        }
    }

    fn command(&mut self, u: S, h: f64) -> S {
        self.seen.command = u;
        if self.sense != Sense::Command {
            return u;
        }
        if self.program.remembers() {
            self.remember(h);
        }
        u + self.value(|state| self.seen.of(state), 0.0)
    }

    fn flow(&self, at: &Instant<S>, _y: &[S], flow: &mut Flow<S>) {
        flow.gain = flow.gain * (self.value_at(at) + 1.0);
    }

    fn force(&self, at: &Instant<S>, _y: &[S], _dy: &mut [S]) -> S {
        self.value_at(at)
    }

    fn after(&mut self, displacement: S, time: f64) {
        if let Some(bristles) = &mut self.bristles {
            bristles.settle(displacement, time);
            self.seen.velocity_sign = bristles.share(displacement, time);
        }
        let travel = displacement - self.place.unwrap_or(displacement);
        let elapsed = time - self.seen.time;
        if elapsed > 0.0 {
            self.seen.velocity = travel / elapsed;
        }
        self.seen.path += travel.abs();
        (self.seen.displacement, self.seen.time, self.place) = (displacement, time, Some(displacement));
        if self.program.remembers() && self.sense != Sense::Command {
            self.remember(elapsed);
        }
    }

    fn sense_displacement(&self, displacement: S, _y: &[S]) -> S {
        let seen = |state| if state == State::Displacement { displacement } else { self.seen.of(state) };
        displacement + self.value(seen, 0.0)
    }

    fn sense_acceleration(&self, acceleration: S, at: &Instant<S>) -> S {
        let seen = |state| if state == State::Acceleration { acceleration } else { self.at(at, state) };
        acceleration + self.value(seen, at.time - self.seen.time)
    }
}

/// The fastest rate that a force brings, 1/s: its slope in velocity, the root of its slope in displacement, and what swings
/// on the bristles of a dry contact, over what a table passes through.
fn fastest<S: Scalar>(program: &Program, parameters: &[S], divisor: S, sense: Sense) -> f64 {
    if !matches!(sense, Sense::ForcePerMass | Sense::Force) {
        return 0.0;
    }
    let parameters: Vec<f64> = parameters.iter().map(|p| p.value()).collect();
    let memory = Memory::at_zero(program.memories());
    let force = |x: f64, v: f64, s: f64| {
        let seen = OwnInputs { displacement: x, velocity: v, velocity_sign: s, ..OwnInputs::none() };
        program.value(|state| seen.of(state), &parameters, &memory, 0.0) / divisor.value()
    };
    let (dx, dv) = (1e-6, 1e-5);
    let mut fastest = 0.0_f64;
    for x in [-0.1, -0.02, 0.0, 0.02, 0.1] {
        for v in [-0.2, -0.02, -0.001, 0.0, 0.001, 0.02, 0.2] {
            let s = if v < 0.0 { -1.0 } else { 1.0 };
            let by_v = (force(x, v + dv, s) - force(x, v - dv, s)) / (2.0 * dv);
            let by_x = (force(x + dx, v, s) - force(x - dx, v, s)) / (2.0 * dx);
            let bent = (force(x, v, 1.0) - force(x, v, -1.0)).abs() / (2.0 * PRESLIDING);
            let rate = by_v.abs() + by_x.abs().sqrt() + 2.0 * bent.sqrt();
            fastest = if rate.is_finite() { fastest.max(rate) } else { fastest };
        }
    }
    fastest
}
