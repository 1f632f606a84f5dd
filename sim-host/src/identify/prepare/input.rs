//! What drives a run: its input with gaps bridged, what is added to the command, what surrounds the controller.

use crate::plant::simulate::Shaping;
use crate::recording;

/// What is added to the command with the feedback of the recorded pressure, which is taken as it was measured.
pub(super) fn with_pressure_feedback(mut added: Vec<f64>, run: &recording::Run) -> Vec<f64> {
    let gain = run.shaping.kdp;
    let pressure = run.channel(recording::Channel::PressureDifference).filter(|_| gain != 0.0).and_then(filled);
    let Some(pressure) = pressure else { return added };
    added.resize(pressure.len(), 0.0);
    added.iter_mut().zip(&pressure).for_each(|(u, p)| *u -= gain * p);
    added
}

/// What surrounds a run's controller, in ticks.
pub(super) fn shaping(run: &recording::Run, ticks: usize) -> Shaping {
    let recording::Shaping { kvf, notch, late_command, late_displacement, .. } = run.shaping;
    let summed = match run.law {
        recording::RecordedLaw::ProportionalIntegral { ki, .. } => ki * run.error_before,
        _ => 0.0,
    };
    // A notch stands between the law and what was recorded of it.
    let recorded = if notch.is_none() { integral_at_start(run) } else { None };
    let integral = if run.cut { recorded.unwrap_or(summed) } else { 0.0 };
    let reference_slope = if run.cut { slope_at_start(run) } else { 0.0 };
    let (late_command, late_displacement) = (late_command * ticks, late_displacement * ticks);
    Shaping { kvf, notch, late_command, late_displacement, integral, reference_slope }
}

/// How fast the reference moves where a part of a recording begins, m/s.
fn slope_at_start(run: &recording::Run) -> f64 {
    let first = run.channel(recording::Channel::Reference).and_then(|r| Some(r.get(1)? - r.first()?));
    first.filter(|step| step.is_finite()).map_or(0.0, |step| step / run.dt)
}

/// Samples over which the integral's part of the command is averaged where a run begins.
const BEGINNING: usize = 64;

/// What the integral holds where a part of a recording begins, in units of the command: the recorded command less what the law
/// makes of the samples since; none without a recorded command, where the errors recorded before the part say it.
fn integral_at_start(run: &recording::Run) -> Option<f64> {
    use recording::Channel as C;
    let recording::RecordedLaw::ProportionalIntegral { kp, ki } = run.law else { return None };
    let of = |channel| run.channel(channel).and_then(filled);
    let (reference, displacement, command) = (of(C::Reference)?, of(C::Displacement)?, of(C::Command)?);
    let added = of(C::Disturbance).unwrap_or_default();
    let (mut sum, mut held, mut before) = (0.0, 0.0, reference.first()? - slope_at_start(run) * run.dt);
    let n = BEGINNING.min(command.len());
    for k in 0..n {
        let error = reference[k] - displacement[k];
        sum += error * run.dt;
        let fed = run.shaping.kvf * (reference[k] - before) / run.dt;
        before = reference[k];
        held += command[k] - added.get(k).unwrap_or(&0.0) - kp * error - ki * sum - fed;
    }
    Some(held / n.max(1) as f64)
}

/// Missing samples of an input filled by straight lines; none where every sample is missing.
pub(super) fn filled(values: &[f64]) -> Option<Vec<f64>> {
    let known: Vec<usize> = (0..values.len()).filter(|&i| values[i].is_finite()).collect();
    let (&first, &last) = (known.first()?, known.last()?);
    let mut full = values.to_vec();
    full[..first].fill(values[first]);
    full[last..].fill(values[last]);
    for pair in known.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        for (i, value) in full.iter_mut().enumerate().take(b).skip(a + 1) {
            *value = values[a] + (values[b] - values[a]) * (i - a) as f64 / (b - a) as f64;
        }
    }
    Some(full)
}
