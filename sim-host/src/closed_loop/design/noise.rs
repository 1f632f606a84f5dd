//! What the sensors' noise shakes a table with.
//!
//! The very law on the model's linear plant follows a slow sine twice, once with ideal sensors and once with the noise that
//! its observer is set for; the difference of the two accelerations is the noise's doing. The sine takes the LVDT across
//! its steps, as a motion does: at rest a step hides, or shows as a limit cycle, by where the table happens to stand.

use super::{Corner, DesignError, Table};
use crate::closed_loop::trial::low_passed;
use crate::closed_loop::{Clock, ClosedLoopError, pressure_by_settings, run};
use crate::motion::Motion;
use crate::plant::sensors::{SensorModel, Sensors};
use shakedown_core::{Controller, Settings};
use std::f64::consts::TAU;

/// The sine: amplitude, m, and frequency, Hz.
const SINE: (f64, f64) = (0.005, 0.5);
/// How long it is followed, and how much of that is left out at the start, s.
const FOLLOWED: (f64, f64) = (5.0, 1.0);

/// Root mean square of the acceleration (m/s2) below 15 Hz that noise of `settings`' own sensors shakes `table` with.
pub(super) fn shaken(table: &Table, settings: &Settings) -> Result<f64, DesignError> {
    let Some(tracking) = settings.tracking else { return Ok(0.0) };
    let clock = Clock::new(f64::from(settings.rate), 2).map_err(ClosedLoopError::from)?;
    let dt = 1.0 / f64::from(settings.rate);
    let ticks = (FOLLOWED.0 / dt) as usize;
    let reference: Vec<f64> = (0..ticks).map(|k| SINE.0 * (1.0 - (TAU * SINE.1 * k as f64 * dt).cos())).collect();
    let follow = |model: SensorModel| -> Result<Vec<f64>, DesignError> {
        let mut law = Controller::new(settings).map_err(ClosedLoopError::from)?;
        let mut plant = table.linear(&Corner::default(), clock.plant_step())?;
        let mut sensors = Sensors::new(pressure_by_settings(&model, settings));
        Ok(run(&mut plant, &mut law, &mut sensors, &reference, clock).acceleration)
    };
    let noisy = SensorModel {
        displacement_step: f64::from(tracking.noise.displacement) * 12_f64.sqrt(),
        acceleration_noise: f64::from(tracking.noise.acceleration),
        ..SensorModel::default()
    };
    let (quiet, noisy) = (follow(SensorModel::default())?, follow(noisy)?);
    let difference = noisy.iter().zip(&quiet).map(|(noisy, quiet)| noisy - quiet).collect();
    // A filter that a rate cannot hold leaves the whole noise, which is no less.
    let motion = Motion::from_acceleration(dt, difference);
    let shaken = low_passed(&motion).map_or(motion.acceleration, |low| low.acceleration);
    let judged = &shaken[((FOLLOWED.1 / dt) as usize).min(shaken.len())..];
    Ok((judged.iter().map(|a| a * a).sum::<f64>() / judged.len().max(1) as f64).sqrt())
}
