//! How the rows lie about a region of state, so that whoever has the answer can say how many a region holds.

use super::law::{Gate, Variable};
use super::scene::Scene;
use super::stated::predict;

/// Shares at which the variable of a state region is given.
const SHARES: usize = 200;

/// The variable that the located flaw depends on, at even shares of all rows of the motion without flaws.
pub(super) fn quantiles(scene: &Scene, gate: Option<Gate>) -> Vec<f64> {
    let Some(Gate::State { variable, .. }) = gate else { return Vec::new() };
    let mut values: Vec<f64> = Vec::new();
    for run in &scene.runs {
        let made = predict(&scene.truth, run, None);
        match variable {
            Variable::Displacement => values.extend(&made.displacement),
            Variable::Command => values.extend(&made.command),
            Variable::Velocity | Variable::Speed => {
                values.extend(made.displacement.windows(2).map(|x| (x[1] - x[0]) / run.dt));
            }
        }
    }
    values.sort_by(f64::total_cmp);
    let at = |i: usize| values[(2 * i + 1) * values.len() / (2 * SHARES)];
    if values.is_empty() { Vec::new() } else { (0..SHARES).map(at).collect() }
}
