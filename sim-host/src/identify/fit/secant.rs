//! What a change of a fitted model would explain, estimated from one simulation without sensitivities.
//!
//! A look at an effect with all its derivatives costs ten times a plain simulation. The change that an effect at a starting
//! value makes to every channel is a direction too: the chord instead of the tangent. What it explains beside the fit's own
//! parameters, whose sensitivities are kept, ranks the starts; those that rank high deserve the full look. An effect that
//! starts from none changes nothing: there the tangent of its own parameter alone stands for the chord.

use super::added::{held, only_new};
use super::{Fit, PROMISED, matching};
use crate::identify::data::Run;
use crate::identify::evaluate::{Rows, normal, residuals};
use crate::identify::model::Model;
use crate::plant::simulate::SimulateError;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Squares of a change, and share of one, below which nothing of it is left beside the fit's own parameters.
const NOTHING: f64 = 1e-6;

/// Products of several changes, each with each, and each with what a fit leaves.
pub(crate) type Products = (Vec<Vec<f64>>, Vec<f64>);

/// A fit with the rows behind its normal equations.
#[derive(Debug)]
pub(crate) struct Base<'a> {
    fit: &'a Fit,
    rows: Vec<Rows>,
    /// The step that the fit's own parameters would take.
    step: DVector<f64>,
}

impl<'a> Base<'a> {
    /// Simulates the fit once more to keep its rows; none where its normal equations cannot be solved.
    pub(crate) fn of(fit: &'a Fit, runs: &[Run]) -> Result<Option<Self>, SimulateError> {
        let kept = |(run, local)| -> Result<Rows, SimulateError> {
            let mut rows = Rows::default();
            normal(&fit.model, run, local, Some(&mut rows))?;
            Ok(rows)
        };
        let rows = runs.par_iter().zip(&fit.locals).map(kept).collect::<Result<Vec<_>, _>>()?;
        let step = fit.normal.step(PROMISED, &fit.held());
        Ok(step.map(|step| Self { fit, rows, step }))
    }

    /// What `model` changes.
    pub(crate) fn chord(&self, model: &Model, runs: &[Run]) -> Result<Chord, SimulateError> {
        let locals = matching(self.fit.locals.clone(), model, runs);
        let new = runs.iter().zip(&locals).map(|(run, local)| residuals(model, run, local));
        let less = |(rows, new): (&Rows, Result<Vec<f64>, SimulateError>)| -> Result<Vec<f64>, SimulateError> {
            Ok(rows.residuals.iter().zip(new?).map(|(old, new)| old - new).collect())
        };
        let rows = self.rows.iter().zip(new).map(less).collect::<Result<Vec<_>, _>>()?;
        let change = self.change(|i| Ok(rows[i].as_slice()))?;
        Ok(Chord { rows, change })
    }

    /// Products of several changes, each with each and with what the fit leaves, the fit's own parameters moving with them; none
    /// where that cannot be told.
    pub(crate) fn products(&self, chords: &[Chord]) -> Option<Products> {
        let dot = |a: &Chord, b: &Chord| -> f64 {
            a.rows.iter().flatten().zip(b.rows.iter().flatten()).map(|(a, b)| a * b).sum()
        };
        let solve = |chord: &Chord| self.fit.normal.solve(chord.change.along.clone(), PROMISED, &self.fit.held());
        let taken = chords.iter().map(solve).collect::<Option<Vec<_>>>()?;
        let with = |a: &Chord| -> Vec<f64> {
            chords.iter().zip(&taken).map(|(b, taken)| dot(a, b) - a.change.along.dot(taken)).collect()
        };
        let left = |a: &Chord| a.change.towards - a.change.along.dot(&self.step);
        Some((chords.iter().map(with).collect(), chords.iter().map(left).collect()))
    }

    /// The same products of what a little of each free value changes that the effects of `model` have beyond the fit, by their tangents.
    pub(crate) fn products_of_new(&self, model: &Model, runs: &[Run]) -> Result<Option<Products>, SimulateError> {
        let narrow = only_new(model, &self.fit.model);
        let (own, new, shared) = (self.step.len(), narrow.free_values(), self.fit.model.free_values());
        let (mut gram, mut towards) = (DMatrix::zeros(new, new), DVector::zeros(new));
        let mut along = DMatrix::zeros(own, new);
        let mut first = shared;
        for ((run, local), known) in runs.iter().zip(&self.fit.locals).zip(&self.rows) {
            let (normal, rows) = held(&narrow, run, local)?;
            gram += normal.matrix;
            towards += normal.gradient;
            let width = known.jacobian.len() / known.residuals.len().max(1);
            let mut sums = vec![0.0; width * new];
            for (own, new_ones) in known.jacobian.chunks_exact(width.max(1)).zip(rows.jacobian.chunks_exact(new)) {
                for (sums, &own) in sums.chunks_exact_mut(new).zip(own) {
                    sums.iter_mut().zip(new_ones).for_each(|(sum, &slope)| *sum += f64::from(own) * f64::from(slope));
                }
            }
            for (i, sums) in sums.chunks_exact(new).enumerate() {
                let place = if i < shared { i } else { first + i - shared };
                sums.iter().enumerate().for_each(|(j, sum)| along[(place, j)] += sum);
            }
            first += width.saturating_sub(shared);
        }
        let taken =
            |column: usize| self.fit.normal.solve(along.column(column).into_owned(), PROMISED, &self.fit.held());
        let Some(taken) = (0..new).map(taken).collect::<Option<Vec<_>>>() else { return Ok(None) };
        let with = |i: usize| (0..new).map(|j| gram[(i, j)] - along.column(i).dot(&taken[j])).collect();
        let left = (0..new).map(|i| towards[i] - along.column(i).dot(&self.step)).collect();
        Ok(Some(((0..new).map(with).collect(), left)))
    }

    /// The same products of changes of every row for each run by itself, the fit's own parameters held.
    pub(crate) fn products_of_runs(&self, changes: &[Vec<Vec<f64>>]) -> Vec<Products> {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let of = |(i, rows): (usize, &Rows)| {
            let with = |a: &Vec<Vec<f64>>| changes.iter().map(|b| dot(&a[i], &b[i])).collect();
            let left = changes.iter().map(|a| dot(&a[i], &rows.residuals));
            (changes.iter().map(with).collect(), left.collect())
        };
        self.rows.iter().enumerate().map(of).collect()
    }

    /// Squares that `model` promises, some strength of what it changes and a step of the fit's own parameters being taken;
    /// none where that cannot be told. A change that is not `signed` counts in its own direction only.
    pub(crate) fn promised(&self, model: &Model, signed: bool, runs: &[Run]) -> Result<Option<f64>, SimulateError> {
        let change = self.chord(model, runs)?.change;
        if change.squares > NOTHING {
            return Ok(self.explained(&change, signed));
        }
        let Some(narrow) = self.narrow(model) else { return Ok(None) };
        let locals = matching(self.fit.locals.clone(), model, runs);
        let tangent = |i: usize| -> Result<Vec<f64>, SimulateError> {
            let (mut rows, mut local) = (Rows::default(), locals[i].clone());
            local.values_mut().for_each(|value| value.free = false);
            normal(&narrow, &runs[i], &local, Some(&mut rows))?;
            Ok(rows.jacobian.iter().map(|&slope| f64::from(slope)).collect())
        };
        Ok(self.explained(&self.change(tangent)?, true))
    }

    /// The model with nothing free but the one free parameter of the effect it has beyond the fit; none where that has
    /// several.
    fn narrow(&self, model: &Model) -> Option<Model> {
        let known = self.fit.model.ids();
        let new = model.effects.iter().position(|placed| !known.contains(&placed.entry.id))?;
        let mut free = (0..).zip(&model.effects[new].values).filter(|(_, value)| value.free).map(|(i, _)| i);
        let (Some(only), None): (Option<usize>, _) = (free.next(), free.next()) else { return None };
        let mut narrow = model.clone();
        narrow.values_mut().for_each(|value| value.free = false);
        narrow.effects[new].values[only].free = true;
        Some(narrow)
    }

    /// Sums up what changes each run's rows.
    fn change<R: AsRef<[f64]>>(&self, of: impl Fn(usize) -> Result<R, SimulateError>) -> Result<Change, SimulateError> {
        let mut change = Change { squares: 0.0, towards: 0.0, along: DVector::zeros(self.step.len()) };
        let shared = self.fit.model.free_values();
        let mut first = shared;
        for (i, rows) in self.rows.iter().enumerate() {
            let width = rows.jacobian.len() / rows.residuals.len().max(1);
            change.add(rows, of(i)?.as_ref(), width, |i| if i < shared { i } else { first + i - shared });
            first += width.saturating_sub(shared);
        }
        Ok(change)
    }

    fn explained(&self, change: &Change, signed: bool) -> Option<f64> {
        let gradient = &self.fit.normal.gradient;
        let without = self.fit.squares - gradient.dot(&self.step);
        if !change.squares.is_finite() {
            return Some(f64::INFINITY);
        }
        let taken = self.fit.normal.solve(change.along.clone(), PROMISED, &self.fit.held())?;
        let left = change.squares - change.along.dot(&taken);
        let gain = change.towards - change.along.dot(&self.step);
        if left <= NOTHING * change.squares || (gain <= 0.0 && !signed) {
            return Some(without);
        }
        Some(without - gain * gain / left)
    }
}

/// What a model changes of every row, kept to be summed up with other changes.
#[derive(Debug)]
pub(crate) struct Chord {
    rows: Vec<Vec<f64>>,
    change: Change,
}

impl Chord {
    /// What it changes of those rows alone that `there` lets through by run and row, run by run.
    pub(crate) fn only(&self, there: impl Fn(usize, usize) -> bool) -> Vec<Vec<f64>> {
        let of = |(run, rows): (usize, &Vec<f64>)| {
            let kept = |(row, change): (usize, &f64)| if there(run, row) { *change } else { 0.0 };
            rows.iter().enumerate().map(kept).collect()
        };
        self.rows.iter().enumerate().map(of).collect()
    }
}

/// A change of every row, against the residuals and against the fit's own parameters.
#[derive(Debug)]
struct Change {
    squares: f64,
    towards: f64,
    along: DVector<f64>,
}

impl Change {
    fn add(&mut self, rows: &Rows, changes: &[f64], width: usize, place: impl Fn(usize) -> usize) {
        let mut along = vec![0.0; width];
        let sensitivities = rows.jacobian.chunks_exact(width.max(1));
        for ((residual, sensitivities), change) in rows.residuals.iter().zip(sensitivities).zip(changes) {
            self.squares += change * change;
            self.towards += change * residual;
            for (sum, &sensitivity) in along.iter_mut().zip(sensitivities) {
                *sum += change * f64::from(sensitivity);
            }
        }
        for (i, sum) in along.into_iter().enumerate() {
            self.along[place(i)] += sum;
        }
    }
}
