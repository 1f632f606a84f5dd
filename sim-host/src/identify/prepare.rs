//! From an experiment as it was read to the model and runs a fit works on.

mod input;
mod start;
mod values;

use super::data::{Channel, Measured, Run};
use super::floor::{floors, least};
use super::model::{Model, ModelEffect, SignalScales, Value};
use crate::motion::filter::{Butterworth, Edge};
use crate::plant::effects::{Role, entry, regional};
use crate::plant::model::Kind;
use crate::plant::simulate::{MeasuredMotion, SimulatedLaw};
use crate::recording::bridge::bridged;
use crate::recording::check::Skew;
use crate::recording::{self, Experiment, Use};
use crate::scalar::earlier;
use input::{filled, shaping, with_pressure_feedback};
use values::{beforehand, own_value};

/// Why an experiment cannot be fitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PrepareError {
    /// No run may be fitted.
    #[error("{experiment}: no run has `use = \"fit\"`; give at least one")]
    NothingToFit {
        /// The experiment.
        experiment: String,
    },
    /// A channel that is compared holds no number.
    #[error("{run}: channel `{channel}` holds no finite sample; check its column")]
    EmptyChannel {
        /// The run.
        run: String,
        /// The channel.
        channel: &'static str,
    },
    /// The low-pass before the comparison.
    #[error("{run}: `bandwidth_hz`: {problem}")]
    Bandwidth {
        /// The run.
        run: String,
        /// What is wrong with it.
        problem: String,
    },
    /// A controller whose ticks do not fall on the samples.
    #[error(
        "{run}: `controller_rate_hz` is {controller:.4} Hz and the recording's rate {recording:.4} Hz; the first must be \
         a whole multiple of the second; resample the recording to the controller's rate"
    )]
    ControllerRate {
        /// The run.
        run: String,
        /// Rate of the controller, Hz.
        controller: f64,
        /// Rate of the recording, Hz.
        recording: f64,
    },
    /// The control core as a recording's controller.
    #[error("{run}: `controller = {{ core = ... }}` cannot be differentiated; state its plain gains as {{ kp, ki }}")]
    CoreController {
        /// The run.
        run: String,
    },
}

/// Own parameters of a recording rather than of its table: nobody states them.
const ALWAYS_FREE: [&str; 2] = ["scale", "lead"];

/// An experiment ready to be fitted and judged.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// The model as stated.
    pub model: Model,
    /// Runs parameters are fitted to.
    pub fit: Vec<Run>,
    /// Runs that only judge.
    pub holdout: Vec<Run>,
    /// Sizes of the signals on the runs that are fitted.
    pub signal_scales: SignalScales,
}

impl Prepared {
    /// The runs that judge a model: the hold-out runs, or those fitted where none was.
    pub fn judging(&self) -> &[Run] {
        if self.holdout.is_empty() { &self.fit } else { &self.holdout }
    }
}

/// Turns an experiment into what fits and diagnoses work on.
pub fn prepare(experiment: &Experiment) -> Result<Prepared, PrepareError> {
    let runs = |purpose| -> Result<Vec<Run>, PrepareError> {
        experiment.runs_for(purpose).map(|run| of_recording(run, &experiment.model, &experiment.runs)).collect()
    };
    let (fit, holdout) = (runs(Use::Fit)?, runs(Use::HoldOut)?);
    if fit.is_empty() {
        return Err(PrepareError::NothingToFit { experiment: experiment.name.clone() });
    }
    let stated = &experiment.model;
    let mass = match &stated.baseline {
        recording::Baseline::RigidMass(rigid) => rigid.mass,
        _ => 1.0,
    };
    let signal_scales = SignalScales::of(&fit, mass);
    Ok(Prepared { model: of_statement(stated, &fit, &signal_scales), fit, holdout, signal_scales })
}

fn of_statement(stated: &recording::Model, runs: &[Run], signal_scales: &SignalScales) -> Model {
    let kind = match stated.baseline {
        recording::Baseline::Servo(_) => Kind::Servo,
        recording::Baseline::RigidMass(_) => Kind::RigidMass,
        recording::Baseline::ForceBalance(_) => Kind::ForceBalance,
    };
    let known = stated.baseline.parameters();
    let has_pressure = runs.iter().any(|run| run.channel(Channel::PressureDifference).is_some());
    let own = kind.parameters().iter().map(|parameter| {
        let given = known.iter().find(|(name, _)| *name == parameter.key).map(|&(_, value)| value);
        let free = stated.fits(parameter.key) || ALWAYS_FREE.contains(&parameter.key);
        let value = own_value(given, parameter, free, signal_scales);
        beforehand(value, stated.accuracy.get(parameter.key))
    });
    let effects = stated.effects.iter().filter_map(|effect| {
        let entry = regional::stated(&effect.id, effect.parameters.keys().map(String::as_str))?;
        let mut placed = ModelEffect::start(entry, 0, signal_scales)?;
        for (parameter, value) in entry.parameters.iter().zip(&mut placed.values) {
            let given = effect.parameters.get(parameter.key);
            let free = stated.fits(&format!("{}.{}", effect.id, parameter.key))
                && (parameter.role == Role::Shared || (parameter.role == Role::Refined && given.is_some()));
            value.free = free;
            if let Some(&given) = given {
                // The library's bounds are those of a search; who states a value knows better, and it may move.
                let reach = if value.positive { [0.1 * given, 10.0 * given] } else { [given, given] };
                value.value = given;
                value.low = value.low.min(reach[0]);
                value.high = value.high.max(reach[1]);
                *value = beforehand(*value, stated.accuracy.get(&format!("{}.{}", effect.id, parameter.key)));
            }
        }
        Some(placed)
    });
    let scale = (has_pressure && kind != Kind::ForceBalance).then(|| pressure_scale(stated));
    let library = stated.own.iter().filter_map(|id| entry(id)).collect();
    let model = Model { kind, own: own.collect(), scale, effects: Vec::new(), library, clock_told: None };
    effects.fold(model, |model, effect| model.with(effect))
}

/// Pressure per acceleration: stated by mass and piston area, or free.
fn pressure_scale(stated: &recording::Model) -> Value {
    if let recording::Baseline::Servo(servo) = &stated.baseline
        && let (Some(mass), Some(area)) = (servo.mass, servo.piston_area)
    {
        return Value::fixed(mass / area);
    }
    Value { value: 1.0, low: f64::NEG_INFINITY, high: f64::INFINITY, positive: false, free: true, prior: None }
}

fn of_recording(run: &recording::Run, model: &recording::Model, all: &[recording::Run]) -> Result<Run, PrepareError> {
    use recording::{Channel as C, RecordedLaw as L};
    let law = match run.law {
        L::Open => SimulatedLaw::Recorded,
        L::ProportionalIntegral { kp, ki } => SimulatedLaw::Pi { kp, ki },
        L::Cascade { kp, kv } => SimulatedLaw::Cascade { kp, kv },
        L::Core { .. } => return Err(PrepareError::CoreController { run: run.name.clone() }),
    };
    let driver = if law.simulates_reference() { C::Reference } else { C::Command };
    let driver = if matches!(model.baseline, recording::Baseline::ForceBalance(_)) { C::Time } else { driver };
    let input = run.channel(driver).unwrap_or(&run.time).to_vec();
    let input =
        bridged(&input).ok_or_else(|| PrepareError::EmptyChannel { run: run.name.clone(), channel: driver.name() })?;
    let filter = model.bandwidth_hz.map(|corner| Butterworth::low_pass(4, corner).design(run.dt)).transpose();
    let filter = filter.map_err(|e| PrepareError::Bandwidth { run: run.name.clone(), problem: e.to_string() })?;
    let mut measured = measured(run, law, &model.baseline, &floors(run, all, filter.as_ref()))?;
    let balance = matches!(model.baseline, recording::Baseline::ForceBalance(_));
    let motion = balance.then(|| motion_of(run)).transpose()?;
    if let Some(filter) = &filter {
        for channel in &mut measured {
            let smooth = filter.zero_phase(&filled(&channel.values).unwrap_or_default(), Edge::Hold);
            let kept = |(value, smooth): (&f64, f64)| if value.is_finite() { smooth } else { f64::NAN };
            channel.values = channel.values.iter().zip(smooth).map(kept).collect();
        }
    }
    let ticks = ticks(run)?;
    // A recorded command that drives the model holds what was added to it.
    let added = run.channel(C::Disturbance).filter(|_| law.simulates_reference()).and_then(filled).unwrap_or_default();
    let added = with_pressure_feedback(added, run);
    let run = Run {
        name: run.name.clone(),
        dt: run.dt,
        from: run.time.first().copied().unwrap_or(0.0),
        elapsed: run.elapsed,
        ticks,
        input,
        added,
        sent_before: run.sent_before.clone(),
        law,
        shaping: shaping(run, ticks),
        loop_noise: run.loop_noise,
        moving_start: run.cut,
        measured,
        motion,
        filter,
    };
    Ok(Run { moving_start: run.moving_start || start::in_motion(&run), ..run })
}

/// Controller ticks in one sample.
fn ticks(run: &recording::Run) -> Result<usize, PrepareError> {
    let ratio = run.controller_rate_hz.map_or(1.0, |rate| rate * run.dt);
    if (ratio - ratio.round().max(1.0)).abs() > 0.02 * ratio {
        let (controller, recording) = (ratio / run.dt, 1.0 / run.dt);
        return Err(PrepareError::ControllerRate { run: run.name.clone(), controller, recording });
    }
    Ok(ratio.round() as usize)
}

/// The measured motion that drives a force balance: what is not measured follows from what is, and an acceleration that
/// comes later than the displacement's is moved back to it.
fn motion_of(run: &recording::Run) -> Result<MeasuredMotion, PrepareError> {
    use recording::Channel as C;
    let of = |channel| run.channel(channel).and_then(filled);
    let missing = || PrepareError::EmptyChannel { run: run.name.clone(), channel: "displacement" };
    let slope = |series: &[f64]| -> Vec<f64> {
        let n = series.len();
        let at = |k: usize| (series[(k + 1).min(n - 1)] - series[k.saturating_sub(1)]) / (2.0 * run.dt);
        (0..n).map(at).collect()
    };
    let displacement = of(C::Displacement).ok_or_else(missing)?;
    let velocity = of(C::Velocity).unwrap_or_else(|| slope(&displacement));
    let late = Skew::of(run).filter(|skew| skew.matters(run.dt) && skew.is_delay()).map_or(0.0, |skew| skew.delay_s);
    let acceleration = of(C::Acceleration).map_or_else(|| slope(&velocity), |a| earlier(&a, late / run.dt));
    Ok(MeasuredMotion { displacement, velocity, acceleration })
}

/// The channels a run is compared with. A channel is judged where its noise is known. Where neither displacement nor acceleration
/// states it, both are judged by the noise that is estimated; of a rigid mass the controller's effort is, which is the force in its
/// own balance: what that balance lacks is far more than any sensor's noise, and feedback hides it from the position.
fn measured(
    run: &recording::Run,
    law: SimulatedLaw,
    baseline: &recording::Baseline,
    floors: &recording::PerChannel<f64>,
) -> Result<Vec<Measured>, PrepareError> {
    use recording::Channel as C;
    let stated = |channel| run.noise.get(channel).is_some();
    let motion_known = stated(C::Displacement) || stated(C::Acceleration);
    let speed_alone = run.channel(C::Displacement).is_none() && run.channel(C::Acceleration).is_none();
    let balance = matches!(baseline, recording::Baseline::ForceBalance(_));
    let rigid = matches!(baseline, recording::Baseline::RigidMass(_));
    let effort = rigid && !motion_known && law.simulates_reference() && run.channel(C::Command).is_some();
    let mut all = Vec::new();
    for channel in Channel::ALL {
        let source = channel.recorded();
        let Some(values) = run.channel(source) else { continue };
        if !values.iter().any(|v| v.is_finite()) {
            return Err(PrepareError::EmptyChannel { run: run.name.clone(), channel: source.name() });
        }
        let start = if channel == Channel::SupplyPressure { mean_of_start(values) } else { 1.0 };
        let values: Vec<f64> = values.iter().map(|v| v / start).collect();
        let noise = run.noise.get(source).map(|n| n / start.abs()).filter(|n| *n > 0.0);
        let judged = match channel {
            _ if balance => channel == Channel::PressureDifference,
            Channel::Command => effort,
            // Feedback hides a mismatch from the position, not from the acceleration.
            Channel::Acceleration => noise.is_some() || !motion_known,
            Channel::Displacement => !effort && (noise.is_some() || !motion_known),
            Channel::Velocity => !effort && (noise.is_some() || speed_alone),
            Channel::PressureDifference | Channel::SupplyPressure => !effort,
        };
        let stated = noise;
        let noise = noise.or(floors.get(source).map(|floor| floor / start.abs())).unwrap_or_else(|| least(&values));
        all.push(Measured { channel, values, noise, stated, judged });
    }
    Ok(all)
}

/// Mean of the first samples, taken at rest.
fn mean_of_start(values: &[f64]) -> f64 {
    let first: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).take(16).collect();
    first.iter().sum::<f64>() / first.len().max(1) as f64
}
