//! What is reported of an equation that became part of the model handed on.

use super::super::verdict::Conclusion;
use super::Found;
use super::grammar::Reach;
use super::placing::Piece;
use crate::identify::quantity::{Quantity, quantities};
use serde::Serialize;
use std::collections::BTreeMap;

/// An equation for unlisted physics, as it is reported.
#[derive(Debug, Clone, Serialize)]
pub struct Term {
    /// Identifier of the effect that it is in a model file.
    pub id: &'static str,
    /// Block of the signal path where it acts.
    pub place: &'static str,
    /// The equation.
    pub expression: String,
    /// The same in words.
    pub words: String,
    /// Its parameters with intervals.
    pub parameters: BTreeMap<String, Quantity>,
    /// Effects of the library that stand beside it.
    pub beside: Vec<&'static str>,
    /// Share of the stated model's misfit that the model with it removes, on the runs held out where there are any.
    pub share: f64,
    /// Share of random halves of the training in which the regression chooses the same place.
    pub stability: f64,
    /// Each of its terms along what it follows, over what the runs fitted reach.
    pub curves: Vec<Curve>,
}

/// A term along what it follows, memory and what multiplies it left out.
#[derive(Debug, Clone, Serialize)]
pub struct Curve {
    /// What it follows: `displacement velocity acceleration command path time`.
    pub state: &'static str,
    /// Its unit.
    pub unit: String,
    /// The state, the term there, and both ends of its 90 % interval.
    pub points: Vec<[f64; 4]>,
}

/// What is reported of an equation that is part of the model handed on; none where it is not.
pub(in super::super) fn reported(found: &Found, conclusion: &Conclusion) -> Option<Term> {
    let fit = &conclusion.accepted.fit;
    let placed = fit.model.effects.iter().find(|p| p.entry.id == found.id)?;
    let prefix = format!("{}.", found.id);
    let own = |(key, q): (String, Quantity)| Some((key.strip_prefix(&prefix)?.to_owned(), q));
    let parameters: BTreeMap<String, Quantity> = quantities(fit).into_iter().filter_map(own).collect();
    Some(Term {
        curves: found.pieces.iter().map(|piece| curve(piece, &parameters, &found.reach)).collect(),
        id: found.id,
        place: found.place,
        expression: placed.entry.equation.to_owned(),
        words: found.words.clone(),
        parameters,
        beside: found.judged.added.clone(),
        share: 1.0 - conclusion.left(),
        stability: found.stability,
    })
}

/// Points of a curve.
const POINTS: usize = 41;

fn curve(piece: &Piece, parameters: &BTreeMap<String, Quantity>, reach: &Reach) -> Curve {
    let term = piece.term;
    let of = |key: &String, end: fn(&Quantity) -> f64| parameters.get(key).map_or(0.0, end);
    let keys = piece.coefficients();
    let at = |end: fn(&Quantity) -> f64| keys.iter().map(|key| of(key, end)).collect::<Vec<f64>>();
    let length = of(&term.length_key(), |q| q.value);
    let (value, low, high) = (at(|q| q.value), at(|q| q.low.unwrap_or(f64::NAN)), at(|q| q.high.unwrap_or(f64::NAN)));
    let size = term.follows.reach(reach);
    let from = if term.follows.grows() { 0.0 } else { -size };
    let point = |i: usize| {
        let s = from + (size - from) * i as f64 / (POINTS - 1) as f64;
        let [a, b] = [&low, &high].map(|end| term.value(s, end, length));
        [s, term.value(s, &value, length), a.min(b), a.max(b)]
    };
    Curve { state: term.follows.state(), unit: term.state_unit(), points: (0..POINTS).map(point).collect() }
}
