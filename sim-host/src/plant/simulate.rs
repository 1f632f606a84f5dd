//! Runs a model with any effects through an experiment, in closed loop from the reference.
//!
//! The conventions are those of recordings: displacement and reference are sampled at t_k, the controller runs then,
//! its command acts from t_k to t_k+1; `acceleration[k]` is the mean over the sample around t_k; `velocity[k]` is taken
//! after the command's update. Between samples a fourth-order Runge-Kutta rule takes steps of at most [`LONGEST_STEP`];
//! what has memory and corners (delay, rate limit, play) advances once a step, exactly for a held command.

mod dynamics;
mod law;

use super::effects::{Instant, build, entry};
use super::model::Baseline;
use crate::scalar::Scalar;
use dynamics::{Dynamics, STATES, State};
pub use law::Law;

/// Longest integration step, s.
pub const LONGEST_STEP: f64 = 1.3e-3;

/// What drives a simulated run.
#[derive(Debug, Clone, Copy)]
pub struct Drive<'a> {
    /// Sampling period, s.
    pub dt: f64,
    /// Controller ticks in one sample.
    pub ticks: usize,
    /// Reference displacement at each sample, m; the command itself where the law is [`Law::Recorded`].
    pub input: &'a [f64],
    /// Measured command increments added to what the controller sends, one for each sample; empty for none.
    pub added: &'a [f64],
    /// The controller that ran.
    pub law: Law,
}

/// How a run starts.
#[derive(Debug, Clone, Copy)]
pub struct Start<S> {
    /// Displacement of the table, m.
    pub displacement: S,
    /// Velocity, m/s: the state z of a servo, which is at rest with it at zero.
    pub velocity: S,
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
pub struct Placed<S> {
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
    effects: &[Placed<S>],
    drive: &Drive,
    start: &Start<S>,
) -> Result<Trace<S>, SimulateError> {
    let mut dynamics = Dynamics::new(baseline, effects)?;
    let mut state = dynamics.rest(start);
    let n = drive.input.len();
    let mut trace = Trace::with_capacity(n);
    let mut law = drive.law.begin::<S>(drive.dt / drive.ticks as f64);
    let steps = substeps(drive.dt / drive.ticks as f64, drive.ticks);
    let h = drive.dt / (drive.ticks * steps) as f64;
    let total = drive.ticks * steps;
    let (mut mid_before, mut true_before) = dynamics.velocities(&state);
    for k in 0..n {
        let mut after_update = None;
        let mut mid = (mid_before, true_before);
        for step in 0..total {
            if step % steps == 0 {
                let share = (step / steps) as f64 / drive.ticks as f64;
                let (now, next) = (drive.input[k], drive.input.get(k + 1).copied().unwrap_or(drive.input[k]));
                let measured = dynamics.sense_displacement(&state);
                let added = drive.added.get(k).copied().unwrap_or(0.0);
                let command = law.step(now + (next - now) * drive.law.between_samples() * share, measured);
                state.command = command + added;
                if step == 0 {
                    trace.displacement.push(measured);
                    trace.command.push(command);
                }
            }
            dynamics.begin_step(&mut state, h);
            if step == 0 {
                after_update = Some((dynamics.motion(&state), dynamics.friction(&state)));
            }
            dynamics.advance(&mut state, h);
            if 2 * (step + 1) == total {
                mid = dynamics.velocities(&state);
            }
        }
        let Some((motion, force)) = after_update else { break };
        let mean = (mid.0 - mid_before) / drive.dt;
        trace.velocity.push(motion.velocity);
        trace.acceleration.push(dynamics.sense_acceleration(mean, &motion));
        trace.load.push((mid.1 - true_before) / drive.dt + force);
        if let Some(pressure) = dynamics.supply_pressure(&state) {
            trace.supply.push(pressure);
        }
        (mid_before, true_before) = mid;
    }
    Ok(trace)
}

/// An even number of integration steps a tick where there is one tick a sample, so that a step ends at mid-sample.
fn substeps(tick: f64, ticks: usize) -> usize {
    let steps = ((tick / LONGEST_STEP) - 1e-9).ceil().max(1.0) as usize;
    if ticks % 2 == 0 { steps } else { steps.next_multiple_of(2) }
}

impl<S> Trace<S> {
    fn with_capacity(n: usize) -> Self {
        let empty = || Vec::with_capacity(n);
        Self {
            displacement: empty(),
            velocity: empty(),
            acceleration: empty(),
            command: empty(),
            load: empty(),
            supply: Vec::new(),
        }
    }
}
