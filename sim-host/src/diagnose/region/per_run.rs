//! Windows of effects whose size belongs to each run: a hum that comes and goes with a machine nearby.
//!
//! Such an effect has no strength that all runs share. Its sizes enter linearly, so that what a window takes away follows from a small
//! regression in each run.

use super::Start;
use super::cut::Cut;
use super::ends::{PARTS, spans, window};
use crate::identify::data::Run;
use crate::identify::fit::secant::{Base, Chord};
use crate::identify::model::{Model, ModelEffect};
use crate::plant::effects::Role;
use crate::plant::simulate::SimulateError;
use nalgebra::{DMatrix, DVector};

/// What a unit of each size changes everywhere.
pub(super) fn chords(
    base: &Base<'_>,
    (model, runs): (&Model, &[Run]),
    placed: &ModelEffect,
) -> Result<Vec<Chord>, SimulateError> {
    let sizes = (0..).zip(placed.entry.parameters).filter(|(_, p)| p.role == Role::PerRun).map(|(i, _)| i);
    let one = |size: usize| {
        let mut alone = placed.clone();
        alone.values[size].value = 1.0;
        base.chord(&model.with(alone), runs)
    };
    sizes.map(one).collect()
}

/// The window that takes most away, by what each size changes everywhere; none where no run shows any.
pub(super) fn start(base: &Base<'_>, placed: &ModelEffect, whole: &[Chord], cut: &Cut) -> Option<Start> {
    let (along, ends) = cut.ends();
    let parts = (0..PARTS).flat_map(|part| whole.iter().map(move |chord| cut.within(chord, part)));
    let products = base.products_of_runs(&parts.collect::<Vec<_>>());
    let gain = |first: usize, last: usize| -> f64 {
        products.iter().filter_map(|of_run| taken_away(of_run, whole.len(), (first, last))).sum()
    };
    let windows = spans(PARTS).map(|(first, last)| (gain(first, last), first, last));
    let best = windows.filter(|(gain, ..)| gain.is_finite()).max_by(|a, b| a.0.total_cmp(&b.0));
    best.and_then(|(gain, first, last)| {
        let placed = window(placed, along, (ends[first], ends[last + 1]), ends)?;
        Some(Start { placed, gain })
    })
}

/// Squares that one run's sizes take away in a window, each part of which changes the rows by as many chords as there are sizes.
fn taken_away((gram, left): &(Vec<Vec<f64>>, Vec<f64>), sizes: usize, (first, last): (usize, usize)) -> Option<f64> {
    let chords = |size: usize| (first..=last).map(move |part| part * sizes + size);
    let matrix = DMatrix::from_fn(sizes, sizes, |a, b| {
        chords(a).map(|i| chords(b).map(|j| gram[i][j]).sum::<f64>()).sum::<f64>()
    });
    let towards = DVector::from_fn(sizes, |a, _| chords(a).map(|i| left[i]).sum::<f64>());
    let values = matrix.cholesky()?.solve(&towards);
    Some(values.dot(&towards))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two parts with two sizes each: the second part holds 3 of the first size and 4 of the second, the first nothing.
    #[test]
    fn a_window_takes_away_what_its_parts_hold() {
        let gram = (0..4).map(|i| (0..4).map(|j| if i == j { 1.0 } else { 0.0 }).collect()).collect();
        let of_run = (gram, vec![0.0, 0.0, 3.0, 4.0]);
        assert_eq!(taken_away(&of_run, 2, (0, 0)), Some(0.0));
        assert!((taken_away(&of_run, 2, (1, 1)).unwrap() - 25.0).abs() < 1e-12);
        assert!((taken_away(&of_run, 2, (0, 1)).unwrap() - 12.5).abs() < 1e-12, "one size for both");
        let nothing = (vec![vec![0.0; 4]; 4], vec![0.0; 4]);
        assert_eq!(taken_away(&nothing, 2, (0, 1)), None, "a run that shows nothing of it");
    }
}
