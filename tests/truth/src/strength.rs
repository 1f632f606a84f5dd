//! How strong a flaw is: what it adds to the chi2 of the run held out once the stated model has been refitted.

use crate::closed_loop::{Run, Traces, simulate};
use crate::plant::Physics;
use crate::refit::{Refit, Sigma, chi2, refit};
use crate::scene::Scene;

/// A flawed experiment without noise, and how visible the flaw is.
#[derive(Debug, Clone)]
pub struct Sized {
    /// Traces of every run, without noise.
    pub traces: Vec<Traces>,
    /// The baseline refitted to them.
    pub refit: Refit,
    /// Added to chi2 on the run held out.
    pub excess: f64,
}

/// Pairs runs with their traces.
pub fn paired<'a>(runs: &'a [Run], traces: &'a [Traces]) -> Vec<(&'a Run, &'a Traces)> {
    runs.iter().zip(traces).collect()
}

/// Simulates every run without noise, refits the baseline, and measures what is left. None where the loop runs away.
pub fn measure(scene: &Scene, physics: &Physics) -> Option<Sized> {
    let traces = scene.runs.iter().map(|run| simulate(physics, run, None)).collect::<Option<Vec<_>>>()?;
    let refit = fitted(scene, &traces);
    let held_out = scene.fit_runs();
    let excess = chi2(&refit, &paired(&scene.runs[held_out..], &traces[held_out..]), &scene.sigma);
    Some(Sized { traces, refit, excess })
}

fn fitted(scene: &Scene, traces: &[Traces]) -> Refit {
    let n = scene.fit_runs();
    let sigma: &Sigma = &scene.sigma;
    refit(scene.truth, &scene.fit, &paired(&scene.runs[..n], &traces[..n]), sigma)
}

/// Seeks the strength in (0, 1] at which the excess comes near `target`: within a third, or as near as the flaw can.
pub fn seek(scene: &Scene, target: f64, apply: &impl Fn(f64, &mut Physics)) -> Option<(f64, Sized)> {
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    let mut strength = 0.1_f64;
    let mut best: Option<(f64, Sized)> = None;
    for _ in 0..9 {
        let mut physics = Physics::baseline(scene.truth);
        apply(strength, &mut physics);
        let Some(sized) = measure(scene, &physics) else {
            high = strength;
            strength = if low > 0.0 { (low * high).sqrt() } else { 0.3 * strength };
            continue;
        };
        let excess = sized.excess;
        if excess < target {
            low = low.max(strength);
        } else {
            high = high.min(strength);
        }
        let closer = best.as_ref().is_none_or(|(_, b)| off(excess, target) < off(b.excess, target));
        if closer {
            best = Some((strength, sized));
        }
        if off(excess, target) < 0.3 || low >= 1.0 {
            break;
        }
        // Small flaws act linearly: the excess goes with the square of the strength.
        let guess = strength * (target / excess.max(1e-9)).sqrt().clamp(0.02, 20.0);
        let bracketed = low > 0.0 && (guess <= low || guess >= high);
        strength = if bracketed { (low * high).sqrt() } else { guess.clamp(1e-4, high) };
    }
    best
}

fn off(excess: f64, target: f64) -> f64 {
    (excess.max(1e-12) / target).ln().abs()
}
