//! Mains hum in displacement, velocity and pressure: a line that lasts whatever the table does.
//!
//! Hum of the accelerometer is an effect of the library and left to it. Elsewhere a line of the mains that the reference does
//! not hold is the wiring's: its sine is fitted and taken off.

use super::replay::{Linear, answer, gains};
use super::{Doubt, SetUpFinding};
use crate::recording::channel::Channel;
use crate::recording::check::mains_line;
use crate::recording::experiment::Experiment;
use crate::recording::run::Run;
use crate::recording::signal::Sine;
use std::f64::consts::TAU;

/// What is more than one half is the larger part.
const LARGER_PART: f64 = 0.5;

/// Takes the line off every channel that has one. What a controller that saw it made of it is known, and goes on to be added to the
/// command; then the table follows it, and so do the sensors beside.
pub(super) fn doubt(experiment: &mut Experiment) -> Vec<SetUpFinding> {
    let mut findings = Vec::new();
    for run in &mut experiment.runs {
        let mut followed = None;
        for (channel, unit) in [
            (Channel::Displacement, "m"),
            (Channel::Velocity, "m/s"),
            (Channel::PressureDifference, "unit of p"),
            (Channel::SupplyPressure, "unit of p"),
        ] {
            let Some(frequency) = mains_line(run, channel).filter(|line| followed != Some(*line)) else { continue };
            let Some(sine) = fitted(run, channel, frequency) else { continue };
            if let Some(samples) = run.channel(channel) {
                let cleaned = sine.taken_off(samples, run.dt);
                run.channels.set(channel, cleaned);
            }
            if channel == Channel::Displacement && keep_answer(run, &sine) {
                followed = Some(frequency);
            }
            let amplitude = sine.sine.hypot(sine.cosine);
            let finding = SetUpFinding::new(Doubt::Hum, amplitude, unit).against(0.0);
            findings.push(finding.of_run(&run.name).of_channel(channel));
        }
    }
    findings
}

/// Adds to a run's disturbance what its law makes of a line that was taken off the displacement, and says whether the recorded command
/// holds it.
fn keep_answer(run: &mut Run, sine: &Sine) -> bool {
    let nothing = vec![0.0; run.len()];
    let Some(answer) = answer(run, &sine.taken_off(&nothing, run.dt)) else { return false };
    let Some((linear, gains)) = Linear::of(run, 0, 0.0, false).zip(gains(&run.law)) else { return false };
    let unexplained = linear.without_trends().residual(&gains);
    let [mut held, mut all] = [0.0; 2];
    for (r, a) in unexplained.iter().zip(&answer) {
        held += r * a;
        all += a * a;
    }
    let holds = held > LARGER_PART * all;
    if holds {
        let known = run.channel(Channel::Disturbance).map_or(nothing, <[f64]>::to_vec);
        run.channels.set(Channel::Disturbance, known.iter().zip(&answer).map(|(d, a)| d + a).collect());
    }
    holds
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
