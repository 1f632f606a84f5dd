//! Offset and slow drift of the recorded displacement against what the controller saw.
//!
//! A drift d(t) in the recording alone leaves `kp d + ki integral(d)` in the command, which a drift of the sensor that
//! controls the loop does not. So the two are told apart without a model of the table.

use super::replay::{Linear, gains, parabola};
use super::{Doubt, SetUpFinding};
use crate::recording::channel::Channel;
use crate::recording::experiment::Experiment;
use crate::recording::law::Law;
use crate::recording::noise;
use crate::recording::run::Run;

/// Drift over a run, in standard deviations of the sensor's noise, below which it is left alone.
const LEAST: f64 = 0.3;
/// Share of the command's size that the law may leave for its residual to be read as a drift.
const EXPLAINED: f64 = 0.05;

/// Finds the drift of each run and takes it off.
pub(super) fn doubt(experiment: &mut Experiment) -> Vec<SetUpFinding> {
    let all = experiment.runs.clone();
    let mut findings = Vec::new();
    for run in &mut experiment.runs {
        let noise = noise::floors(run, &all).get(Channel::Displacement).map_or(0.0, |floor| floor.std);
        let Some(rise) = rise(run, noise) else { continue };
        let n = run.len();
        if let Some(x) = run.channel(Channel::Displacement) {
            let straight = |(k, x): (usize, &f64)| x - rise * (k as f64 / (n.max(2) - 1) as f64 - 0.5);
            let straightened = x.iter().enumerate().map(straight).collect();
            run.channels.set(Channel::Displacement, straightened);
        }
        let finding = SetUpFinding::new(Doubt::Drift, rise, "m").against(0.0).within(noise / (n as f64 / 12.0).sqrt());
        findings.push(finding.of_run(&run.name).of_channel(Channel::Displacement));
    }
    findings
}

/// How far the recorded displacement rises over the run against what the controller saw, m; none where it does not.
fn rise(run: &Run, noise: f64) -> Option<f64> {
    let stated = gains(&run.law)?;
    let kp = match run.law {
        Law::ProportionalIntegral { kp, .. } => kp,
        _ => stated[0],
    };
    let linear = Linear::of(
        run,
        -(run.shaping.late_displacement as i32),
        run.shaping.late_command as i32,
        run.shaping.kvf != 0.0,
    )?;
    let mut all = stated.to_vec();
    all.push(run.shaping.kvf);
    let residual = linear.residual(&all);
    let [_, slope, curve] = parabola(&residual, &linear.known);
    let flat: Vec<f64> = residual
        .iter()
        .enumerate()
        .map(|(k, r)| {
            let t = super::replay::time(k, residual.len());
            r - slope * t - curve * t * t
        })
        .collect();
    let size = |series: &[f64]| crate::recording::signal::deviation(series);
    if size(&flat) > EXPLAINED * size(&linear.command) {
        return None;
    }
    // kp d1 t + ki d1 t^2 / 2: where there is an integral it must show, or the slope is an offset's integral.
    let half = 0.5 * run.duration();
    let integral = match run.law {
        Law::ProportionalIntegral { ki, .. } => ki,
        _ => 0.0,
    };
    let by_curve = (integral * half > 0.05 * kp.abs()).then(|| 2.0 * curve / (integral * half));
    let by_slope = slope / kp;
    let per_half = match by_curve {
        // The integral of an offset is a slope: the curve is what only a drift makes.
        Some(curved) => curved,
        None => by_slope,
    };
    let rise = 2.0 * per_half;
    let error = 10.0 * size(&flat) / (kp.abs() * (residual.len() as f64).sqrt());
    (rise.abs() > LEAST * noise && rise.abs() > error && rise.is_finite()).then_some(rise)
}
