//! The core's online modifiers, run over a record as the device would run them.

use super::{FitError, Fitted, Limits, Reference};
use shakedown_core::SettingsError;
use shakedown_core::blocks::record::{self, causal, clip, preview};
use shakedown_core::settings::{PREVIEW_PLACES, PREVIEW_WINDOW};

/// An online modifier by name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Modifier {
    /// The paper's Eq. 10.
    Clip,
    /// Drift-free, with no preview.
    Causal,
    /// With a buffer of this many seconds.
    Preview(f64),
}

/// Runs a modifier in the core's own arithmetic over a reference, the velocity limit in force being the configured one.
pub fn fit(reference: &Reference, limits: &Limits, modifier: Modifier) -> Result<Fitted, FitError> {
    fit_with(reference, limits, modifier, |_| limits.velocity)
}

/// As [`fit`], with the velocity limit in force, m/s, at each sample.
pub fn fit_with(
    reference: &Reference,
    limits: &Limits,
    modifier: Modifier,
    limit_now: impl Fn(usize) -> f64,
) -> Result<Fitted, FitError> {
    limits.check(reference)?;
    let stroke = limits.stroke.unwrap_or(10.0);
    let table = record::ReferenceLimits::new((1.0 / reference.dt) as f32, limits.velocity as f32, stroke as f32);
    let start = reference.start as f32;
    let velocity = match modifier {
        Modifier::Clip => {
            let config = clip::Config::new(&table).map_err(|e| refusal(&e))?;
            let mut state = clip::State::at(start);
            run(reference, 0, limit_now, |x, v| clip::step(&config, &mut state, x, v))
        }
        Modifier::Causal => {
            let config = causal::Config::new(&table, &causal::Config::DRIFT_RECOVERY, causal::Config::MEMORY)
                .map_err(|e| refusal(&e))?;
            let mut state = causal::State::at(start);
            run(reference, 0, limit_now, |x, v| causal::step(&config, &mut state, x, v))
        }
        Modifier::Preview(seconds) => {
            let config =
                preview::Config::new::<PREVIEW_WINDOW>(&table, &preview::Config::DRIFT_RECOVERY, seconds as f32)
                    .map_err(|e| refusal(&e))?;
            let mut state = preview::State::<PREVIEW_WINDOW, PREVIEW_PLACES>::at(start);
            run(reference, config.delay() as usize, limit_now, |x, v| preview::step(&config, &mut state, x, v))
        }
    };
    Ok(Fitted { velocity, bound: None })
}

/// What the core refused, in words.
fn refusal(error: &SettingsError) -> FitError {
    FitError::Online(match error {
        SettingsError::OutOfRange { field, value, low, high } => {
            format!("{field} = {value}: it has to lie between {low} and {high}")
        }
        other => format!("{other:?}"),
    })
}

/// Feeds the reference's displacement, then rests at its end until all of it has come out `delay` ticks late.
///
/// The modifiers know displacements and take backward differences, so they are given the displacement whose backward
/// differences are the reference's velocity, and their output is read the same way.
fn run(
    reference: &Reference,
    delay: usize,
    limit_now: impl Fn(usize) -> f64,
    mut step: impl FnMut(f32, f32) -> f32,
) -> Vec<f64> {
    let last = reference.len() - 1;
    let mut asked = reference.start;
    let mut before = f64::from(asked as f32);
    let mut velocity = Vec::with_capacity(reference.len());
    for k in 0..=last + delay {
        if let Some(v) = reference.velocity.get(k) {
            asked += v * reference.dt;
        }
        let y = f64::from(step(asked as f32, limit_now(k.min(last)) as f32));
        if k >= delay {
            velocity.push((y - before) / reference.dt);
        }
        before = y;
    }
    velocity
}
