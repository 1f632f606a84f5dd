//! Runs a model with any effects through an experiment, in closed loop from the reference.
//!
//! The conventions are those of recordings: displacement and reference are sampled at t_k, the controller runs then,
//! its command acts from t_k to t_k+1; `acceleration[k]` is the mean over the sample around t_k; `velocity[k]` is taken
//! after the command's update. Between samples a fourth-order Runge-Kutta rule takes steps of at most [`LONGEST_STEP`];
//! what has memory and corners (delay, rate limit, play) advances once a step, exactly for a held command.

mod balance;
pub(super) mod dynamics;
mod law;
mod linear;
mod sample;

use super::effects::{Instant, STATES, build, entry};
use super::model::Baseline;
use crate::scalar::Scalar;
pub(crate) use balance::{MeasuredMotion, balance};
use dynamics::Dynamics;
pub(crate) use law::NotchFilter;
pub use law::{Notch, Shaping, SimulatedLaw};
use sample::Sample;

/// Longest integration step, s.
pub(crate) const LONGEST_STEP: f64 = 2.6e-3;

/// Largest product of a step and the fastest rate: the rule is stable up to 2.8 and accurate well below.
pub(super) const RESOLVED: f64 = 1.2;

/// Largest product of a step and the rate at which a load gives way.
const STABLE: f64 = 2.4;

/// Most integration steps in a controller tick for accuracy alone.
pub(super) const MOST_STEPS: f64 = 12.0;

/// What drives a simulated run.
#[derive(Debug, Clone, Copy)]
pub struct Excitation<'a> {
    /// Sampling period, s.
    pub dt: f64,
    /// Controller ticks in one sample.
    pub ticks: usize,
    /// Reference displacement at each sample, m; the command itself where the law is [`SimulatedLaw::Recorded`].
    pub input: &'a [f64],
    /// Known increments added to what the controller sends, one for each sample; empty for none. The command that a
    /// trace shows holds them, as the recorded one does.
    pub added: &'a [f64],
    /// What was sent before, where the run begins in the middle of a motion, one for each sample; nothing where that is not known. None
    /// for a run that begins at rest.
    pub before: Option<&'a [f64]>,
    /// The controller that ran.
    pub law: SimulatedLaw,
    /// What surrounds it.
    pub shaping: Shaping,
    /// Standard deviation of the displacement sensor's noise, m, which the controller passes on to the command.
    pub sensor_noise: f64,
    /// What of it is asked for.
    pub wanted: Wanted,
}

/// The series of a `Trace` that are filled beside displacement and supply pressure; the others stay empty.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Wanted {
    /// `Trace::velocity`.
    pub velocity: bool,
    /// `Trace::acceleration`.
    pub acceleration: bool,
    /// `Trace::command`.
    pub command: bool,
    /// `Trace::load`.
    pub load: bool,
}

impl Wanted {
    /// All of them.
    pub const ALL: Self = Self { velocity: true, acceleration: true, command: true, load: true };
}

/// How a run starts.
#[derive(Debug, Clone)]
pub struct Start<S> {
    /// Displacement of the table, m.
    pub displacement: S,
    /// Velocity, m/s: the state z of a servo, which is at rest with it at zero.
    pub velocity: S,
    /// By how much the effects' continuous states differ from rest, in the order of the effects; empty for rest.
    pub states: Vec<S>,
    /// How long the table was at work before, s: oil is warm by then.
    pub time: f64,
}

/// Continuous states of these effects together.
pub(crate) fn effect_states<'a>(effects: impl Iterator<Item = (&'a str, Vec<f64>)>) -> usize {
    effects.map(|(id, parameters)| build(id, &parameters).map_or(0, |effect| effect.states())).sum()
}

/// What a simulated run shows, one value a sample.
#[derive(Debug, Clone, Default)]
pub struct Trace<S> {
    /// Displacement sensor, m.
    pub displacement: Vec<S>,
    /// Velocity, m/s.
    pub velocity: Vec<S>,
    /// Accelerometer, m/s2.
    pub acceleration: Vec<S>,
    /// Command, in its unit.
    pub command: Vec<S>,
    /// Load pressure over piston area and table mass: `x'' + f`, m/s2.
    pub load: Vec<S>,
    /// Supply pressure relative to its start, 1; empty where no effect governs it.
    pub supply: Vec<S>,
}

/// An effect of a model, with its parameters.
#[derive(Debug, Clone)]
pub struct EffectParameters<S> {
    /// Its identifier.
    pub id: &'static str,
    /// Parameters in the order of its entry.
    pub parameters: Vec<S>,
}

/// Why a model cannot be simulated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulateError {
    /// No such effect, or not this many parameters.
    #[error("effect `{id}` with {count} parameters is not in the library")]
    UnknownEffect {
        /// The identifier given.
        id: String,
        /// How many parameters were given.
        count: usize,
    },
    /// More continuous states than are provided for.
    #[error("the effects of this model have {states} states, more than {STATES}")]
    TooManyStates {
        /// How many there are.
        states: usize,
    },
    /// A force balance is driven by measured motion, not simulated in closed loop.
    #[error("a force balance has no closed loop to simulate")]
    NoLoop,
}

/// Simulates one run.
pub fn simulate<S: Scalar>(
    baseline: &Baseline<S>,
    effects: &[EffectParameters<S>],
    drive: &Excitation,
    start: &Start<S>,
) -> Result<Trace<S>, SimulateError> {
    Ok(run(Dynamics::new(baseline, effects)?, drive, start, true))
}

/// Runs a plant; `matrices` lets linear stretches be taken by [`linear`], which changes no more than rounding.
fn run<S: Scalar>(mut dynamics: Dynamics<S>, drive: &Excitation, start: &Start<S>, matrices: bool) -> Trace<S> {
    dynamics.shake(&drive.law.noise(drive.sensor_noise, drive.dt / drive.ticks as f64));
    let mut state = dynamics.rest(start);
    let (n, wanted) = (drive.input.len(), drive.wanted);
    let mut trace = Trace::with_capacity(n, wanted);
    let mut law = drive.law.begin::<S>(drive, start.velocity);
    let steps = substeps(drive, (dynamics.fastest(), dynamics.stiffest()), dynamics.whole_steps());
    let governed = dynamics.supply_pressure(&state).is_some();
    let mut sample = Sample::new(&mut dynamics, &state, drive, steps, matrices);
    for k in 0..n {
        let next = drive.input.get(k + 1).copied().unwrap_or(drive.input[k]);
        for tick in 0..drive.ticks {
            let share = if tick == 0 { 0.0 } else { tick as f64 / drive.ticks as f64 * drive.law.between_samples() };
            let measured = dynamics.sense_displacement(&state);
            let command = law.step(drive.input[k] + (next - drive.input[k]) * share, measured);
            state.command = command + drive.added.get(k).copied().unwrap_or(0.0);
            if let Some(before) = drive.before.filter(|_| (k, tick) == (0, 0)) {
                dynamics.under_way(before, state.command, steps * drive.ticks, drive.dt / (drive.ticks * steps) as f64);
            }
            if tick == 0 {
                trace.displacement.push(measured);
            }
            if tick == 0 && wanted.command {
                trace.command.push(state.command);
            }
            sample.tick(&mut dynamics, &mut state, tick);
        }
        sample.push(&dynamics, wanted, drive.dt, &mut trace);
        state.settle_derivatives();
        if governed && let Some(pressure) = dynamics.supply_pressure(&state) {
            trace.supply.push(pressure);
        }
    }
    trace
}

/// Integration steps in one controller tick: no longer than [`LONGEST_STEP`], short enough for the fastest equation up to
/// [`MOST_STEPS`], in any case short enough to be stable, and even in number where an effect advances with whole steps.
fn substeps(drive: &Excitation, (fastest, stiffest): (f64, f64), whole: bool) -> usize {
    let tick = drive.dt / drive.ticks as f64;
    let longest = LONGEST_STEP.min(RESOLVED / fastest.max(1e-9));
    let steps = ((tick / longest) - 1e-9).ceil().clamp(1.0, MOST_STEPS).max((tick * stiffest / STABLE).ceil()) as usize;
    if whole && drive.ticks % 2 == 1 { steps.next_multiple_of(2) } else { steps }
}

impl<S> Trace<S> {
    fn with_capacity(n: usize, wanted: Wanted) -> Self {
        let empty = |wanted: bool| Vec::with_capacity(if wanted { n } else { 0 });
        Self {
            displacement: empty(true),
            velocity: empty(wanted.velocity),
            acceleration: empty(wanted.acceleration),
            command: empty(wanted.command),
            load: empty(wanted.load),
            supply: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests;
