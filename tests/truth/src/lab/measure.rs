//! How visible a flaw is once the stated model's free parameters have done what they can: what it adds to chi2 on the rows
//! held out, and the square root of the sum of squares it leaves on all rows, in standard deviations.

use super::engine::simulate;
use super::plant::Plant;
use super::scene::Scene;
use super::stated::{Prediction, Run, predict};
use crate::closed_loop::Traces;
use crate::plant::Machine;
use crate::refit::{Parameter, Sigma, dot, least_squares, less, squares};

/// Rows simulated while a strength is sought.
const PROBED: usize = 60_000;
/// Rows that the projection uses.
const USED: usize = 12_000;

/// The unflawed experiment with the sensitivities of its free parameters.
pub struct Frame {
    runs: Vec<Run>,
    sigma: Sigma,
    displacement: bool,
    null: Vec<f64>,
    columns: Vec<Vec<f64>>,
    /// First element of the part held out, for each run's block.
    held_out: Vec<bool>,
    stride: usize,
    truth: Machine,
    fit: Vec<Parameter>,
}

/// How visible something is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Visible {
    /// Added to chi2 on the rows held out.
    pub excess: f64,
    /// Root of the sum of squares on all rows, in standard deviations.
    pub sigma: f64,
}

impl Frame {
    /// For a scene; long recordings are shortened.
    pub fn new(scene: &Scene) -> Self {
        let share = (PROBED as f64 / scene.rows() as f64).min(1.0);
        let runs: Vec<Run> = scene
            .runs
            .iter()
            .map(|run| {
                let rows = (run.reference.len() as f64 * share) as usize;
                Run { reference: run.reference[..rows.max(16)].to_vec(), ..run.clone() }
            })
            .collect();
        let rows: usize = runs.iter().map(|run| run.reference.len()).sum();
        let mut frame = Self {
            stride: (rows / USED).max(1),
            held_out: Vec::new(),
            null: Vec::new(),
            columns: Vec::new(),
            displacement: scene.says.channels[0],
            sigma: scene.sigma,
            truth: scene.truth,
            fit: scene.fit.clone(),
            runs,
        };
        frame.held_out = frame.mask(scene.runs.len());
        (frame.null, frame.columns) = frame.tangents(&scene.truth);
        frame
    }

    /// The runs as shortened.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    fn mask(&self, count: usize) -> Vec<bool> {
        let channels = usize::from(self.displacement) + usize::from(self.sigma.acceleration.is_some());
        let mut out = Vec::new();
        for (i, run) in self.runs.iter().enumerate() {
            let rows = run.reference.len().div_ceil(self.stride);
            for _ in 0..channels {
                out.extend((0..rows).map(|k| if count == 1 { 3 * k >= 2 * rows } else { i + 1 == count }));
            }
        }
        out
    }

    fn vector<'a>(&self, signals: impl Iterator<Item = (&'a [f64], &'a [f64])>) -> Vec<f64> {
        let mut out = Vec::new();
        for (displacement, acceleration) in signals {
            if self.displacement {
                out.extend(displacement.iter().step_by(self.stride).map(|x| x / self.sigma.displacement));
            }
            if let Some(sigma) = self.sigma.acceleration {
                out.extend(acceleration.iter().step_by(self.stride).map(|a| a / sigma));
            }
        }
        out
    }

    fn predicted(&self, machine: &Machine) -> Vec<f64> {
        let made: Vec<Prediction> = self.runs.iter().map(|run| predict(machine, run, None)).collect();
        self.vector(made.iter().map(|p| (p.displacement.as_slice(), p.acceleration.as_slice())))
    }

    /// What the model gives, and its slopes with the logarithm of each free parameter and with the displacement's offset.
    fn tangents(&self, machine: &Machine) -> (Vec<f64>, Vec<Vec<f64>>) {
        let here = self.predicted(machine);
        let step = 1e-5;
        let mut columns: Vec<Vec<f64>> = self
            .fit
            .iter()
            .map(|parameter| {
                let mut moved = *machine;
                if let Some(value) = parameter.of(&mut moved) {
                    *value *= 1.0 + step;
                }
                self.predicted(&moved).iter().zip(&here).map(|(a, b)| (a - b) / step).collect()
            })
            .collect();
        if self.displacement {
            let channels = self.runs.iter().map(|run| run.reference.len().div_ceil(self.stride));
            let mut offset = Vec::with_capacity(here.len());
            for rows in channels {
                offset.extend(std::iter::repeat_n(1.0, rows));
                if self.sigma.acceleration.is_some() {
                    offset.extend(std::iter::repeat_n(0.0, rows));
                }
            }
            columns.push(offset);
        }
        (here, columns)
    }

    /// Clean traces of a plant, as a vector less the unflawed one; none where the loop runs away.
    pub fn deviation(&self, plant: &Plant) -> Option<Vec<f64>> {
        let traces = self.runs.iter().map(|run| simulate(plant, run, None)).collect::<Option<Vec<Traces>>>()?;
        let made = self.vector(traces.iter().map(|t| (t.displacement.as_slice(), t.acceleration.as_slice())));
        let away: Vec<f64> = made.iter().zip(&self.null).map(|(a, b)| a - b).collect();
        away.iter().all(|v| v.is_finite()).then_some(away)
    }

    /// What is left of a deviation once the free parameters, moved linearly, have explained what they can of all rows.
    pub fn left(&self, deviation: &[f64]) -> Vec<f64> {
        less(deviation, &self.columns, &fitted(&self.columns, deviation, |_| true))
    }

    /// How visible a deviation is.
    pub fn visible(&self, deviation: &[f64]) -> Visible {
        let left = self.left(deviation);
        let sigma = (squares(&left) * self.stride as f64).sqrt();
        let outside = |i: usize| !self.held_out[i];
        let foreseen = less(deviation, &self.columns, &fitted(&self.columns, deviation, outside));
        Visible { excess: self.mean_held_out(&foreseen), sigma }
    }

    fn mean_held_out(&self, r: &[f64]) -> f64 {
        let those = r.iter().zip(&self.held_out).filter(|(_, held)| **held).map(|(x, _)| x * x);
        those.sum::<f64>() / self.held_out.iter().filter(|held| **held).count().max(1) as f64
    }

    /// What a deviation adds to chi2 on the rows held out after a refit by Gauss and Newton, with halved steps.
    pub fn refitted(&self, deviation: &[f64]) -> f64 {
        let target: Vec<f64> = deviation.iter().zip(&self.null).map(|(a, b)| a + b).collect();
        let cost = |r: &[f64]| r.iter().zip(&self.held_out).filter(|(_, h)| !**h).map(|(x, _)| x * x).sum::<f64>();
        let outside = |i: usize| !self.held_out[i];
        let (mut machine, mut offset) = (self.truth, 0.0);
        let mut best = self.mean_held_out(deviation);
        for _ in 0..4 {
            let (here, columns) = self.tangents(&machine);
            let mut r: Vec<f64> = target.iter().zip(&here).map(|(a, b)| a - b).collect();
            if let (true, Some(column)) = (self.displacement, columns.last()) {
                r = less(&r, std::slice::from_ref(column), &[offset]);
            }
            best = self.mean_held_out(&r);
            let step = fitted(&columns, &r, outside);
            let Some((moved, by)) = self.accepted(&machine, &step, &target, offset, cost(&r), cost) else { break };
            (machine, offset) = (moved, by);
        }
        best
    }

    fn accepted(
        &self,
        from: &Machine,
        step: &[f64],
        target: &[f64],
        offset: f64,
        cost_here: f64,
        cost: impl Fn(&[f64]) -> f64,
    ) -> Option<(Machine, f64)> {
        let mut share = 1.0;
        while share > 0.1 {
            let mut moved = *from;
            for (parameter, delta) in self.fit.iter().zip(step) {
                if let Some(value) = parameter.of(&mut moved) {
                    *value *= (share * delta).clamp(-0.7, 0.7).exp();
                }
            }
            let by = offset + if self.displacement { share * step.last().copied().unwrap_or(0.0) } else { 0.0 };
            let made = self.predicted(&moved);
            let mut r: Vec<f64> = target.iter().zip(&made).map(|(a, b)| a - b).collect();
            if let (true, Some(column)) = (self.displacement, self.columns.last()) {
                r = less(&r, std::slice::from_ref(column), &[by]);
            }
            if cost(&r) < 0.999 * cost_here {
                return Some((moved, by));
            }
            share *= 0.4;
        }
        None
    }
}

/// Least squares of `r` by the columns over the rows that `counts`; zeros where it is singular.
fn fitted(columns: &[Vec<f64>], r: &[f64], counts: impl Fn(usize) -> bool) -> Vec<f64> {
    let kept = |x: &[f64]| x.iter().enumerate().filter(|(i, _)| counts(*i)).map(|(_, v)| *v).collect::<Vec<f64>>();
    let columns: Vec<Vec<f64>> = columns.iter().map(|c| kept(c)).collect();
    if columns.is_empty() {
        return Vec::new();
    }
    least_squares(&columns, &kept(r)).unwrap_or_else(|| vec![0.0; columns.len()])
}

/// Cosine between two vectors (1): how much alike two flaws are.
pub fn cosine(a: &[f64], b: &[f64]) -> f64 {
    let sizes = (dot(a, a) * dot(b, b)).sqrt();
    if sizes > 0.0 { dot(a, b) / sizes } else { 0.0 }
}

/// Seeks the strength in (0, 1] at which the excess comes near `target`: within a third, or as near as the flaw can.
pub fn seek(frame: &Frame, target: f64, plant: &impl Fn(f64) -> Plant) -> Option<(f64, Visible)> {
    let (mut low, mut high, mut strength) = (0.0_f64, 1.0_f64, 0.05_f64);
    let mut best: Option<(f64, Visible)> = None;
    let off = |excess: f64| (excess.max(1e-12) / target).ln().abs();
    for _ in 0..9 {
        let Some(deviation) = frame.deviation(&plant(strength)) else {
            high = strength;
            strength = if low > 0.0 { (low * high).sqrt() } else { 0.3 * strength };
            continue;
        };
        let visible = frame.visible(&deviation);
        if visible.excess < target {
            low = low.max(strength);
        } else {
            high = high.min(strength);
        }
        if best.as_ref().is_none_or(|(_, b)| off(visible.excess) < off(b.excess)) {
            best = Some((strength, visible));
        }
        if off(visible.excess) < 0.35 || low >= 1.0 {
            break;
        }
        let guess = strength * (target / visible.excess.max(1e-9)).sqrt().clamp(0.02, 20.0);
        let bracketed = low > 0.0 && (guess <= low || guess >= high);
        strength = if bracketed { (low * high).sqrt() } else { guess.clamp(1e-5, high) };
    }
    best
}
