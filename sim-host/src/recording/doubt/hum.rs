//! Mains hum in displacement, velocity and pressure: a line that lasts whatever the table does.
//!
//! Hum of the accelerometer is an effect of the library and left to it. Elsewhere a line of the mains that the reference does
//! not hold is the wiring's: its sine is fitted and taken off.

use super::{Doubt, SetUpFinding};
use crate::recording::channel::Channel;
use crate::recording::check::mains_line;
use crate::recording::experiment::Experiment;
use crate::recording::run::Run;
use crate::recording::signal::Sine;
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
            let Some(sine) = fitted(run, channel, frequency) else { continue };
            if let Some(samples) = run.channel(channel) {
                let cleaned = sine.taken_off(samples, run.dt);
                run.channels.set(channel, cleaned);
            }
            let amplitude = sine.sine.hypot(sine.cosine);
            let finding = SetUpFinding::new(Doubt::Hum, amplitude, unit).against(0.0);
            findings.push(finding.of_run(&run.name).of_channel(channel));
        }
    }
    findings
}

/// The sine that fits best near a frequency, Hz.
fn fitted(run: &Run, channel: Channel, near: f64) -> Option<Sine> {
    let samples = run.channel(channel)?;
    // Second differences hold the line and next to nothing of the motion; the first sample has none.
    let curved = samples.windows(3).map(|w| w[2] - 2.0 * w[1] + w[0]);
    let curved: Vec<f64> = std::iter::once(f64::NAN).chain(curved).collect();
    let width = 1.0 / run.duration();
    let best = Sine::best(&curved, run.dt, (-20..=20).map(|i| near + 0.1 * f64::from(i) * width))?;
    let gain = 2.0 * (TAU * best.frequency * run.dt).cos() - 2.0;
    (gain.abs() > 1e-6).then(|| Sine { sine: best.sine / gain, cosine: best.cosine / gain, ..best })
}
