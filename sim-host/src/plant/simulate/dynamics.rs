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
pub(super) struct State<S, const M: usize> {
    /// The controller's command, in its unit.
    pub(super) command: S,
    /// The command as the valve sees it during this step.
    spool: S,
    time: f64,
    y: [S; M],
}

/// What an integration step passes through.
pub(super) struct Passage<S> {
    /// Motion at its start, after the command's update.
    pub(super) start: Instant<S>,
    /// Force per table mass at its start, m/s2.
    pub(super) force: S,
    /// Sensed and true velocity half way, m/s; none where they were not asked for.
    pub(super) middle: Option<(S, S)>,
}

/// One effect in place.
#[derive(Debug)]
pub(super) struct Mounted<S> {
    pub(super) effect: Box<dyn Effect<S>>,
    hooks: Hooks,
    pub(super) first: usize,
    pub(super) last: usize,
}

impl<S: Scalar> Mounted<S> {
    /// Puts effects in place, their states from index `first` on; gives them, the end of their states and how the
    /// actuator yields.
    pub(super) fn all(
        effects: impl Iterator<Item = (&'static str, Vec<S>)>,
        mut first: usize,
        most: usize,
    ) -> Result<(Vec<Self>, usize, Compliance<S>), SimulateError> {
        let mut compliance = Compliance { oil: None, leakage: None, stall_acceleration: None };
        let mut mounted = Vec::new();
        for (id, parameters) in effects {
            let unknown = || SimulateError::UnknownEffect { id: id.to_owned(), count: parameters.len() };
            let effect = build(id, &parameters).ok_or_else(unknown)?;
            effect.yields(&mut compliance);
            let last = first + effect.states();
            mounted.push(Self { hooks: effect.hooks(), effect, first, last });
            first = last;
        }
        if first > most {
            Err(SimulateError::TooManyStates { states: first })
        } else {
            Ok((mounted, first, compliance))
        }
    }
}

/// A plant ready to run, with `M` continuous states.
#[derive(Debug)]
pub(super) struct Dynamics<S, const M: usize> {
    baseline: Baseline<S>,
    mounted: Vec<Mounted<S>>,
    compliance: Compliance<S>,
    yields: bool,
    velocity_limit: S,
    used: usize,
}

/// Continuous states of a plant with these effects.
pub(super) fn states_of<S: Scalar>(effects: &[Placed<S>]) -> usize {
    let of = |p: &Placed<S>| build(p.id, &p.parameters).map_or(0, |effect| effect.states());
    FIRST_OF_EFFECTS + effects.iter().map(of).sum::<usize>()
}

impl<S: Scalar, const M: usize> Dynamics<S, M> {
    pub(super) fn new(baseline: &Baseline<S>, effects: &[Placed<S>]) -> Result<Self, SimulateError> {
        let placed = effects.iter().map(|placed| (placed.id, per_mass(baseline, placed)));
        let (mounted, first, compliance) = Mounted::all(placed, FIRST_OF_EFFECTS, M)?;
        let velocity_limit = match *baseline {
            Baseline::Servo { velocity_limit, .. } => velocity_limit,
            Baseline::RigidMass { .. } => S::from(1.0),
            Baseline::ForceBalance { .. } => return Err(SimulateError::NoLoop),
        };
        let yields =
            compliance.oil.is_some() || compliance.leakage.is_some() || compliance.stall_acceleration.is_some();
        Ok(Self { baseline: *baseline, mounted, compliance, yields, velocity_limit, used: first })
    }

    /// Tells the effects what noise (unit of u) the loop puts on the command.
    pub(super) fn command_noise(&mut self, noise: f64) {
        self.mounted.iter_mut().for_each(|m| m.effect.command_noise(noise));
    }

    /// The state a run starts from.
    pub(super) fn rest(&self, start: &Start<S>) -> State<S, M> {
        let mut y = [S::from(0.0); M];
        y[DISPLACEMENT] = start.displacement;
        y[SPEED] = start.velocity;
        y[TABLE] = start.velocity;
        for m in &self.mounted {
            m.effect.rest(start.displacement, &mut y[m.first..m.last]);
        }
        y.iter_mut().skip(FIRST_OF_EFFECTS).zip(&start.states).for_each(|(y, &away)| *y += away);
        State { command: S::from(0.0), spool: S::from(0.0), time: 0.0, y }
    }

    /// The fastest rate among the effects' equations, 1/s: what the integration step has to resolve.
    pub(super) fn fastest(&self, sharp: bool) -> f64 {
        let oil = self.compliance.oil.map_or(0.0, |(stiffness, damping)| stiffness.value().sqrt() + damping.value());
        let leakage = self.compliance.leakage.map_or(0.0, |c| 1.0 / c.value().max(1e-4));
        let of = |m: &Mounted<S>| m.effect.fastest().max(if sharp { m.effect.sharpest() } else { 0.0 });
        self.mounted.iter().map(of).fold(oil.max(leakage.min(2e3)), f64::max)
    }

    /// True where an effect advances with whole steps, so that mid-sample must end one.
    pub(super) fn whole_steps(&self) -> bool {
        self.mounted.iter().any(|m| m.hooks.after && m.hooks.velocity)
    }

    /// Takes the command through what has memory, for a step of `h` seconds.
    pub(super) fn begin_step(&mut self, state: &mut State<S, M>, h: f64) {
        state.spool = state.command;
        for m in self.mounted.iter_mut().filter(|m| m.hooks.command) {
            state.spool = m.effect.command(state.spool, h);
        }
    }

    /// Advances the state by `h` seconds with the classical fourth-order rule; half way by its dense output.
    pub(super) fn advance(&mut self, state: &mut State<S, M>, h: f64, middle: bool) -> Passage<S> {
        let n = self.used;
        let zero = [S::from(0.0); M];
        let (mut k1, mut k2, mut k3, mut k4, mut moved) = (zero, zero, zero, zero, state.y);
        let y = &mut state.y;
        let shift = |moved: &mut [S; M], y: &[S; M], rate: &[S; M], scale: f64| {
            for i in 0..n {
                moved[i] = y[i] + rate[i] * scale;
            }
        };
        let (t, u) = (state.time, state.spool);
        let (start, force) = self.rates(t, u, y, h, &mut k1);
        shift(&mut moved, y, &k1, 0.5 * h);
        self.rates(t + 0.5 * h, u, &moved, h, &mut k2);
        shift(&mut moved, y, &k2, 0.5 * h);
        self.rates(t + 0.5 * h, u, &moved, h, &mut k3);
        shift(&mut moved, y, &k3, h);
        self.rates(t + h, u, &moved, h, &mut k4);
        let middle = middle.then(|| {
            for i in 0..n {
                moved[i] = y[i] + (k1[i] * 5.0 + (k2[i] + k3[i]) * 4.0 - k4[i]) * (h / 24.0);
            }
            self.velocities_at(t + 0.5 * h, u, &moved, h)
        });
        for i in 0..n {
            y[i] += (k1[i] + (k2[i] + k3[i]) * 2.0 + k4[i]) * (h / 6.0);
        }
        state.time += h;
        let displacement = state.y[DISPLACEMENT];
        for m in self.mounted.iter_mut().filter(|m| m.hooks.after) {
            m.effect.after(displacement);
        }
        Passage { start, force, middle }
    }

    /// The velocity whose difference the accelerometer shows, and the table's own.
    pub(super) fn velocities(&self, state: &State<S, M>, h: f64) -> (S, S) {
        self.velocities_at(state.time, state.spool, &state.y, h)
    }

    fn velocities_at(&self, time: f64, command: S, y: &[S; M], h: f64) -> (S, S) {
        let motion = self.rates(time, command, y, h, &mut [S::from(0.0); M]).0;
        let mut sensed = motion.velocity;
        for m in self.mounted.iter().filter(|m| m.hooks.velocity) {
            sensed = m.effect.sense_velocity(sensed, &y[m.first..m.last]);
        }
        (sensed, motion.velocity)
    }

    pub(super) fn sense_displacement(&self, state: &State<S, M>) -> S {
        self.mounted
            .iter()
            .filter(|m| m.hooks.displacement)
            .fold(state.y[DISPLACEMENT], |x, m| m.effect.sense_displacement(x, &state.y[m.first..m.last]))
    }

    pub(super) fn sense_acceleration(&self, mean: S, at: &Instant<S>) -> S {
        self.mounted.iter().filter(|m| m.hooks.acceleration).fold(mean, |a, m| m.effect.sense_acceleration(a, at))
    }

    pub(super) fn supply_pressure(&self, state: &State<S, M>) -> Option<S> {
        self.mounted.iter().find_map(|m| m.effect.supply_pressure(&state.y[m.first..m.last]))
    }

    /// Derivatives of every state into `dy`; the motion and the force (m/s2) they imply.
    fn rates(&self, time: f64, command: S, y: &[S; M], h: f64, dy: &mut [S; M]) -> (Instant<S>, S) {
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
                self.yielding(flow, force, y, dy, h);
            }
            Baseline::RigidMass { mass, viscous, gain } => {
                dy[SPEED] = (gain * spool - viscous * y[SPEED]) / mass - force;
            }
            Baseline::ForceBalance { .. } => {}
        }
        (at, force)
    }

    /// The flow the valve lets through, as piston velocity, for the demand `w`.
    fn flow(&self, at: &Instant<S>, w: S, y: &[S; M]) -> S {
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
    fn yielding(&self, flow: S, force: S, y: &[S; M], dy: &mut [S; M], h: f64) {
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
