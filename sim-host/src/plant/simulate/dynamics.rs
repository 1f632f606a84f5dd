//! The plant's equations with any effects in place, and their integration.

use super::{Instant, Placed, SimulateError, Start, build, entry};
use crate::plant::effects::{Compliance, Effect, Flow, Hooks, Yardstick};
use crate::plant::model::Baseline;
use crate::scalar::Scalar;

/// Continuous states provided for: four of the plant, the rest of its effects.
pub(super) const STATES: usize = 16;

const DISPLACEMENT: usize = 0;
/// The servo's state z, or a rigid mass's velocity.
const SPEED: usize = 1;
/// The table's velocity where the actuator yields.
const TABLE: usize = 2;
/// Load pressure over area and mass, m/s2, where the oil is compressible.
const LOAD: usize = 3;
const FIRST_OF_EFFECTS: usize = 4;

/// Everything that changes during a run.
#[derive(Debug, Clone)]
pub(super) struct State<S> {
    /// The controller's command, in its unit.
    pub(super) command: S,
    /// The command as the valve sees it during this step.
    spool: S,
    time: f64,
    y: [S; STATES],
}

/// One effect in place.
#[derive(Debug)]
struct Mounted<S> {
    effect: Box<dyn Effect<S>>,
    hooks: Hooks,
    first: usize,
    last: usize,
}

/// A plant ready to run.
#[derive(Debug)]
pub(super) struct Dynamics<S> {
    baseline: Baseline<S>,
    mounted: Vec<Mounted<S>>,
    compliance: Compliance<S>,
    yields: bool,
    velocity_limit: S,
    used: usize,
}

/// A value and its rate.
struct Rates<S> {
    dy: [S; STATES],
    motion: Instant<S>,
    force: S,
}

impl<S: Scalar> Dynamics<S> {
    pub(super) fn new(baseline: &Baseline<S>, effects: &[Placed<S>]) -> Result<Self, SimulateError> {
        let mut first = FIRST_OF_EFFECTS;
        let mut mounted = Vec::with_capacity(effects.len());
        let mut compliance = Compliance { oil: None, leakage: None, stall_acceleration: None };
        for placed in effects {
            let effect = build(placed.id, &per_mass(baseline, placed)).ok_or_else(|| SimulateError::UnknownEffect {
                id: placed.id.to_owned(),
                count: placed.parameters.len(),
            })?;
            effect.yields(&mut compliance);
            let last = first + effect.states();
            mounted.push(Mounted { hooks: effect.hooks(), effect, first, last });
            first = last;
        }
        if first > STATES {
            return Err(SimulateError::TooManyStates { states: first });
        }
        let velocity_limit = match *baseline {
            Baseline::Servo { velocity_limit, .. } => velocity_limit,
            Baseline::RigidMass { .. } => S::from(1.0),
            Baseline::ForceBalance { .. } => return Err(SimulateError::NoLoop),
        };
        let yields =
            compliance.oil.is_some() || compliance.leakage.is_some() || compliance.stall_acceleration.is_some();
        Ok(Self { baseline: *baseline, mounted, compliance, yields, velocity_limit, used: first })
    }

    /// The state a run starts from.
    pub(super) fn rest(&self, start: &Start<S>) -> State<S> {
        let mut y = [S::from(0.0); STATES];
        y[DISPLACEMENT] = start.displacement;
        y[SPEED] = start.velocity;
        y[TABLE] = start.velocity;
        for m in &self.mounted {
            m.effect.rest(start.displacement, &mut y[m.first..m.last]);
        }
        State { command: S::from(0.0), spool: S::from(0.0), time: 0.0, y }
    }

    /// Takes the command through what has memory, for a step of `h` seconds.
    pub(super) fn begin_step(&mut self, state: &mut State<S>, h: f64) {
        state.spool = state.command;
        for m in self.mounted.iter_mut().filter(|m| m.hooks.command) {
            state.spool = m.effect.command(state.spool, h);
        }
    }

    /// Advances the state by `h` seconds with the classical fourth-order rule.
    pub(super) fn advance(&mut self, state: &mut State<S>, h: f64) {
        let y = state.y;
        let at = |scale: f64, k: &[S; STATES], n: usize| {
            let mut moved = y;
            for i in 0..n {
                moved[i] += k[i] * scale;
            }
            moved
        };
        let (n, t, u) = (self.used, state.time, state.spool);
        let k1 = self.rates(t, u, &y, h).dy;
        let k2 = self.rates(t + 0.5 * h, u, &at(0.5 * h, &k1, n), h).dy;
        let k3 = self.rates(t + 0.5 * h, u, &at(0.5 * h, &k2, n), h).dy;
        let k4 = self.rates(t + h, u, &at(h, &k3, n), h).dy;
        for i in 0..n {
            state.y[i] += (k1[i] + (k2[i] + k3[i]) * 2.0 + k4[i]) * (h / 6.0);
        }
        state.time += h;
        if self.mounted.iter().any(|m| m.hooks.after) {
            let motion = self.motion(state);
            for m in self.mounted.iter_mut().filter(|m| m.hooks.after) {
                m.effect.after(&motion, h);
            }
        }
    }

    /// Displacement and velocity now, after the command's update.
    pub(super) fn motion(&self, state: &State<S>) -> Instant<S> {
        self.rates(state.time, state.spool, &state.y, super::LONGEST_STEP).motion
    }

    /// The force per table mass that opposes positive motion now, m/s2.
    pub(super) fn friction(&self, state: &State<S>) -> S {
        self.rates(state.time, state.spool, &state.y, super::LONGEST_STEP).force
    }

    /// The velocity whose difference the accelerometer shows, and the table's own.
    pub(super) fn velocities(&self, state: &State<S>) -> (S, S) {
        let motion = self.motion(state);
        let mut sensed = motion.velocity;
        for m in self.mounted.iter().filter(|m| m.hooks.velocity) {
            sensed = m.effect.sense_velocity(sensed, &state.y[m.first..m.last]);
        }
        (sensed, motion.velocity)
    }

    pub(super) fn sense_displacement(&self, state: &State<S>) -> S {
        self.mounted
            .iter()
            .filter(|m| m.hooks.displacement)
            .fold(state.y[DISPLACEMENT], |x, m| m.effect.sense_displacement(x, &state.y[m.first..m.last]))
    }

    pub(super) fn sense_acceleration(&self, mean: S, at: &Instant<S>) -> S {
        self.mounted
            .iter()
            .filter(|m| m.hooks.acceleration)
            .fold(mean, |a, m| m.effect.sense_acceleration(a, at))
    }

    pub(super) fn supply_pressure(&self, state: &State<S>) -> Option<S> {
        self.mounted.iter().find_map(|m| m.effect.supply_pressure(&state.y[m.first..m.last]))
    }

    /// Derivatives of every state, with the motion and the force they imply.
    fn rates(&self, time: f64, command: S, y: &[S; STATES], h: f64) -> Rates<S> {
        let mut dy = [S::from(0.0); STATES];
        let mut spool = command;
        for m in self.mounted.iter().filter(|m| m.hooks.valve) {
            spool = m.effect.valve(spool, &y[m.first..m.last], &mut dy[m.first..m.last]);
        }
        let mut at = Instant {
            time,
            displacement: y[DISPLACEMENT],
            velocity: y[SPEED],
            sensed_velocity: S::from(0.0),
            velocity_limit: self.velocity_limit,
        };
        let flow = match self.baseline {
            Baseline::Servo { b1, .. } => self.flow(&at, y[SPEED] + b1 * spool, y),
            _ => y[SPEED],
        };
        at.velocity = if self.yields { y[TABLE] } else { flow };
        let mut force = S::from(0.0);
        for m in self.mounted.iter().filter(|m| m.hooks.force) {
            force += m.effect.force(&at, &y[m.first..m.last], &mut dy[m.first..m.last]);
        }
        at.sensed_velocity = at.velocity;
        for m in self.mounted.iter().filter(|m| m.hooks.follow || m.hooks.velocity) {
            m.effect.follow(&at, &y[m.first..m.last], &mut dy[m.first..m.last]);
            at.sensed_velocity = m.effect.sense_velocity(at.sensed_velocity, &y[m.first..m.last]);
        }
        dy[DISPLACEMENT] = at.velocity;
        match self.baseline {
            Baseline::Servo { b1, b0, a1, .. } => {
                dy[SPEED] = -a1 * y[SPEED] + (b0 - b1 * a1) * spool - force;
                self.yielding(flow, force, y, &mut dy, h);
            }
            Baseline::RigidMass { mass, viscous, gain } => {
                dy[SPEED] = (gain * spool - viscous * y[SPEED]) / mass - force;
            }
            Baseline::ForceBalance { .. } => {}
        }
        Rates { dy, motion: at, force }
    }

    /// The flow the valve lets through, as piston velocity, for the demand `w`.
    fn flow(&self, at: &Instant<S>, w: S, y: &[S; STATES]) -> S {
        let one = S::from(1.0);
        let limit = self.velocity_limit;
        let mut flow = Flow { gain: one, limit: one, positive: limit, negative: limit, sharpness: None };
        let mut shaped = false;
        for m in self.mounted.iter().filter(|m| m.hooks.flow) {
            m.effect.flow(at, &y[m.first..m.last], &mut flow);
            shaped = true;
        }
        if !shaped {
            return w.clamp(-limit, limit);
        }
        let demand = w * flow.gain;
        let (positive, negative) = (flow.positive * flow.limit, flow.negative * flow.limit);
        match flow.sharpness {
            None => demand.clamp(-negative, positive),
            Some(n) if demand.value() >= 0.0 => soften(demand, positive, n),
            Some(n) => -soften(-demand, negative, n),
        }
    }

    /// Velocity and load of an actuator that yields, driven by `flow`.
    fn yielding(&self, flow: S, force: S, y: &[S; STATES], dy: &mut [S; STATES], h: f64) {
        if !self.yields {
            return;
        }
        let (velocity, load) = (y[TABLE], y[LOAD]);
        let leakage = self.compliance.leakage.unwrap_or(S::from(0.0));
        if let Some((stiffness, damping)) = self.compliance.oil {
            let available = self.compliance.stall_acceleration.map_or(flow, |stall| flow * drop(flow, load, stall));
            dy[LOAD] = (available - velocity - leakage * load) * stiffness - load * damping;
            dy[TABLE] = load - force;
            return;
        }
        // Stiff oil: the load follows from the flow balance, q sqrt(1 - p/p_s) - C p = v, and the table obeys v' = p - f.
        // Where the balance is stiffer than the step, its time constant is held at what the step resolves.
        let mut time_constant = leakage;
        if let Some(stall) = self.compliance.stall_acceleration {
            let sum = flow.abs() + velocity.abs() + 1e-9;
            time_constant += flow * flow / (stall * sum);
        }
        let shortest = S::from(h / 1.4);
        dy[TABLE] = (flow - velocity) / time_constant.max(shortest) - force;
    }
}

/// The share of flow left when the load takes its part of the supply; beyond stall the flow turns round.
fn drop<S: Scalar>(flow: S, load: S, stall: S) -> S {
    let signed = if flow.value() < 0.0 { -load } else { load };
    let left = -(signed / stall) + 1.0;
    if left.value() >= 0.0 { left.sqrt() } else { -((-left).sqrt()) }
}

/// `w / (1 + (w/limit)^n)^(1/n)` for `w >= 0`, written so that neither small nor large ratios leave the floats.
fn soften<S: Scalar>(w: S, limit: S, n: S) -> S {
    let ratio = w / limit;
    if ratio.value() < 1e-6 {
        return w;
    }
    let inverse = S::from(1.0) / n;
    if ratio.value() <= 1.0 {
        w / (ratio.pow(n) + 1.0).pow(inverse)
    } else {
        limit / ((S::from(1.0) / ratio).pow(n) + 1.0).pow(inverse)
    }
}

/// An effect's parameters per table mass and in units of the command, as its equations take them.
fn per_mass<S: Scalar>(baseline: &Baseline<S>, placed: &Placed<S>) -> Vec<S> {
    let (Baseline::RigidMass { mass, gain, .. }, Some(entry)) = (*baseline, entry(placed.id)) else {
        return placed.parameters.clone();
    };
    let convert = |(&value, parameter): (&S, &crate::plant::effects::Parameter)| match parameter.yardstick {
        Yardstick::Force => value / mass,
        Yardstick::Command => value / gain,
        _ => value,
    };
    placed.parameters.iter().zip(entry.parameters).map(convert).collect()
}
