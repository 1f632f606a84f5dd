//! Where what a model leaves rings: a structure that is hardly damped is found from within the width of its peak only, which no
//! ladder of starts is fine enough for.

use super::super::residual::{of_longest, padded_spectrum};
use crate::identify::data::{Channel, Run};
use crate::identify::fit::Fit;
use crate::identify::model::ModelEffect;
use crate::plant::effects::Family;
use crate::plant::simulate::SimulateError;

/// Channels in which a structure's force is seen, the most telling first.
const SHOWN: [Channel; 2] = [Channel::PressureDifference, Channel::Acceleration];
/// Damping ratio of a structure that rings for some ten periods.
const LIGHT: f64 = 0.02;
/// Peaks that are begun from, and the least factor between two of them: nearer ones are one peak, or side bands.
const PEAKS: usize = 3;
const APART: f64 = 1.1;

/// Frequencies at which the residual of a fit is strongest, in its longest run, Hz, the strongest first: lines of the excitation may be
/// among them. None where neither force nor acceleration is measured.
pub(super) fn dominant_frequencies(fit: &Fit, runs: &[Run]) -> Result<Vec<f64>, SimulateError> {
    let Some((series, dt)) = of_longest(fit, runs, &SHOWN)? else { return Ok(Vec::new()) };
    let mut power = padded_spectrum(&series);
    let bin = 0.5 / (dt * (power.len() - 1) as f64);
    let mut peaks = Vec::new();
    for _ in 0..PEAKS {
        let strongest = power.iter().enumerate().skip(1).max_by(|a, b| a.1.total_cmp(b.1));
        let Some((place, _)) = strongest.filter(|(_, power)| **power > 0.0) else { break };
        peaks.push(place as f64 * bin);
        let near = (place as f64 / APART) as usize..((place as f64 * APART) as usize + 2).min(power.len());
        power[near].fill(0.0);
    }
    Ok(peaks)
}

/// A structure that rings at a frequency (Hz), begun as `start` otherwise; none where the effect is no structure or has no such frequency.
pub(super) fn structure_at(start: ModelEffect, frequency: f64) -> Option<ModelEffect> {
    if start.entry.family != Family::Structure {
        return None;
    }
    let place = |key: &str| start.entry.parameters.iter().position(|p| p.key == key);
    let (at, damped) = (place("frequency")?, place("damping")?);
    let mut placed = start;
    let within = (placed.values[at].low..placed.values[at].high).contains(&frequency);
    (placed.values[at].value, placed.values[damped].value) = (frequency, LIGHT);
    within.then_some(placed)
}

#[cfg(test)]
mod tests;
