//! The samples of a channel with what a model leaves of each.

use crate::diagnose::line::without_line;
use crate::diagnose::residual::residual;
use crate::identify::data::{Channel, Run};
use crate::identify::evaluate::Predicted;
use crate::identify::prepare::Prepared;
use crate::recording::signal::curvature;

/// A run and what a model predicts of it.
pub(super) type Look<'a> = (&'a Run, &'a Predicted);

/// Noise of a channel that residuals are counted in.
pub(super) fn noise_of(whole: &Prepared, channel: Channel) -> Option<f64> {
    whole.fit.iter().find_map(|run| run.channel(channel)).map(|m| m.noise)
}

/// A sample of a channel.
#[derive(Clone)]
pub(super) struct Row {
    /// Residual, in units of the noise.
    pub(super) left: f64,
    /// Its second difference, in the same units: see [`differences`].
    pub(super) difference: f64,
    /// Size of the motion that would shake it.
    pub(super) motion: f64,
}

/// The samples of a channel in all runs that were recorded.
pub(super) fn rows(looks: &[Look], channel: Channel) -> Vec<Row> {
    let mut rows = Vec::new();
    for (run, predicted) in looks {
        let Some(left) = residual(run, predicted, channel) else { continue };
        // A hum is no noise, however large it is.
        let left = if channel == Channel::Acceleration { without_line(left, run.dt) } else { left };
        let Some(place) = run.measured.iter().position(|m| m.channel == channel) else { continue };
        let shown = &predicted.channels[place];
        let last = shown.len() - 1;
        let motion = |k: usize| match channel {
            Channel::Displacement => (shown[(k + 1).min(last)] - shown[k.saturating_sub(1)]).abs() / run.dt,
            _ => shown[k].abs(),
        };
        let both = left.iter().zip(differences(&left)).enumerate();
        let all = both.map(|(k, (&left, difference))| Row { left, difference, motion: motion(k) });
        rows.extend(all.filter(|row| row.left.is_finite()));
    }
    rows
}

/// Second differences of a residual, of the same mean square as white noise itself.
pub(super) fn differences(left: &[f64]) -> Vec<f64> {
    curvature(left, 1.0).into_iter().map(|d| d / 6.0_f64.sqrt()).collect()
}
