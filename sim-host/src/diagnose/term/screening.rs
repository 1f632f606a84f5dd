//! What each term of the grammar would explain, from tangents of the whole loop.

use super::super::search::beginning;
use super::super::split::Weighing;
use super::grammar::{Follows, Form, Reach, Term};
use super::placing::{Piece, idle, reach};
use crate::identify::data::Run;
use crate::identify::evaluate::Local;
use crate::identify::fit::Fit;
use crate::identify::fit::tangents::{Addition, Tangents};
use crate::identify::model::{Model, ModelEffect};
use crate::plant::effects::own::Sense;
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// Coefficients in one simulation: as many as a dual number of the largest size holds.
const BATCH: usize = 24;
/// Samples that a screening looks at, about: the runs that leave most, until they have so many; and of a longer run its beginning, as
/// many seconds of it at least as halves can be drawn from.
const LOOKED: usize = 6_000;
const LASTING: f64 = 20.0;
/// Places with a state, of which forms with memory and waves are tried too.
const RICHER: usize = 4;
/// Candidates of one place and state that are handed on.
const ALIKE: usize = 2;
/// What each further parameter must add to a gain, as a share of it.
const PRICE: f64 = 0.04;
/// Halves of the training that the choice is repeated on.
const HALVES: usize = 30;

/// A term that deserves a fit.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    /// The term with the values that the regression gives it.
    pub(super) piece: Piece,
    /// Share of what is left beyond the noise that it takes away, by one linear step.
    pub(super) promised: f64,
    /// Share of random halves of the training in which the best term is at its place.
    pub(super) stability: f64,
}

/// One or two columns of the regression.
struct Column {
    term: Term,
    shape: Vec<f64>,
    addition: usize,
    columns: Vec<usize>,
    gain: f64,
    values: Vec<f64>,
}

/// The terms of those `here` that would explain most beside a fitted model, best first.
pub(super) fn screen(
    fit: &Fit,
    weighing: &Weighing,
    here: &dyn Fn(&Term) -> bool,
) -> Result<Vec<Candidate>, SimulateError> {
    let reach = reach(weighing);
    let (runs, locals) = telling(fit, weighing.fitted())?;
    let fit = Fit::resume(fit.model.clone(), locals, &runs)?;
    let tangents = Tangents::of(&fit, &runs)?;
    let kind = fit.model.kind;
    let asked: Vec<Term> = Term::plain(kind).into_iter().chain(Term::turning(kind)).filter(|term| here(term)).collect();
    let mut additions = Vec::new();
    let mut columns = regressed(&tangents, &fit.model, &asked, &reach, &mut additions)?;
    sort(&mut columns);
    let mut groups: Vec<Term> = Vec::new();
    for column in &columns {
        if groups.len() < RICHER && !groups.iter().any(|t| group(*t) == group(column.term)) {
            groups.push(column.term);
        }
    }
    let known = |term: &Term| columns.iter().any(|column| column.term == *term);
    let richer = groups.into_iter().flat_map(Term::richer).filter(|term| here(term) && !known(term));
    let richer: Vec<Term> = richer.collect();
    columns.extend(regressed(&tangents, &fit.model, &richer, &reach, &mut additions)?);
    sort(&mut columns);
    let stability = stabilities(&tangents, &additions, &columns);
    let mut taken: Vec<(Sense, Follows)> = Vec::new();
    let mut chosen = Vec::new();
    for column in columns {
        let key = group(column.term);
        if taken.iter().filter(|k| **k == key).count() < ALIKE {
            taken.push(key);
            let share = stability.iter().find(|(s, _)| *s == key.0).map_or(0.0, |(_, share)| *share);
            let piece = Piece { term: column.term, coefficients: column.values, shape: column.shape };
            let promised = column.gain / (fit.squares - fit.rows as f64).max(f64::MIN_POSITIVE);
            chosen.push(Candidate { piece, promised, stability: share });
        }
    }
    Ok(chosen)
}

fn group(term: Term) -> (Sense, Follows) {
    (term.sense, term.follows)
}

fn worth(column: &Column) -> f64 {
    column.gain * (1.0 - PRICE * (column.term.parameters() as f64 - 1.0))
}

fn sort(columns: &mut Vec<Column>) {
    columns.retain(|c| c.gain > 0.0);
    columns.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
}

/// The runs that leave most, with where they start.
fn telling(fit: &Fit, runs: &[Run]) -> Result<(Vec<Run>, Vec<Local>), SimulateError> {
    let excess = |run: &Run, local: &Local| {
        crate::identify::evaluate::predict(&fit.model, run, local).map_or(0.0, |predicted| {
            let channels = run.measured.iter().zip(&predicted.channels).filter(|(m, _)| m.judged);
            let square = |(y, m): (&f64, &f64), noise: f64| ((y - m) / noise).powi(2) - 1.0;
            let sum = channels.flat_map(|(m, p)| m.values.iter().zip(p).map(move |pair| square(pair, m.noise)));
            sum.filter(|x| x.is_finite()).sum()
        })
    };
    let mut ranked: Vec<(f64, usize)> =
        runs.iter().zip(&fit.locals).enumerate().map(|(i, (run, local))| (excess(run, local), i)).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut samples = 0;
    let mut kept: Vec<usize> = Vec::new();
    for (_, i) in ranked {
        if kept.is_empty() || samples + runs[i].len() <= LOOKED {
            samples += runs[i].len();
            kept.push(i);
        }
    }
    kept.sort_unstable();
    let shown = |i: usize| {
        let (run, local) = (&runs[i], &fit.locals[i]);
        let least = (LOOKED as f64).max(LASTING / run.dt) / run.len() as f64;
        let share = if least < 1.0 { beginning(&fit.model, run, local, least)? } else { 1.0 };
        Ok((run.beginning((share * run.len() as f64).ceil() as usize), local.clone()))
    };
    kept.into_iter().map(shown).collect()
}

/// Every term at every shape, regressed on all stretches.
fn regressed(
    tangents: &Tangents<'_>,
    model: &Model,
    terms: &[Term],
    reach: &Reach,
    additions: &mut Vec<Addition>,
) -> Result<Vec<Column>, SimulateError> {
    let mut wanted: Vec<(Term, Vec<f64>, Vec<ModelEffect>)> = Vec::new();
    for &term in terms {
        for shape in term.shapes(reach) {
            let count = if term.form == Form::Wave { 2 } else { 1 };
            let placed: Vec<ModelEffect> = (0..count).filter_map(|of| idle(term, of, &shape, reach)).collect();
            if placed.len() == count && !placed.iter().any(|p| model.ids().contains(&p.entry.id)) {
                wanted.push((term, shape, placed));
            }
        }
    }
    // An effect can be in a model once: the same term at another shape goes to another batch.
    let mut batches: Vec<Vec<(Term, Vec<f64>, Vec<ModelEffect>)>> = Vec::new();
    for entry in wanted {
        let fits = |batch: &Vec<(Term, Vec<f64>, Vec<ModelEffect>)>| {
            let size: usize = batch.iter().map(|(.., placed)| placed.len()).sum();
            size + entry.2.len() <= BATCH && batch.iter().all(|(term, ..)| *term != entry.0)
        };
        match batches.iter_mut().find(|batch| fits(batch)) {
            Some(batch) => batch.push(entry),
            None => batches.push(vec![entry]),
        }
    }
    let simulate = |batch: &Vec<(Term, Vec<f64>, Vec<ModelEffect>)>| {
        let all = batch.iter().flat_map(|(.., placed)| placed.iter().cloned());
        tangents.addition(&all.fold(model.clone(), |model, placed| model.with(placed)))
    };
    let simulated = batches.par_iter().map(simulate).collect::<Result<Vec<_>, _>>()?;
    let mut columns = Vec::new();
    for (batch, addition) in batches.into_iter().zip(simulated) {
        let Some(addition) = addition else { continue };
        let mut next = 0;
        for (term, shape, placed) in batch {
            let own: Vec<usize> = (next..next + placed.len()).collect();
            next += placed.len();
            if let Some(found) = tangents.regress(&addition, &own, |_| true) {
                let (gain, values) = (found.gain, found.values);
                columns.push(Column { term, shape, addition: additions.len(), columns: own, gain, values });
            }
        }
        additions.push(addition);
    }
    Ok(columns)
}

/// The share of random halves of the stretches in which the best term is at each place.
fn stabilities(tangents: &Tangents<'_>, additions: &[Addition], columns: &[Column]) -> Vec<(Sense, f64)> {
    // What explains little of the whole is the best of no half.
    let likely = &columns[..columns.len().min(40)];
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut shares: Vec<(Sense, f64)> = Vec::new();
    for _ in 0..HALVES {
        let taken: Vec<bool> = (0..tangents.stretches())
            .map(|_| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                state >> 63 == 1
            })
            .collect();
        let gain = |column: &&Column| {
            let found = tangents.regress(&additions[column.addition], &column.columns, |i| taken[i]);
            found.map_or(0.0, |f| f.gain * (1.0 - PRICE * (column.term.parameters() as f64 - 1.0)))
        };
        let gains: Vec<f64> = likely.par_iter().map(|c| gain(&c)).collect();
        let best = gains.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map(|(i, _)| likely[i].term.sense);
        if let Some(best) = best {
            match shares.iter_mut().find(|(sense, _)| *sense == best) {
                Some((_, share)) => *share += 1.0 / HALVES as f64,
                None => shares.push((best, 1.0 / HALVES as f64)),
            }
        }
    }
    shares
}
