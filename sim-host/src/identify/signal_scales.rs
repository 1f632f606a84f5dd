//! Sizes of the signals, in whose multiples effects state their bounds and starting values.

use super::data::{Channel, Run};
use crate::plant::effects::SignalScale;
use crate::plant::simulate::SimulatedLaw;

/// Time over which the rate of a command is taken, s.
const SPAN: f64 = 0.004;

/// Sizes of the signals, in whose multiples effects state their bounds and starting values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignalScales {
    /// RMS of the command.
    pub command: f64,
    /// Largest rate of change of the command, per second.
    pub command_rate: f64,
    /// Largest speed, m/s.
    pub speed: f64,
    /// Largest displacement from the start, m.
    pub displacement: f64,
    /// 1, or the mass of a rigid mass, kg.
    pub force: f64,
    /// Longest run, s.
    pub duration: f64,
    /// Strongest line of the accelerometer's residual, Hz.
    pub line: f64,
}

impl SignalScales {
    /// Of a table of the paper's kind that plays an earthquake: for models that are written down, not measured.
    pub const TYPICAL: Self = Self {
        command: 0.05,
        command_rate: 2.0,
        speed: 0.2,
        displacement: 0.1,
        force: 1.0,
        duration: 30.0,
        line: 50.0,
    };

    /// The size that one scale stands for.
    pub fn size(&self, signal_scale: SignalScale) -> f64 {
        match signal_scale {
            SignalScale::One => 1.0,
            SignalScale::Command => self.command,
            SignalScale::CommandRate => self.command_rate,
            SignalScale::Speed => self.speed,
            SignalScale::Displacement => self.displacement,
            SignalScale::Force => self.force,
            SignalScale::Curvature => self.displacement.powi(-2),
            SignalScale::Duration => self.duration,
            SignalScale::Line => self.line,
        }
    }

    /// Measured on the runs a fit uses.
    pub fn of(runs: &[Run], mass: f64) -> Self {
        let duration = runs.iter().map(|run| run.len() as f64 * run.dt).fold(0.0, f64::max);
        let mut it =
            Self { command: 0.0, command_rate: 0.0, speed: 0.0, displacement: 0.0, force: mass, duration, line: 50.0 };
        let (mut squares, mut count) = (0.0, 0.0);
        for run in runs {
            if let Some(command) = command(run) {
                squares += command.iter().filter(|u| u.is_finite()).map(|u| u * u).sum::<f64>();
                it.command_rate = fastest(&command, run.dt).max(it.command_rate);
                count += command.iter().filter(|u| u.is_finite()).count() as f64;
            }
            if let Some(x) = run.channel(Channel::Displacement) {
                let span = (0.02 / run.dt).round().max(1.0) as usize;
                let start = x.values.iter().copied().find(|value| value.is_finite()).unwrap_or(0.0);
                for (i, value) in x.values.iter().enumerate() {
                    it.displacement = it.displacement.max((value - start).abs());
                    if let Some(later) = x.values.get(i + span) {
                        it.speed = it.speed.max((later - value).abs() / (span as f64 * run.dt));
                    }
                }
            } else if let Some(v) = run.channel(Channel::Velocity) {
                let mut travelled = 0.0_f64;
                for value in v.values.iter().filter(|v| v.is_finite()) {
                    travelled += value * run.dt;
                    it.displacement = it.displacement.max(travelled.abs());
                    it.speed = it.speed.max(value.abs());
                }
            }
        }
        if count > 0.0 {
            it.command = (squares / count).sqrt();
        }
        for size in [&mut it.command, &mut it.command_rate, &mut it.speed, &mut it.displacement, &mut it.duration] {
            *size = size.max(1e-9);
        }
        it
    }
}

/// The command of a run: as recorded, or what the stated law makes of reference and displacement where none was; the mean
/// over the controller's noise that it holds is what an effect is measured in either way.
fn command(run: &Run) -> Option<Vec<f64>> {
    if let Some(recorded) = run.channel(Channel::Command) {
        return Some(recorded.values.clone());
    }
    let shown = &run.channel(Channel::Displacement)?.values;
    let errors = run.input.iter().zip(shown).map(|(reference, x)| reference - x);
    match run.law {
        SimulatedLaw::Recorded => Some(run.input.clone()),
        SimulatedLaw::Pi { kp, ki } => {
            let mut sum = 0.0;
            let of = |error: f64| {
                sum += if error.is_finite() { error * run.dt } else { 0.0 };
                kp * error + ki * sum
            };
            Some(errors.map(of).collect())
        }
        SimulatedLaw::Cascade { kp, kv } => {
            let rate = |k: usize| if k == 0 { 0.0 } else { (shown[k] - shown[k - 1]) / run.dt };
            Some(errors.enumerate().map(|(k, error)| kv * (kp * error - rate(k))).collect())
        }
    }
}

/// The largest rate of change of a command over a few milliseconds, per second: what noise does from sample to sample is not
/// asked of a valve.
fn fastest(command: &[f64], dt: f64) -> f64 {
    let span = (SPAN / dt).round().max(1.0) as usize;
    let rates = command.iter().zip(command.iter().skip(span)).map(|(a, b)| (b - a).abs() / (span as f64 * dt));
    rates.filter(|rate| rate.is_finite()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::fit::tests::{TRUTH, model, recorded};

    /// A run that recorded no command has one all the same: effects at the valve start from its size.
    #[test]
    fn a_command_that_was_not_recorded_follows_from_the_law() {
        let run = recorded(&model(TRUTH), 1);
        let sizes = SignalScales::of(std::slice::from_ref(&run), 1.0);
        // The table needs u = v a1/b0 at slow speed.
        let needed = sizes.speed * TRUTH[2] / TRUTH[1];
        assert!(sizes.command > 0.1 * needed && sizes.command < needed, "{} of {needed}", sizes.command);
        assert!(sizes.command_rate > sizes.command);
    }
}
