//! Mains hum in displacement, velocity and pressure: a line that lasts whatever the table does.
//!
//! Hum of the accelerometer is an effect of the library and left to it. Elsewhere a line of the mains that the reference does
//! not hold is the wiring's: its sine is fitted and taken off.

use super::{Doubt, SetUpFinding};
use crate::recording::channel::Channel;
use crate::recording::check::mains_line;
use crate::recording::experiment::Experiment;
use crate::recording::run::Run;
use nalgebra::{Matrix2, Vector2};
use std::f64::consts::TAU;

/// Takes the line off every channel that has one.
pub(super) fn doubt(experiment: &mut Experiment) -> Vec<SetUpFinding> {
    let mut findings = Vec::new();
    for run in &mut experiment.runs {
        for (channel, unit) in [
            (Channel::Displacement, "m"),
            (Channel::Velocity, "m/s"),
            (Channel::PressureDifference, "unit of p"),
            (Channel::SupplyPressure, "unit of p"),
        ] {
            let Some(frequency) = mains_line(run, channel) else { continue };
            let Some((sine, cosine, frequency)) = fitted(run, channel, frequency) else { continue };
            let amplitude = sine.hypot(cosine);
            if let Some(samples) = run.channel(channel) {
                let phase = |k: usize| TAU * frequency * k as f64 * run.dt;
                let off = |(k, x): (usize, &f64)| x - sine * phase(k).sin() - cosine * phase(k).cos();
                let cleaned = samples.iter().enumerate().map(off).collect();
                run.channels.set(channel, cleaned);
            }
            let finding = SetUpFinding::new(Doubt::Hum, amplitude, unit).against(0.0);
            findings.push(finding.of_run(&run.name).of_channel(channel));
        }
    }
    findings
}

/// The sine that fits best near a frequency, Hz: weights of sine and cosine, and its frequency.
fn fitted(run: &Run, channel: Channel, near: f64) -> Option<(f64, f64, f64)> {
    let samples = run.channel(channel)?;
    // Second differences hold the line and next to nothing of the motion.
    let curved: Vec<f64> = samples.windows(3).map(|w| w[2] - 2.0 * w[1] + w[0]).collect();
    let width = 1.0 / run.duration();
    let tried = (-20..=20).map(|i| near + 0.1 * f64::from(i) * width);
    let fit = |frequency: f64| {
        let (mut matrix, mut right, mut size) = (Matrix2::zeros(), Vector2::zeros(), 0.0);
        for (k, x) in curved.iter().enumerate().filter(|(_, x)| x.is_finite()) {
            let (sine, cosine) = (TAU * frequency * (k + 1) as f64 * run.dt).sin_cos();
            let row = Vector2::new(sine, cosine);
            matrix += row * row.transpose();
            right += row * *x;
            size += x * x;
        }
        let weights = matrix.try_inverse()? * right;
        Some((size - weights.dot(&right), weights, frequency))
    };
    let (_, weights, frequency) = tried.filter_map(fit).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let gain = 2.0 * (TAU * frequency * run.dt).cos() - 2.0;
    (gain.abs() > 1e-6).then(|| (weights[0] / gain, weights[1] / gain, frequency))
}
