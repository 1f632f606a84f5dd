//! What drives a run: its input with gaps bridged, what is added to the command, what surrounds the controller.

use crate::plant::simulate::{NotchFilter, Shaping};
use crate::recording::{self, law::commands_of_pi};
use nalgebra::{DMatrix, DVector};

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
    let begun = if run.cut { begun(run, ticks) } else { Begun::default() };
    let reference_slope = if run.cut { slope_at_start(run) } else { 0.0 };
    let (late_command, late_displacement) = (late_command * ticks, late_displacement * ticks);
    let Begun { integral, notch_start } = begun;
    Shaping { kvf, notch, late_command, late_displacement, integral, reference_slope, notch_start }
}

/// How fast the reference moves where a part of a recording begins, m/s.
fn slope_at_start(run: &recording::Run) -> f64 {
    let first = run.channel(recording::Channel::Reference).and_then(|r| Some(r.get(1)? - r.first()?));
    first.filter(|step| step.is_finite()).map_or(0.0, |step| step / run.dt)
}

/// Samples from which the state of the controller is estimated where a run begins.
const BEGINNING: usize = 64;

/// Where a controller's states stand when a part of a recording begins.
#[derive(Default)]
struct Begun {
    /// What the integral holds, in units of the command.
    integral: f64,
    /// The notch's state as [`Shaping::notch_start`] has it; none where the recording does not tell it.
    notch_start: Option<[f64; 2]>,
}

/// The states that make the law of the samples since give the recorded command; without one the errors recorded before the part say what
/// the integral holds.
fn begun(run: &recording::Run, ticks: usize) -> Begun {
    let summed = match run.law {
        recording::RecordedLaw::ProportionalIntegral { ki, .. } => ki * run.error_before,
        _ => 0.0,
    };
    let told = sent_since(run).and_then(|(law, sent)| match run.shaping.notch {
        None => {
            let held: f64 = sent.iter().zip(&law).map(|(sent, law)| sent - law).sum();
            Some(Begun { integral: held / sent.len().max(1) as f64, notch_start: None })
        }
        // Between its samples a faster controller's notch goes on unseen.
        Some(notch) if ticks == 1 => through_notch(NotchFilter::new(notch, run.dt), &law, &sent),
        Some(_) => None,
    });
    told.unwrap_or(Begun { integral: summed, notch_start: None })
}

/// What the law makes of the first samples, an integral that begins at none, and what was sent; none without a recorded command.
fn sent_since(run: &recording::Run) -> Option<(Vec<f64>, Vec<f64>)> {
    use recording::Channel as C;
    let recording::RecordedLaw::ProportionalIntegral { kp, ki } = run.law else { return None };
    let of = |channel| run.channel(channel).and_then(filled);
    let (reference, displacement, command) = (of(C::Reference)?, of(C::Displacement)?, of(C::Command)?);
    let added = of(C::Disturbance).unwrap_or_default();
    let n = BEGINNING.min(command.len());
    let until = (0.0, reference.first()? - slope_at_start(run) * run.dt);
    let law = commands_of_pi([kp, ki, run.shaping.kvf], [&reference[..n], &displacement[..n]], until, run.dt);
    let sent = (0..n).map(|k| command[k] - added.get(k).unwrap_or(&0.0)).collect();
    Some((law, sent))
}

/// The integral and the notch's two states by least squares: what was sent is what the notch makes of the law, of a constant, and of each
/// of its outputs before.
fn through_notch(notch: NotchFilter<f64>, law: &[f64], sent: &[f64]) -> Option<Begun> {
    let passed = |mut filter: NotchFilter<f64>, input: &dyn Fn(usize) -> f64| -> DVector<f64> {
        DVector::from_iterator(sent.len(), (0..sent.len()).map(|k| filter.step(input(k))))
    };
    let made = passed(notch.clone(), &|k| law[k]);
    let columns = [
        passed(notch.clone(), &|_| 1.0),
        passed(notch.clone().having_given([1.0, 0.0]), &|_| 0.0),
        passed(notch.having_given([0.0, 1.0]), &|_| 0.0),
    ];
    let columns = DMatrix::from_columns(&columns);
    let left = DVector::from_column_slice(sent) - made;
    let states = columns.tr_mul(&columns).cholesky()?.solve(&columns.tr_mul(&left));
    Some(Begun { integral: states[0], notch_start: Some([states[1], states[2]]) })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::simulate::Notch;

    /// A notch that was at work before goes on as it did.
    #[test]
    fn the_states_of_a_notch_are_told_from_what_it_sent() {
        let notch = NotchFilter::<f64>::new(Notch { frequency: 12.0, damping: 0.4, depth: 0.1 }, 1e-3);
        let law = |k: usize| 0.3 * (0.02 * k as f64).sin() + 0.1 * (0.11 * k as f64).cos();
        let (mut filter, integral) = (notch.clone(), 0.07);
        let sent: Vec<f64> = (0..1000).map(|k| filter.step(law(k) + integral)).collect();
        let since: Vec<f64> = (600..600 + BEGINNING).map(law).collect();
        let begun = through_notch(notch.clone(), &since, &sent[600..600 + BEGINNING]).unwrap();
        assert!((begun.integral - integral).abs() < 1e-9, "{}", begun.integral);
        let mut on = notch.having_given(begun.notch_start.unwrap());
        for (k, sent) in sent.iter().enumerate().skip(600) {
            assert!((on.step(law(k) + begun.integral) - sent).abs() < 1e-9, "{k}");
        }
    }
}
