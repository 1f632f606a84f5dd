//! What the effects that a model has beyond a fit change, with all else held.

use super::matching;
use crate::identify::data::Run;
use crate::identify::evaluate::{Local, Rows, normal};
use crate::identify::model::Model;
use crate::identify::normal::Normal;
use crate::plant::simulate::SimulateError;

/// A model with nothing free but what effects have that another has not.
pub(super) fn only_new(model: &Model, known: &Model) -> Model {
    let known = known.ids();
    let mut narrow = model.clone();
    narrow.values_mut().for_each(|value| value.free = false);
    for (placed, free) in narrow.effects.iter_mut().zip(&model.effects).filter(|(p, _)| !known.contains(&p.entry.id)) {
        placed.values.clone_from(&free.values);
    }
    narrow
}

/// What a run is like under a model whose free values are all shared, and what those change of its rows.
pub(super) fn held(model: &Model, run: &Run, local: &Local) -> Result<(Normal, Rows), SimulateError> {
    let mut local = matching(vec![local.clone()], model, std::slice::from_ref(run)).swap_remove(0);
    local.values_mut().for_each(|value| value.free = false);
    let mut rows = Rows::default();
    let normal = normal(model, run, &local, Some(&mut rows))?;
    Ok((normal, rows))
}
