//! Terms of the grammar as effects of a model.

use super::super::split::Weighing;
use super::grammar::{Form, Memory, Reach, Term};
use super::writing::stated;
use crate::identify::data::Channel;
use crate::identify::model::{Model, ModelEffect, Value};
use crate::plant::effects::Entry;
use crate::plant::effects::own::{Own, found, register};
use crate::plant::model::Kind;

/// A term with the values it starts from: its coefficients, then what shapes it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    /// The term.
    pub(super) term: Term,
    /// Its coefficients: two of a wave, else one.
    pub(super) coefficients: Vec<f64>,
    /// A wave's length and what its memory needs.
    pub(super) shape: Vec<f64>,
}

impl Piece {
    /// The names of its coefficients.
    pub(super) fn coefficients(&self) -> Vec<String> {
        let slug = self.term.slug();
        match self.term.form {
            Form::Wave => vec![format!("even_{slug}"), format!("odd_{slug}")],
            _ => vec![format!("k_{slug}")],
        }
    }
}

/// Factor by which a length or a memory may move from where it was found.
const MOVES: f64 = 6.0;

/// Sizes of what the runs reach.
pub(super) fn reach(weighing: &Weighing) -> Reach {
    let sizes = weighing.signal_scales();
    let measured = |channel| {
        let runs = weighing.fitted().iter().filter_map(move |run| run.channel(channel));
        runs.flat_map(|m| m.values.iter().copied()).filter(|x| x.is_finite()).fold(0.0_f64, |most, x| most.max(x.abs()))
    };
    let seen = measured(Channel::Acceleration);
    // The swing of a sine with this stroke and speed where no accelerometer was there.
    let swing = sizes.speed * sizes.speed / sizes.displacement;
    Reach {
        place: sizes.displacement,
        velocity: sizes.speed,
        acceleration: if seen > 0.0 { seen } else { swing },
        command: 2.0 * sizes.command,
        time: sizes.duration,
        mass: if weighing.model().kind == Kind::RigidMass { sizes.force } else { 1.0 },
    }
}

/// The identifier of an equation of these terms.
pub(super) fn id(pieces: &[Piece]) -> Option<String> {
    let terms: Vec<Term> = pieces.iter().map(|p| p.term).collect();
    stated(&terms, None).map(|stated| stated.id)
}

/// The entry of an effect, made known where it is not yet; none where a user's file gave its name to another.
fn entry(terms: &[Term], screening: Option<usize>) -> Option<&'static Entry> {
    let stated = stated(terms, screening)?;
    match found(&stated.id) {
        Some((known, entry)) if *known == stated => Some(entry),
        Some(_) => None,
        None => register(Own::new(stated).ok()?).ok(),
    }
}

/// A term still at zero, for screening: its `of`-th coefficient alone.
pub(super) fn idle(term: Term, of: usize, shape: &[f64], reach: &Reach) -> Option<ModelEffect> {
    let screening = (term.form == Form::Wave).then_some(of);
    let entry = entry(&[term], screening)?;
    let most = term.most(reach);
    let mut values = vec![Value { value: 0.0, low: -most, high: most, positive: false, free: true, prior: None }];
    values.extend(shape.iter().map(|&value| Value::fixed(value)));
    (values.len() == entry.parameters.len()).then_some(ModelEffect { entry, values })
}

/// The model of `parent` with the values that `base` has and one effect of these terms.
pub(super) fn model_with(parent: &Model, base: &Model, pieces: &[Piece], reach: &Reach) -> Option<Model> {
    let terms: Vec<Term> = pieces.iter().map(|p| p.term).collect();
    let entry = entry(&terms, None)?;
    let mut values = Vec::new();
    // What an equation has already stands in `base` as fitted.
    let known = pieces.split_last().and_then(|(_, before)| {
        let id = id(before)?;
        base.effects.iter().find(|p| p.entry.id == id).map(|p| p.values.clone())
    });
    let before: usize = pieces.iter().rev().skip(1).map(|p| p.coefficients.len() + p.shape.len()).sum();
    let known = known.filter(|values| values.len() == before).unwrap_or_default();
    values.extend(known.iter().copied());
    let rest = if known.is_empty() { pieces } else { &pieces[pieces.len() - 1..] };
    for piece in rest {
        let most = piece.term.most(reach);
        values.extend(piece.coefficients.iter().map(|&value| Value {
            value: value.clamp(-most, most),
            low: -most,
            high: most,
            positive: false,
            free: true,
            prior: None,
        }));
        values.extend(piece.shape.iter().map(|&value| Value {
            value,
            low: value / MOVES,
            high: value * MOVES,
            positive: true,
            // Where a relay switches has no slope to follow.
            free: piece.term.memory != Memory::Relay,
            prior: None,
        }));
    }
    let mut model = parent.clone();
    for (value, fitted) in model.own.iter_mut().zip(&base.own) {
        *value = *fitted;
    }
    if let (Some(scale), Some(fitted)) = (&mut model.scale, &base.scale) {
        *scale = *fitted;
    }
    for placed in &mut model.effects {
        if let Some(fitted) = base.effects.iter().find(|p| p.entry.id == placed.entry.id) {
            placed.values.clone_from(&fitted.values);
        }
    }
    (values.len() == entry.parameters.len()).then(|| model.with(ModelEffect { entry, values }))
}
