//! Residuals of a model on a run, and their sensitivities to every free parameter.

mod sums;
mod wide;

use super::data::{Channel, Measured, Run};
use super::model::{Model, Value};
use super::normal::Normal;
use crate::motion::filter::{Cascade, Edge};
use crate::plant::effects::Role;
use crate::plant::model::Baseline;
use crate::plant::simulate::{
    EffectParameters, Excitation, SimulateError, Start, Trace, Wanted, balance, effect_states, simulate,
};
use crate::scalar::{Dual, Scalar, earlier};
pub(super) use sums::Rows;
use sums::Sums;
pub(crate) use sums::compared_samples;

/// Length of the blocks over which residuals count as alike, s.
pub(crate) const BLOCK: f64 = 1.0;

/// Parameters that belong to one run: where it starts, sensors' offsets, the phases of periodic effects.
#[derive(Debug, Clone, PartialEq)]
pub struct Local {
    /// Displacement at the start, m.
    pub displacement: Value,
    /// Velocity at the start, m/s.
    pub velocity: Value,
    /// Offset of the pressure difference, in its unit.
    pub pressure: Value,
    /// Values of `PerRun`, in the order of the model's effects.
    pub effects: Vec<Value>,
    /// By how much the effects' continuous states differ from rest at the start, where a run starts in motion.
    pub states: Vec<Value>,
}

impl Local {
    /// A run's local parameters before any fit.
    pub fn start(model: &Model, run: &Run) -> Self {
        let first = |channel| run.channel(channel).and_then(|m| m.values.iter().copied().find(|x| x.is_finite()));
        let reference = if run.law.simulates_reference() { run.input.first().copied() } else { None };
        let shown = first(Channel::Displacement);
        let at = if run.moving_start { shown.or(reference) } else { reference.or(shown) }.unwrap_or(0.0);
        let reach = run.channel(Channel::Displacement).map_or(1e-3, |m| 50.0 * m.noise + 1e-9);
        let free = |value: f64, reach: f64, free| Value {
            value,
            low: value - reach,
            high: value + reach,
            positive: false,
            free,
            prior: None,
        };
        let slope = run.moving_start.then(|| initial_slope(run)).flatten().unwrap_or(0.0);
        let has_pressure = run.channel(Channel::PressureDifference).is_some_and(|m| m.judged);
        let per_run = |p: &super::model::ModelEffect| {
            p.entry
                .parameters
                .iter()
                .zip(&p.values)
                .filter(|(q, _)| q.role == Role::PerRun)
                .map(|(_, v)| Value { free: true, ..*v })
                .collect::<Vec<_>>()
        };
        Self {
            displacement: free(at, reach.max(1e-4), run.motion.is_none()),
            velocity: free(slope, 1.0, run.moving_start && run.motion.is_none()),
            pressure: free(0.0, f64::INFINITY, has_pressure),
            effects: model.effects.iter().flat_map(per_run).collect(),
            states: if run.moving_start { vec![free(0.0, 10.0, true); states_of(model)] } else { Vec::new() },
        }
    }

    /// Every value, in a fixed order.
    pub fn values(&self) -> impl Iterator<Item = &Value> {
        [&self.displacement, &self.velocity, &self.pressure].into_iter().chain(&self.effects).chain(&self.states)
    }

    /// The same, to change.
    pub fn values_mut(&mut self) -> impl Iterator<Item = &mut Value> {
        let start = [&mut self.displacement, &mut self.velocity, &mut self.pressure];
        start.into_iter().chain(&mut self.effects).chain(&mut self.states)
    }
}

/// Continuous states of a model's effects.
fn states_of(model: &Model) -> usize {
    effect_states(model.placements())
}

/// Slope of the measured displacement at the start, m/s.
fn initial_slope(run: &Run) -> Option<f64> {
    let x = &run.channel(Channel::Displacement)?.values;
    let span = 4.min(x.len().checked_sub(1)?);
    Some((x[span] - x[0]) / (span as f64 * run.dt)).filter(|s| s.is_finite())
}

/// What a run shows under a model, without sensitivities.
#[derive(Debug, Clone)]
pub struct Predicted {
    /// One series a measured channel, in the order of [`Run::measured`].
    pub channels: Vec<Vec<f64>>,
    /// The table's displacement at each sample, m, whether or not it was measured: the prescribed one where a run prescribes it.
    pub displacement: Vec<f64>,
}

/// Simulates a run and gives the prediction of each of its channels.
pub fn predict(model: &Model, run: &Run, local: &Local) -> Result<Predicted, SimulateError> {
    let (trace, scale, offset) = trace::<f64>(model, run, local, wanted(run, |_| true), |value| value.value)?;
    let channels = run
        .measured
        .iter()
        .map(|m| (0..run.len()).map(|k| shown(&trace, m.channel, k, scale, offset).unwrap_or(f64::NAN)).collect());
    let channels = channels.collect();
    let displacement = run.motion.as_ref().map_or(trace.displacement, |motion| motion.displacement.clone());
    Ok(Predicted { channels, displacement })
}

/// What a comparison with the channels that `counted` lets through asks of a simulation.
fn wanted(run: &Run, counted: impl Fn(&Measured) -> bool) -> Wanted {
    let any = |channel| run.measured.iter().any(|m| m.channel == channel && counted(m));
    Wanted {
        velocity: any(Channel::Velocity),
        acceleration: any(Channel::Acceleration),
        command: any(Channel::Command),
        load: any(Channel::PressureDifference),
    }
}

/// The trace of a run with every value turned into a scalar by `lift`, in the order shared, then local.
fn trace<S: Scalar>(
    model: &Model,
    run: &Run,
    local: &Local,
    wanted: Wanted,
    mut lift: impl FnMut(&Value) -> S,
) -> Result<(Trace<S>, S, S), SimulateError> {
    let own: Vec<S> = model.own.iter().map(&mut lift).collect();
    let scale = model.scale.as_ref().map(&mut lift);
    let mut effects: Vec<EffectParameters<S>> = model
        .effects
        .iter()
        .map(|p| EffectParameters { id: p.entry.id, parameters: p.values.iter().map(&mut lift).collect() })
        .collect();
    let (displacement, velocity, offset) = (lift(&local.displacement), lift(&local.velocity), lift(&local.pressure));
    let per_run: Vec<S> = local.effects.iter().map(&mut lift).collect();
    let start =
        Start { displacement, velocity, states: local.states.iter().map(&mut lift).collect(), time: run.elapsed };
    let mut per_run = per_run.into_iter();
    for (placed, effect) in effects.iter_mut().zip(&model.effects) {
        for (parameter, slot) in effect.entry.parameters.iter().zip(&mut placed.parameters) {
            if parameter.role == Role::PerRun
                && let Some(value) = per_run.next()
            {
                *slot = value;
            }
        }
    }
    let baseline = Baseline::new(model.kind, &own).ok_or(SimulateError::NoLoop)?;
    if let Baseline::ForceBalance { scale, viscous, lead } = baseline {
        let motion = run.motion.as_ref().ok_or(SimulateError::NoLoop)?;
        let trace = balance(viscous, &effects, motion, run.dt, &start)?;
        let trace = filtered(trace, run.filter.as_ref());
        let load = earlier(&trace.load, lead / run.dt);
        return Ok((Trace { load, ..trace }, scale, offset));
    }
    let shown = || run.channel(Channel::Displacement).map_or(0.0, |m| m.noise);
    let sensor_noise = run.loop_noise.unwrap_or_else(shown);
    let drive = Excitation {
        dt: run.dt,
        ticks: run.ticks,
        input: &run.input,
        added: &run.added,
        before: run.moving_start.then_some(&run.sent_before),
        law: run.law,
        shaping: run.shaping,
        sensor_noise,
        wanted,
    };
    let trace = simulate(&baseline, &effects, &drive, &start)?;
    Ok((filtered(trace, run.filter.as_ref()), scale.unwrap_or(S::from(1.0)), offset))
}

/// Low-passes every channel, derivatives with it: the filter is linear.
fn filtered<S: Scalar>(mut trace: Trace<S>, filter: Option<&Cascade>) -> Trace<S> {
    let Some(filter) = filter else { return trace };
    for series in
        [&mut trace.displacement, &mut trace.velocity, &mut trace.acceleration, &mut trace.command, &mut trace.load]
    {
        let pass = |i: usize| filter.zero_phase(&series.iter().map(|s| s.part(i)).collect::<Vec<_>>(), Edge::Hold);
        let parts: Vec<Vec<f64>> = (0..S::PARTS).map(pass).collect();
        *series = (0..series.len()).map(|k| S::from_parts(|i| parts[i][k])).collect();
    }
    trace
}

/// What one channel shows at one sample.
fn shown<S: Scalar>(trace: &Trace<S>, channel: Channel, k: usize, scale: S, offset: S) -> Option<S> {
    match channel {
        Channel::Displacement => trace.displacement.get(k).copied(),
        Channel::Acceleration => trace.acceleration.get(k).copied(),
        Channel::Velocity => trace.velocity.get(k).copied(),
        Channel::Command => trace.command.get(k).copied(),
        Channel::SupplyPressure if trace.displacement.is_empty() => None,
        Channel::PressureDifference => trace.load.get(k).map(|&load| load * scale + offset),
        Channel::SupplyPressure => Some(trace.supply.get(k).copied().unwrap_or(S::from(1.0))),
    }
}

/// Residuals of a run in units of noise, measured less simulated, channel by channel; what was not measured is left out.
pub(super) fn residuals(model: &Model, run: &Run, local: &Local) -> Result<Vec<f64>, SimulateError> {
    let (trace, scale, offset) = trace::<f64>(model, run, local, wanted(run, |m| m.judged), |value| value.value)?;
    let mut residuals = Vec::new();
    compared(run, &trace, scale, offset, |_, measured, inverse, model| {
        residuals.extend((!measured.is_nan()).then_some((measured - model) * inverse));
    });
    Ok(residuals)
}

/// Hands on, channel by channel, every sample that is compared: its number, what was measured, one over its noise and
/// what the model shows.
fn compared<S: Scalar>(run: &Run, trace: &Trace<S>, scale: S, offset: S, mut sample: impl FnMut(usize, f64, f64, S)) {
    // In the middle of a motion the first sample says where it starts, and nothing else.
    let from = usize::from(run.moving_start);
    for measured in run.measured.iter().filter(|m| m.judged) {
        let inverse = 1.0 / measured.noise;
        for (k, &value) in measured.values.iter().enumerate().take(run.len()).skip(from) {
            if let Some(model) = shown(trace, measured.channel, k, scale, offset) {
                sample(k, value, inverse, model);
            }
        }
    }
}

/// The normal equations of one run, its free shared parameters first, then its free local ones; the rows themselves where
/// they are asked for.
pub(super) fn normal(
    model: &Model,
    run: &Run,
    local: &Local,
    keep: Option<&mut Rows>,
) -> Result<Normal, SimulateError> {
    let count = model.values().chain(local.values()).filter(|v| v.free).count();
    // By the four: see [`Dual`]. A build for tests has two widths, which give the same: each compiles the plant anew.
    match count {
        #[cfg(not(debug_assertions))]
        0..=4 => normal_of::<4>(model, run, local, count, keep),
        0..=8 => normal_of::<8>(model, run, local, count, keep),
        #[cfg(not(debug_assertions))]
        9..=12 => normal_of::<12>(model, run, local, count, keep),
        9..=16 => normal_of::<16>(model, run, local, count, keep),
        #[cfg(not(debug_assertions))]
        17..=wide::WIDEST => normal_of::<{ wide::WIDEST }>(model, run, local, count, keep),
        _ => wide::normal(model, run, local, count, keep),
    }
}

/// Samples of a stretch over which residuals count as alike.
fn stretch_length(run: &Run) -> usize {
    ((BLOCK / run.dt).round() as usize).max(1)
}

fn normal_of<const N: usize>(
    model: &Model,
    run: &Run,
    local: &Local,
    count: usize,
    mut keep: Option<&mut Rows>,
) -> Result<Normal, SimulateError> {
    let (trace, scale, offset) = tangents::<N>(model, run, local, 0)?;
    let mut sum = Sums::<N>::new(count, stretch_length(run), run.len());
    compared(run, &trace, scale, offset, |k, measured, inverse, model| {
        sum.row(k, (measured, inverse), &model, keep.as_deref_mut());
    });
    Ok(sum.finish())
}

/// The trace with the derivatives by `N` of the free parameters from the `first` on.
fn tangents<const N: usize>(
    model: &Model,
    run: &Run,
    local: &Local,
    first: usize,
) -> Result<(Trace<Dual<N>>, Dual<N>, Dual<N>), SimulateError> {
    let mut next = 0_usize;
    let lift = |value: &Value| {
        let mut dual = Dual::<N>::from(value.value);
        if value.free {
            if let Some(slot) = next.checked_sub(first).and_then(|place| dual.tangent.get_mut(place)) {
                *slot = value.slope() as f32;
            }
            next += 1;
        }
        dual
    };
    trace(model, run, local, wanted(run, |m| m.judged), lift)
}

#[cfg(test)]
mod tests;
