//! What can be wrong with an effect of a user's own beside its expression.

use super::super::{identifiers, remainder};
use super::expression::Tree;
use super::{Dimension, Key, Sense, State, Stated, StatedParameter, Wrong, grammar, wrong};

/// Most parameters.
const MOST: usize = 8;

fn is_name(text: &str) -> bool {
    let mut characters = text.chars();
    characters.next().is_some_and(|c| c.is_ascii_lowercase())
        && characters.all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
}

pub(super) fn names(stated: &Stated) -> Result<(), Wrong> {
    if !is_name(&stated.id) {
        let why = format!("`{}` must be lower-case letters, digits and underscores, a letter first", stated.id);
        return Err(wrong(Key::Id, why));
    }
    if identifiers().contains(&stated.id.as_str()) || remainder::entries().any(|e| e.id == stated.id) {
        return Err(wrong(Key::Id, format!("`{}` is an effect of the library; choose another name", stated.id)));
    }
    for id in &stated.mistaken_for {
        if !identifiers().contains(&id.as_str()) {
            return Err(wrong(
                Key::MistakenFor,
                format!("`{id}` is no effect of the library; see `shakedown effects`"),
            ));
        }
    }
    if stated.parameters.is_empty() || stated.parameters.len() > MOST {
        let why = format!("{} parameters; an effect has 1 to {MOST}, which a fit estimates", stated.parameters.len());
        return Err(wrong(Key::Expression, why));
    }
    stated.parameters.iter().try_for_each(parameter)
}

fn parameter(p: &StatedParameter) -> Result<(), Wrong> {
    let refuse = |why: String| Err(wrong(Key::Parameter(p.name.clone()), why));
    if !is_name(&p.name) {
        return refuse("its name must be lower-case letters, digits and underscores, a letter first".into());
    }
    if State::named(&p.name).is_some() || grammar::FUNCTIONS.contains(&p.name.as_str()) {
        return refuse(format!("`{}` is the name of a state or a function; choose another", p.name));
    }
    if p.low >= p.high {
        return refuse(format!("`low` {} is not below `high` {}", p.low, p.high));
    }
    if !(p.low..=p.high).contains(&p.start) {
        return refuse(format!("`start` {} is not between `low` {} and `high` {}", p.start, p.low, p.high));
    }
    Ok(())
}

pub(super) fn states(stated: &Stated) -> Result<Vec<State>, Wrong> {
    let known = State::ALL.map(State::name).join(", ");
    let state = |name: &String| {
        State::ALL
            .into_iter()
            .find(|s| s.name() == name)
            .ok_or_else(|| wrong(Key::States, format!("`{name}` is no state; there are {known}")))
    };
    stated.states.iter().map(state).collect()
}

pub(super) fn used(stated: &Stated, states: &[State], tree: &Tree) -> Result<(), Wrong> {
    for state in states {
        let contact = *state == State::Velocity && tree.uses_state(State::VelocitySign);
        if !(contact || tree.uses_state(*state)) {
            return Err(wrong(Key::States, format!("`{}` is not in the expression; leave it out", state.name())));
        }
    }
    for (i, parameter) in stated.parameters.iter().enumerate() {
        if !tree.uses_parameter(i) {
            let why = "is not in the expression; leave it out or use it".to_owned();
            return Err(wrong(Key::Parameter(parameter.name.clone()), why));
        }
    }
    Ok(())
}

pub(super) fn units(stated: &Stated) -> Result<Vec<Dimension>, Wrong> {
    let unit =
        |p: &StatedParameter| Dimension::of_unit(&p.unit).map_err(|why| wrong(Key::Parameter(p.name.clone()), why));
    stated.parameters.iter().map(unit).collect()
}

pub(super) fn reach(stated: &Stated, sense: Sense, states: &[State]) -> Result<(), Wrong> {
    let Some(beyond) = states.iter().find(|s| !sense.states().contains(s)) else { return Ok(()) };
    let known = sense.states().iter().map(|s| s.name()).collect::<Vec<_>>().join(", ");
    let place = stated.stage.name();
    Err(wrong(Key::States, format!("`{}` cannot be had at the {place}; there are {known}", beyond.name())))
}

/// An accelerometer shows a mean over each sample; between samples there is nothing to remember.
pub(super) fn memory(sense: Sense, tree: &Tree) -> Result<(), Wrong> {
    if sense == Sense::Acceleration && tree.remembers() {
        let why = "`lag` and `play` cannot be had at the accelerometer; write the effect at the table or the displacement sensor";
        return Err(wrong(Key::Expression, why));
    }
    Ok(())
}
