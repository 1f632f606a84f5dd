//! Slow drift of the accelerometer against the motion that displacement shows.
//!
//! Over many seconds the mean acceleration of a table that stays within its stroke is next to nothing, and what there is
//! the displacement shows. Means over stretches of both are compared: their difference is the sensor's. A constant is left
//! to the models, as a bias; what follows displacement is tilt; what rises with time alone is drift.

use super::{Doubt, SetUpFinding};
use crate::recording::channel::Channel;
use crate::recording::experiment::Experiment;
use crate::recording::noise;
use crate::recording::run::Run;
use crate::recording::signal::{curvature, filled};
use nalgebra::{DMatrix, DVector};

/// Stretches that means are taken over.
const STRETCHES: usize = 24;
/// Standard errors beyond which a rise is a drift.
const CERTAIN: f64 = 6.0;
/// Rise over the run, in standard deviations of the noise, below which it is left alone.
const LEAST: f64 = 0.3;

/// Finds the drift of each run and takes it off.
pub(super) fn doubt(experiment: &mut Experiment) -> Vec<SetUpFinding> {
    let all = experiment.runs.clone();
    let mut findings = Vec::new();
    for run in &mut experiment.runs {
        let noise = noise::floors(run, &all).get(Channel::Acceleration).map_or(0.0, |floor| floor.std);
        let Some((rise, std)) = rise(run).filter(|(rise, _)| rise.abs() > LEAST * noise) else { continue };
        let n = run.len();
        if let Some(a) = run.channel(Channel::Acceleration) {
            let straight = |(k, a): (usize, &f64)| a - rise * (k as f64 / (n.max(2) - 1) as f64 - 0.5);
            let straightened = a.iter().enumerate().map(straight).collect();
            run.channels.set(Channel::Acceleration, straightened);
        }
        let finding = SetUpFinding::new(Doubt::Drift, rise, "m/s2").against(0.0).within(std);
        findings.push(finding.of_run(&run.name).of_channel(Channel::Acceleration));
    }
    findings
}

/// Rise of the accelerometer over the run that displacement does not show, with its standard error, m/s2.
fn rise(run: &Run) -> Option<(f64, f64)> {
    let (x, a) = (run.channel(Channel::Displacement)?, run.channel(Channel::Acceleration)?);
    let length = run.len() / STRETCHES;
    if length < 16 {
        return None;
    }
    let (x, a) = (filled(x), filled(a));
    let kinematic = curvature(&x, run.dt);
    let mean = |series: &[f64], i: usize| series[i * length..(i + 1) * length].iter().sum::<f64>() / length as f64;
    let about = x.iter().sum::<f64>() / x.len() as f64;
    let rows = DMatrix::from_fn(STRETCHES, 3, |i, j| match j {
        0 => 1.0,
        1 => (i as f64 + 0.5) / STRETCHES as f64 - 0.5,
        _ => mean(&x, i) - about,
    });
    let differences = DVector::from_fn(STRETCHES, |i, _| mean(&a, i) - mean(&kinematic, i));
    let scale = rows.column(2).norm();
    let rows = if scale > 0.0 { rows } else { rows.columns(0, 2).into_owned() };
    let mut scaled = rows.clone();
    if scale > 0.0 {
        scaled.column_mut(2).unscale_mut(scale);
    }
    let inverse = scaled.tr_mul(&scaled).try_inverse()?;
    let fitted = &inverse * scaled.tr_mul(&differences);
    let left = (&differences - &scaled * &fitted).norm_squared() / (STRETCHES - scaled.ncols()) as f64;
    let std = (left * inverse[(1, 1)]).sqrt();
    (fitted[1].abs() > CERTAIN * std).then_some((fitted[1], std))
}
