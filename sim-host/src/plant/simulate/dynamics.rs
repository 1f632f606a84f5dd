//! The plant's equations with any effects in place, and their integration.

mod outside;

use super::law::CommandNoise;
use super::{EffectParameters, Instant, SimulateError, Start, build, entry};
use crate::plant::effects::{Compliance, Dither, Effect, Flow, Hooks, STATES, SignalScale};
use crate::plant::model::Baseline;
use crate::scalar::Scalar;

/// The fastest rate at which a load is taken to give way, 1/s: faster, and without end, it does so in the equations of leakage
/// and orifice. Half a millisecond is a tenth of what recordings resolve; it is the model's, whatever the steps.
const STIFFEST: f64 = 2000.0;

const DISPLACEMENT: usize = 0;
/// The servo's state z, or a rigid mass's velocity.
const SPEED: usize = 1;
/// Continuous states of a plant whose actuator does not yield.
const STIFF: usize = 2;
/// The table's velocity where the actuator yields.
const TABLE: usize = 2;
/// Load pressure over area and mass, m/s2, where the oil is compressible.
const LOAD: usize = 3;
/// Continuous states of a plant whose actuator yields.
const YIELDING: usize = 4;

/// Everything that changes during a run.
#[derive(Debug, Clone)]
pub(in crate::plant) struct State<S> {
    /// The controller's command, in its unit.
    pub(in crate::plant) command: S,
    /// The command as the valve sees it during this step.
    pub(in crate::plant) spool: S,
    pub(super) time: f64,
    pub(super) y: Vec<S>,
    /// Where a step does its sums.
    pub(super) work: Work<S>,
}

impl<S: Scalar> State<S> {
    /// Lets go of derivatives that have died away.
    pub(super) fn settle_derivatives(&mut self) {
        for y in &mut self.y {
            *y = y.settled();
        }
    }
}

/// Where an integration step does its sums, and what it passed through last.
#[derive(Debug, Clone)]
pub(super) struct Work<S> {
    k: [Vec<S>; 4],
    /// The state half way, after a step that was asked for it.
    pub(super) moved: Vec<S>,
    /// The start of the step, after the command's update.
    pub(super) start: EvaluatedState<S>,
    later: EvaluatedState<S>,
    /// What the valve was asked to let through at each stage, m/s.
    pub(super) demands: [f64; 4],
}

/// What the equations imply at one instant.
#[derive(Debug, Clone)]
pub(super) struct EvaluatedState<S> {
    /// The motion.
    pub(super) at: Instant<S>,
    /// Force per table mass, m/s2.
    pub(super) force: S,
    /// What the valve is asked to let through before its limits, as piston velocity, m/s.
    demand: f64,
}

/// A spool's position with what Eq. 7 makes of it.
struct Opening<S> {
    spool: S,
    /// `b1 u`, m/s.
    direct: S,
    /// `(b0 - b1 a1) u`, m/s2.
    driven: S,
}

/// Which side of its limits the flow is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Regime {
    /// Between them.
    Free,
    /// Held at the positive one.
    Positive,
    /// Held at the negative one.
    Negative,
}

/// One effect in place.
#[derive(Debug)]
pub(super) struct EffectInstance<S> {
    pub(super) effect: Box<dyn Effect<S>>,
    hooks: Hooks,
    /// It is at the valve and has no state there: what passes it stays the same over a step.
    opens: bool,
    pub(super) first: usize,
    pub(super) last: usize,
}

impl<S: Scalar> EffectInstance<S> {
    /// Puts effects in place, their states from an index on that follows from how the actuator yields; gives them, the
    /// end of their states and how the actuator yields.
    pub(super) fn all(
        effects: impl Iterator<Item = (&'static str, Vec<S>)>,
        first: impl Fn(&Compliance<S>) -> usize,
        most: usize,
    ) -> Result<(Vec<Self>, usize, Compliance<S>), SimulateError> {
        let mut compliance = Compliance::STIFF;
        let mut mounted = Vec::new();
        for (id, parameters) in effects {
            let unknown = || SimulateError::UnknownEffect { id: id.to_owned(), count: parameters.len() };
            let effect = build(id, &parameters).ok_or_else(unknown)?;
            effect.yields(&mut compliance);
            mounted.push(Self { hooks: effect.hooks(), effect, opens: false, first: 0, last: 0 });
        }
        let mut end = first(&compliance);
        for m in &mut mounted {
            (m.first, m.last) = (end, end + m.effect.states());
            end = m.last;
        }
        let behind_states = |m: &Self| m.hooks.valve && m.last > m.first;
        mounted.iter_mut().take_while(|m| !behind_states(m)).for_each(Self::open);
        if end > most { Err(SimulateError::TooManyStates { states: end }) } else { Ok((mounted, end, compliance)) }
    }

    /// Takes what it does at the valve out of the equations of a step: no state is behind it.
    fn open(&mut self) {
        if self.hooks.valve {
            let others = Hooks { valve: false, command: false, ..self.hooks };
            self.opens = true;
            self.hooks.valve = false;
            self.hooks.linear = others == Hooks::default();
        }
    }
}

/// A plant ready to run.
#[derive(Debug)]
pub(in crate::plant) struct Dynamics<S> {
    baseline: Baseline<S>,
    mounted: Vec<EffectInstance<S>>,
    /// The hooks that any of them uses.
    pub(super) any: Hooks,
    compliance: Compliance<S>,
    yields: bool,
    velocity_limit: S,
    /// `b0 - b1 a1` of a servo, 1/s2.
    lagged: S,
    /// Continuous states.
    pub(super) used: usize,
    /// Where set, the flow is taken to be on this side of its limits whatever is asked of it.
    pub(super) forced: Option<Regime>,
}

impl<S: Scalar> Dynamics<S> {
    pub(in crate::plant) fn new(
        baseline: &Baseline<S>,
        effects: &[EffectParameters<S>],
    ) -> Result<Self, SimulateError> {
        let placed = effects.iter().map(|placed| (placed.id, per_mass(baseline, placed)));
        let yields = |c: &Compliance<S>| c.oil.is_some() || c.leakage.is_some() || c.stall_acceleration.is_some();
        let first = |c: &Compliance<S>| if yields(c) { YIELDING } else { STIFF };
        let (mounted, used, compliance) = EffectInstance::all(placed, first, STATES)?;
        let (velocity_limit, lagged) = match *baseline {
            Baseline::Servo { velocity_limit, b1, b0, a1 } => (velocity_limit, b0 - b1 * a1),
            Baseline::RigidMass { .. } => (S::from(1.0), S::from(0.0)),
            Baseline::ForceBalance { .. } => return Err(SimulateError::NoLoop),
        };
        let any = mounted.iter().fold(Hooks::default(), |any, m| any.or(m.hooks));
        let (yields, forced) = (yields(&compliance), None);
        Ok(Self { baseline: *baseline, mounted, any, compliance, yields, velocity_limit, lagged, used, forced })
    }

    /// Tells the effects how the loop's noise shakes them.
    pub(super) fn shake(&mut self, noise: &CommandNoise) {
        let dither = Dither { command: noise.size(), velocity: self.velocity_noise(noise) };
        self.mounted.iter_mut().for_each(|m| m.effect.dither(dither));
    }

    /// Takes through what has memory the commands that were sent before a run that begins in the middle of a motion, each for this many
    /// steps of `h` seconds; before these the first was sent always, and `first` where none is known.
    pub(super) fn under_way(&mut self, sent: &[f64], first: S, steps: usize, h: f64) {
        if !self.any.command {
            return;
        }
        let since = sent.first().map_or(first, |&command| S::from(command));
        self.mounted.iter_mut().for_each(|m| m.effect.under_way(since));
        for &command in sent.iter().flat_map(|command| std::iter::repeat_n(command, steps)) {
            let with = self.mounted.iter_mut().filter(|m| m.hooks.command);
            with.fold(S::from(command), |spool, m| m.effect.command(spool, h));
        }
    }

    /// Standard deviation of the velocity that noise of the command causes, m/s. What is white from tick to tick drives a
    /// damped mass, whose velocity has the same variance whatever spring holds it; the rate of white noise gives white
    /// noise again.
    fn velocity_noise(&self, noise: &CommandNoise) -> f64 {
        let (direct, gain, damping) = match &self.baseline {
            Baseline::Servo { b1, a1, .. } => (b1.value(), self.lagged.value(), a1.value()),
            Baseline::RigidMass { mass, viscous, gain } => {
                (0.0, gain.value() / mass.value(), viscous.value() / mass.value())
            }
            Baseline::ForceBalance { .. } => return 0.0,
        };
        let damping = (damping + gain * noise.damping).max(1e-3);
        let driven = noise.white.powi(2) * noise.tick / (2.0 * damping) + noise.rate.powi(2);
        ((direct * noise.size()).powi(2) + gain * gain * driven).sqrt()
    }

    /// The state a run starts from; what has memory of the displacement is told where that is, or it would sleep through the first
    /// step.
    pub(in crate::plant) fn rest(&mut self, start: &Start<S>) -> State<S> {
        let mut y = vec![S::from(0.0); self.used];
        y[DISPLACEMENT] = start.displacement;
        y[SPEED] = start.velocity;
        if self.yields {
            y[TABLE] = start.velocity;
        }
        for m in &self.mounted {
            m.effect.rest(start.displacement, &mut y[m.first..m.last]);
        }
        let first = if self.yields { YIELDING } else { STIFF };
        y.iter_mut().skip(first).zip(&start.states).for_each(|(y, &away)| *y += away);
        let state = State { command: S::from(0.0), spool: S::from(0.0), time: start.time, work: self.work(), y };
        self.settle(&state);
        state
    }

    fn work(&self) -> Work<S> {
        let (zero, states) = (S::from(0.0), vec![S::from(0.0); self.used]);
        let at = Instant {
            time: 0.0,
            displacement: zero,
            velocity: zero,
            sensed_velocity: zero,
            velocity_limit: self.velocity_limit,
        };
        let seen = EvaluatedState { at, force: zero, demand: 0.0 };
        let k = std::array::from_fn(|_| states.clone());
        Work { k, moved: states, start: seen.clone(), later: seen, demands: [0.0; 4] }
    }

    /// The fastest rate among the effects' equations, 1/s: what the integration step has to resolve.
    pub(in crate::plant) fn fastest(&self) -> f64 {
        let stiffened = self.compliance.stiffened();
        let rate = |(stiffness, damping): (S, S)| (stiffness.value() * stiffened).sqrt() + damping.value() * stiffened;
        let oil = self.compliance.oil.map_or(0.0, rate);
        self.mounted.iter().map(|m| m.effect.fastest()).fold(oil.max(self.stiffest()), f64::max)
    }

    /// The fastest rate at which a load gives way, 1/s: beyond what its steps resolve the rule runs away.
    pub(super) fn stiffest(&self) -> f64 {
        let Compliance { oil, leakage, leakage_exponent, stall_acceleration, .. } = &self.compliance;
        let leakage = leakage.map_or(0.0, Scalar::value);
        match oil {
            // A leakage that comes and goes with the motion leaves stiff oil where it is not.
            _ if stall_acceleration.is_some() || leakage_exponent.is_some() => STIFFEST,
            _ if leakage > 0.0 && self.any.observes => STIFFEST,
            Some((stiffness, damping)) => {
                ((leakage * stiffness.value() + damping.value()) * self.compliance.stiffened()).min(STIFFEST)
            }
            None if leakage > 0.0 => (1.0 / leakage).min(STIFFEST),
            None => 0.0,
        }
    }

    /// True where an effect advances with whole steps, so that mid-sample must end one.
    pub(super) fn whole_steps(&self) -> bool {
        self.mounted.iter().any(|m| m.hooks.after && m.hooks.velocity)
    }

    /// True where a step's equations are linear as long as the flow stays on one side of its limits.
    pub(super) fn is_linear(&self) -> bool {
        // A sensor behind lost motion follows it with a share that changes from step to step.
        let shared = self.whole_steps() && self.mounted.iter().any(|m| m.hooks.follow && m.hooks.velocity);
        self.mounted.iter().all(|m| m.hooks.linear) && self.compliance.is_linear() && !shared
    }

    /// Takes the command through what has memory, for a step of `h` seconds.
    pub(in crate::plant) fn begin_step(&mut self, state: &mut State<S>, h: f64) {
        if self.any.observes {
            state.spool = self.opened(state.command);
            self.observe(state);
        }
        let with = self.mounted.iter_mut().filter(|m| m.hooks.command);
        let spool = with.fold(state.command, |spool, m| m.effect.command(spool, h));
        state.spool = self.opened(spool);
    }

    /// What the valve makes of a command before any state of its own.
    #[inline]
    pub(in crate::plant) fn opened(&self, command: S) -> S {
        self.mounted.iter().filter(|m| m.opens).fold(command, |spool, m| m.effect.valve(spool, &[], &mut []))
    }

    /// Shows the motion to what changes with it from step to step.
    fn observe(&mut self, state: &State<S>) {
        let at = self.instant(state);
        for m in self.mounted.iter_mut().filter(|m| m.hooks.observes) {
            m.effect.observe(&at, state.command);
        }
        if let Some(leakage) = self.mounted.iter().find_map(|m| m.effect.leakage()) {
            self.compliance.leakage = Some(leakage);
        }
    }

    /// Advances the state by `h` seconds.
    pub(in crate::plant) fn advance(&mut self, state: &mut State<S>, h: f64) {
        self.integrate(state, h, false);
        self.settle(state);
    }

    /// Tells what has memory of the displacement that a step reached.
    pub(super) fn settle(&mut self, state: &State<S>) {
        for m in self.mounted.iter_mut().filter(|m| m.hooks.after) {
            m.effect.after(state.y[DISPLACEMENT], state.time);
        }
    }

    /// The classical fourth-order rule over `h` seconds; half way by its dense output.
    pub(super) fn integrate(&self, state: &mut State<S>, h: f64, middle: bool) {
        let n = self.used;
        let State { spool, time, y, work, .. } = state;
        let Work { k: [k1, k2, k3, k4], moved, start, later, demands } = work;
        let (t, opening) = (*time, self.opening(*spool));
        self.rates(t, &opening, y, k1, start);
        shifted(moved, y, k1, 0.5 * h);
        self.rates(t + 0.5 * h, &opening, moved, k2, later);
        demands[1] = later.demand;
        shifted(moved, y, k2, 0.5 * h);
        self.rates(t + 0.5 * h, &opening, moved, k3, later);
        demands[2] = later.demand;
        shifted(moved, y, k3, h);
        self.rates(t + h, &opening, moved, k4, later);
        (demands[0], demands[3]) = (start.demand, later.demand);
        let (k1, k2, k3, k4, y) = (&k1[..n], &k2[..n], &k3[..n], &k4[..n], &mut y[..n]);
        if middle {
            let moved = &mut moved[..n];
            for i in 0..n {
                moved[i] = y[i] + (k1[i] * 5.0 + (k2[i] + k3[i]) * 4.0 - k4[i]) * (h / 24.0);
            }
        }
        for i in 0..n {
            y[i] += (k1[i] + (k2[i] + k3[i]) * 2.0 + k4[i]) * (h / 6.0);
        }
        *time += h;
    }

    /// The velocity whose difference the accelerometer shows, and the table's own.
    #[inline]
    pub(super) fn velocities(&self, state: &State<S>) -> (S, S) {
        self.velocities_at(state.time, state.spool, &state.y)
    }

    /// The same at a time in the past, s, whose state was left in [`Work::moved`].
    #[inline]
    pub(super) fn velocities_halfway(&self, state: &State<S>, time: f64) -> (S, S) {
        self.velocities_at(time, state.spool, &state.work.moved)
    }

    #[inline(always)]
    fn velocities_at(&self, time: f64, spool: S, y: &[S]) -> (S, S) {
        let velocity = self.velocity_at(time, spool, y);
        let mut sensed = velocity;
        for m in self.mounted.iter().filter(|m| m.hooks.velocity) {
            sensed = m.effect.sense_velocity(sensed, &y[m.first..m.last]);
        }
        (sensed, velocity)
    }

    /// The motion at the start of a step, after the command's update; forces are left out.
    pub(super) fn instant(&self, state: &State<S>) -> Instant<S> {
        let mut at = state.work.start.at;
        self.note(state, &mut at);
        at
    }

    /// The same, written where a run keeps it: what is copied together is slow to copy again.
    #[inline]
    pub(super) fn note(&self, state: &State<S>, at: &mut Instant<S>) {
        (at.time, at.displacement) = (state.time, state.y[DISPLACEMENT]);
        (at.sensed_velocity, at.velocity) = self.velocities(state);
    }

    /// The force per table mass at this instant, m/s2.
    pub(super) fn force_now(&self, state: &mut State<S>) -> S {
        let State { spool, time, y, work, .. } = state;
        self.rates(*time, &self.opening(*spool), y, &mut work.k[0], &mut work.later);
        work.later.force
    }

    pub(in crate::plant) fn sense_displacement(&self, state: &State<S>) -> S {
        let mut shown = state.y[DISPLACEMENT];
        for m in self.mounted.iter().filter(|m| m.hooks.displacement) {
            shown = m.effect.sense_displacement(shown, &state.y[m.first..m.last]);
        }
        shown
    }

    pub(super) fn sense_acceleration(&self, mut mean: S, at: &Instant<S>) -> S {
        for m in self.mounted.iter().filter(|m| m.hooks.acceleration) {
            mean = m.effect.sense_acceleration(mean, at);
        }
        mean
    }

    pub(in crate::plant) fn supply_pressure(&self, state: &State<S>) -> Option<S> {
        self.mounted.iter().find_map(|m| m.effect.supply_pressure(&state.y[m.first..m.last]))
    }

    fn opening(&self, spool: S) -> Opening<S> {
        match self.baseline {
            Baseline::Servo { b1, .. } => Opening { spool, direct: b1 * spool, driven: self.lagged * spool },
            _ => Opening { spool, direct: S::from(0.0), driven: S::from(0.0) },
        }
    }

    /// Derivatives of every state into `dy`; the motion and the force they imply into `seen`.
    fn rates(&self, time: f64, opening: &Opening<S>, y: &[S], dy: &mut [S], seen: &mut EvaluatedState<S>) {
        let hooked;
        let mut opening = opening;
        if self.any.valve {
            let mut spool = opening.spool;
            for m in self.mounted.iter().filter(|m| m.hooks.valve) {
                spool = m.effect.valve(spool, &y[m.first..m.last], &mut dy[m.first..m.last]);
            }
            hooked = self.opening(spool);
            opening = &hooked;
        }
        let EvaluatedState { at, force, demand } = seen;
        (at.time, at.displacement, at.velocity) = (time, y[DISPLACEMENT], y[SPEED]);
        let flow = match self.baseline {
            Baseline::Servo { .. } => self.flow(at, y[SPEED] + opening.direct, y, demand),
            _ => y[SPEED],
        };
        at.velocity = if self.yields { y[TABLE] } else { flow };
        *force = S::from(0.0);
        for m in self.mounted.iter().filter(|m| m.hooks.force) {
            *force += m.effect.force(at, &y[m.first..m.last], &mut dy[m.first..m.last]);
        }
        at.sensed_velocity = at.velocity;
        for m in self.mounted.iter().filter(|m| m.hooks.follow || m.hooks.velocity) {
            m.effect.follow(at, &y[m.first..m.last], &mut dy[m.first..m.last]);
            at.sensed_velocity = m.effect.sense_velocity(at.sensed_velocity, &y[m.first..m.last]);
        }
        dy[DISPLACEMENT] = at.velocity;
        dy[SPEED] = match self.baseline {
            Baseline::Servo { a1, .. } => opening.driven - a1 * y[SPEED],
            Baseline::RigidMass { mass, viscous, gain } => (gain * opening.spool - viscous * y[SPEED]) / mass,
            Baseline::ForceBalance { .. } => S::from(0.0),
        };
        if self.any.force {
            dy[SPEED] -= *force;
        }
        if self.yields {
            self.yielding(flow, *force, y, dy);
        }
        if let Some(pace) = self.compliance.pace {
            for rate in dy {
                *rate = *rate * pace;
            }
        }
    }

    /// An acceleration of the table, m/s2, from a rate of change by the stated clock.
    #[inline]
    pub(super) fn by_true_clock(&self, rate: S) -> S {
        self.compliance.pace.map_or(rate, |pace| rate / pace)
    }

    /// The table's velocity at an instant, m/s.
    #[inline]
    fn velocity_at(&self, time: f64, spool: S, y: &[S]) -> S {
        if self.yields { y[TABLE] } else { self.flow_at(time, spool, y) }
    }

    /// The velocity that the flow alone would give at an instant, m/s.
    #[inline(always)]
    fn flow_at(&self, time: f64, spool: S, y: &[S]) -> S {
        let Baseline::Servo { b1, .. } = self.baseline else { return y[SPEED] };
        let spool = if self.any.valve { self.hooked(spool, y) } else { spool };
        let demand = y[SPEED] + b1 * spool;
        if self.any.flow { self.shaped_flow(time, demand, y) } else { self.plainly_limited(demand) }
    }

    /// The spool's position behind what hooks the valve.
    fn hooked(&self, mut spool: S, y: &[S]) -> S {
        let mut scratch = [S::from(0.0); STATES];
        for m in self.mounted.iter().filter(|m| m.hooks.valve) {
            spool = m.effect.valve(spool, &y[m.first..m.last], &mut scratch[m.first..m.last]);
        }
        spool
    }

    /// The flow for a demand where effects shape it, forces left out.
    fn shaped_flow(&self, time: f64, demand: S, y: &[S]) -> S {
        let at = Instant {
            time,
            displacement: y[DISPLACEMENT],
            velocity: y[SPEED],
            sensed_velocity: S::from(0.0),
            velocity_limit: self.velocity_limit,
        };
        self.flow(&at, demand, y, &mut 0.0)
    }

    /// A demand held at the velocity limit alone.
    #[inline(always)]
    fn plainly_limited(&self, demand: S) -> S {
        let limit = self.velocity_limit;
        self.limited(demand, (limit.value(), limit.value()), || limit, || limit)
    }

    /// The flow the valve lets through, as piston velocity, for the demand `w`.
    fn flow(&self, at: &Instant<S>, w: S, y: &[S], asked: &mut f64) -> S {
        if !self.any.flow {
            *asked = w.value();
            return self.plainly_limited(w);
        }
        let flow = self.shaped(at, y);
        let demand = w * flow.gain;
        *asked = demand.value();
        let (positive, negative) = (|| flow.positive * flow.limit, || flow.negative * flow.limit);
        match flow.sharpness {
            None => {
                let factor = flow.limit.value();
                let limits = (flow.positive.value() * factor, flow.negative.value() * factor);
                self.limited(demand, limits, positive, negative)
            }
            Some(n) if demand.value() >= 0.0 => soften(demand, positive(), n),
            Some(n) => -soften(-demand, negative(), n),
        }
    }

    fn shaped(&self, at: &Instant<S>, y: &[S]) -> Flow<S> {
        let (one, limit) = (S::from(1.0), self.velocity_limit);
        let mut flow = Flow { gain: one, limit: one, positive: limit, negative: limit, sharpness: None };
        for m in self.mounted.iter().filter(|m| m.hooks.flow) {
            m.effect.flow(at, &y[m.first..m.last], &mut flow);
        }
        flow
    }

    /// A demand held between its limits, whose derivatives are asked for only where they are reached.
    #[inline]
    fn limited(&self, demand: S, (high, low): (f64, f64), positive: impl Fn() -> S, negative: impl Fn() -> S) -> S {
        match self.forced {
            Some(Regime::Free) => demand,
            Some(Regime::Positive) => positive(),
            Some(Regime::Negative) => -negative(),
            None if demand.value() > high => positive(),
            None if demand.value() < -low => -negative(),
            None => demand,
        }
    }

    /// What the flow may be, m/s, at the start of a run: the lower and the upper limit; infinite for a rigid mass.
    pub(super) fn limits(&self, state: &State<S>) -> (f64, f64) {
        if !matches!(self.baseline, Baseline::Servo { .. }) {
            return (f64::NEG_INFINITY, f64::INFINITY);
        }
        let flow = self.shaped(&state.work.start.at, &state.y);
        (-(flow.negative * flow.limit).value(), (flow.positive * flow.limit).value())
    }

    /// The states from which velocities follow, and so those that are asked for half way.
    pub(super) fn behind_velocities(&self) -> Vec<usize> {
        let of = |wanted: fn(&Hooks) -> bool| {
            self.mounted.iter().filter(move |m| wanted(&m.hooks)).flat_map(|m| m.first..m.last)
        };
        let sensing = of(|hooks| hooks.velocity);
        if self.yields {
            sensing.chain([TABLE]).collect()
        } else if self.any.flow {
            (0..self.used).collect()
        } else {
            sensing.chain(of(|hooks| hooks.valve)).chain([SPEED]).collect()
        }
    }

    /// Velocity and load of an actuator that yields, driven by `flow`.
    fn yielding(&self, flow: S, force: S, y: &[S], dy: &mut [S]) {
        let (velocity, load) = (y[TABLE], y[LOAD]);
        if let Some((mut stiffness, mut damping)) = self.compliance.oil {
            if let Some(chambers) = &self.compliance.chambers {
                let stiffened = chambers.stiffened(y[DISPLACEMENT]);
                (stiffness, damping) = (stiffness * stiffened, damping * stiffened);
            }
            let available = self.compliance.stall_acceleration.map_or(flow, |stall| flow * drop(flow, load, stall));
            // Load goes fast where flow gives way to it: no faster than [`STIFFEST`], which leaves where it goes to.
            let leakage = self.compliance.leaks_under(load);
            let gives = self.compliance.stall_acceleration.map_or(leakage, |stall| leakage + flow.abs() / stall * 0.5);
            let rate = gives * stiffness + damping;
            let shown = (S::from(STIFFEST) / rate).min(S::from(1.0));
            dy[LOAD] = ((available - velocity - leakage * load) * stiffness - load * damping) * shown;
            dy[TABLE] = load - force;
            return;
        }
        // Stiff oil: the load follows from the flow balance, q sqrt(1 - p/p_s) - C p = v, and the table obeys v' = p - f.
        // Where the balance is stiffer, as with no flow it is without end, its time constant is held.
        let mut time_constant = self.compliance.leaks_to(flow - velocity);
        if let Some(stall) = self.compliance.stall_acceleration {
            let sum = flow.abs() + velocity.abs() + 1e-9;
            time_constant += flow * flow / (stall * sum);
        }
        let shortest = S::from(1.0 / STIFFEST);
        dy[LOAD] = S::from(0.0);
        dy[TABLE] = (flow - velocity) / time_constant.max(shortest) - force;
    }
}

/// `y + rate scale` into `moved`.
#[inline]
fn shifted<S: Scalar>(moved: &mut [S], y: &[S], rate: &[S], scale: f64) {
    let n = moved.len();
    let (y, rate) = (&y[..n], &rate[..n]);
    for i in 0..n {
        moved[i] = y[i] + rate[i] * scale;
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

/// An effect's parameters per table mass and in units of the command, as its equations take them; behind those of a user's
/// own, whose expression is in newtons, the mass.
fn per_mass<S: Scalar>(baseline: &Baseline<S>, placed: &EffectParameters<S>) -> Vec<S> {
    let (Baseline::RigidMass { mass, gain, .. }, Some(entry)) = (*baseline, entry(placed.id)) else {
        return placed.parameters.clone();
    };
    let convert = |(&value, parameter): (&S, &crate::plant::effects::Parameter)| match parameter.signal_scale {
        SignalScale::Force => value / mass,
        // A size of the command that a rigid mass states as a force.
        SignalScale::Command if parameter.rigid_unit != parameter.unit => value / gain,
        _ => value,
    };
    let own = crate::plant::effects::own::is_force(placed.id).then_some(mass);
    // Where an effect acts is no force.
    let region = placed.parameters.iter().skip(entry.parameters.len()).copied();
    placed.parameters.iter().zip(entry.parameters).map(convert).chain(region).chain(own).collect()
}
