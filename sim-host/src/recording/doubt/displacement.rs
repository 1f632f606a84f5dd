//! Offset and slow drift of the recorded displacement against what the controller saw.
//!
//! A drift d(t) in the recording alone leaves `kp d + ki integral(d)` in the command, which a drift of the sensor that
//! controls the loop does not. So the two are told apart without a model of the table.

use super::replay::{Linear, gains, parabola};
use super::{Doubt, SetUpFinding};
use crate::recording::channel::Channel;
use crate::recording::experiment::Experiment;
use crate::recording::law::RecordedLaw;
use crate::recording::noise;
use crate::recording::run::Run;

/// Drift over a run, in standard deviations of the sensor's noise, below which it is left alone.
const LEAST: f64 = 0.3;
/// Share of the command's size that the law may leave for its residual to be read as a drift.
const EXPLAINED: f64 = 0.05;

/// A drift that was found: m per second, and the time at which it is zero, s.
#[derive(Clone, Copy)]
struct Drift {
    rate: f64,
    zero: f64,
}

/// Finds the drift of each recording and takes it off. A part that begins within its file has an integral that is not known well
/// enough to tell a drift from: it has the drift that the part before it shows, for they are one recording of one sensor.
pub(super) fn doubt(experiment: &mut Experiment) -> Vec<SetUpFinding> {
    let all = experiment.runs.clone();
    let mut findings = Vec::new();
    for run in &mut experiment.runs {
        let n = run.len();
        let noise = noise::floors(run, &all).get(Channel::Displacement).map_or(0.0, |floor| floor.std);
        let beginning =
            if run.cut { all.iter().find(|other| !other.cut && other.path == run.path) } else { Some(&*run) };
        let Some(drift) = beginning.and_then(|whole| drift(whole, noise)) else { continue };
        let Some(x) = run.channel(Channel::Displacement) else { continue };
        let straight = |(x, t): (&f64, &f64)| x - drift.rate * (t - drift.zero);
        let straightened = x.iter().zip(&run.time).map(straight).collect();
        run.channels.set(Channel::Displacement, straightened);
        let rise = drift.rate * run.duration();
        let finding = SetUpFinding::new(Doubt::Drift, rise, "m").against(0.0).within(noise / (n as f64 / 12.0).sqrt());
        findings.push(finding.of_run(&run.name).of_channel(Channel::Displacement));
    }
    findings
}

/// The drift of a run that begins with its file.
fn drift(run: &Run, noise: f64) -> Option<Drift> {
    let rate = rise(run, noise)? / run.duration();
    Some(Drift { rate, zero: run.time.first()? + 0.5 * run.duration() })
}

/// How far the recorded displacement rises over the run against what the controller saw, m; none where it does not.
fn rise(run: &Run, noise: f64) -> Option<f64> {
    let stated = gains(&run.law)?;
    let kp = match run.law {
        RecordedLaw::ProportionalIntegral { kp, .. } => kp,
        _ => stated[0],
    };
    let linear = Linear::of(
        run,
        -(run.shaping.late_displacement as i32),
        run.shaping.late_command as f64,
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
        RecordedLaw::ProportionalIntegral { ki, .. } => ki,
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
