//! Which quantity explains a residual: binned means fitted on every other block, judged on the blocks between.

use super::StateShare;
use crate::diagnose::residual::{judged_channels, residual};
use crate::digits;
use crate::identify::data::{Channel, Run};
use crate::identify::evaluate::{BLOCK, Predicted};

const BINS: usize = 12;
/// Least share worth naming.
const LEAST: f64 = 0.02;

/// Shares of the residual's variance by quantity, strongest first.
pub(super) fn shares(runs: &[Run], predicted: &[Predicted]) -> Vec<StateShare> {
    const VARIABLES: [&str; 9] = [
        "displacement",
        "velocity",
        "acceleration",
        "command",
        "velocity_sign",
        "path",
        "time",
        "pressure",
        "reference",
    ];
    let telling = |run: &Run| {
        let judged = judged_channels(run);
        let order = [
            Channel::PressureDifference,
            Channel::Acceleration,
            Channel::Command,
            Channel::Displacement,
            Channel::Velocity,
        ];
        order.into_iter().find(|c| judged.contains(c))
    };
    let mut found = Vec::new();
    for variable in VARIABLES {
        let mut rows: Vec<(f64, f64, bool)> = Vec::new();
        for (run, predicted) in runs.iter().zip(predicted) {
            let Some(series) = telling(run).and_then(|channel| residual(run, predicted, channel)) else { continue };
            let Some(coordinate) = coordinate(variable, run, predicted) else { continue };
            let block = ((BLOCK / run.dt).round() as usize).max(1);
            rows.extend(
                coordinate.iter().zip(&series).enumerate().map(|(k, (&x, &r))| (x, r, (k / block).is_multiple_of(2))),
            );
        }
        rows.retain(|(x, r, _)| x.is_finite() && r.is_finite());
        if let Some(share) = explained(variable, &rows) {
            found.push(share);
        }
    }
    found.retain(|s| s.strength > LEAST);
    found.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    found
}

/// A quantity's value at each sample, from the model's noise-free prediction where there is one.
fn coordinate(variable: &str, run: &Run, predicted: &Predicted) -> Option<Vec<f64>> {
    if let Some(motion) = &run.motion {
        match variable {
            "acceleration" => return Some(motion.acceleration.clone()),
            "reference" => return None,
            _ => {}
        }
    }
    let series = |channel: Channel| {
        run.measured.iter().position(|m| m.channel == channel).map(|i| predicted.channels[i].clone())
    };
    let velocity = || {
        if let Some(motion) = &run.motion {
            return Some(motion.velocity.clone());
        }
        let x = &predicted.displacement;
        let n = x.len();
        Some((0..n).map(|k| (x[(k + 1).min(n - 1)] - x[k.saturating_sub(1)]) / (2.0 * run.dt)).collect::<Vec<_>>())
    };
    match variable {
        "displacement" => Some(predicted.displacement.clone()),
        "velocity" => velocity(),
        "acceleration" => series(Channel::Acceleration),
        "command" => series(Channel::Command),
        "pressure" => series(Channel::PressureDifference),
        "velocity_sign" => Some(velocity()?.iter().map(|v| if v.abs() < 1e-4 { 0.0 } else { v.signum() }).collect()),
        "path" => {
            let mut path = 0.0;
            Some(
                velocity()?
                    .iter()
                    .map(|v| {
                        path += v.abs() * run.dt;
                        path
                    })
                    .collect(),
            )
        }
        "time" => Some((0..run.len()).map(|k| run.elapsed + k as f64 * run.dt).collect()),
        "reference" => Some(run.input.clone()),
        _ => None,
    }
}

/// Cross-validated share of variance that binned means of the coordinate explain.
fn explained(variable: &'static str, rows: &[(f64, f64, bool)]) -> Option<StateShare> {
    let mut sorted: Vec<f64> = rows.iter().map(|r| r.0).collect();
    if sorted.len() < 20 * BINS {
        return None;
    }
    sorted.sort_by(f64::total_cmp);
    let edges: Vec<f64> = (1..BINS).map(|i| sorted[i * sorted.len() / BINS]).collect();
    let bin = |x: f64| edges.partition_point(|&e| e < x);
    let mut sums = [[(0.0, 0.0); BINS]; 2];
    let mut whole = 0.0;
    for &(x, r, even) in rows {
        let (sum, count) = &mut sums[usize::from(even)][bin(x)];
        *sum += r;
        *count += 1.0;
        whole += r * r;
    }
    let mean = |half: usize, bin: usize| {
        let (sum, count) = sums[half][bin];
        if count > 0.0 { sum / count } else { 0.0 }
    };
    let left: f64 = rows.iter().map(|&(x, r, even)| (r - mean(usize::from(!even), bin(x))).powi(2)).sum();
    let strength = (1.0 - left / whole.max(1e-300)).clamp(0.0, 1.0);
    let both = |i: usize| 0.5 * (mean(0, i) + mean(1, i));
    let strongest = (0..BINS).max_by(|&a, &b| both(a).abs().total_cmp(&both(b).abs()))?;
    let low = if strongest == 0 { sorted[0] } else { edges[strongest - 1] };
    let high = edges.get(strongest).copied().unwrap_or(sorted[sorted.len() - 1]);
    let odd = (0..BINS / 2).all(|i| both(i) * both(BINS - 1 - i) < 0.0);
    let both_ways = if odd { ", opposite on the other side" } else { "" };
    let profile = (0..BINS).map(|i| [sorted[(2 * i + 1) * sorted.len() / (2 * BINS)], both(i)]).collect();
    Some(StateShare {
        variable,
        place: format!("strongest from {} to {}{both_ways}", digits::three(low), digits::three(high)),
        strength,
        profile,
    })
}
