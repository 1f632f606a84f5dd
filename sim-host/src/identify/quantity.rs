//! Fitted values with their uncertainty, by name, and the model file that holds them.

use super::fit::Fit;
use super::interval::{Interval, NINETY};
use crate::plant::effects::Role;
use crate::plant::model::Kind;
use crate::recording;
use serde::Serialize;
use std::collections::BTreeMap;

/// A number with its uncertainty and unit.
#[derive(Debug, Clone, Serialize)]
pub struct Quantity {
    /// The value.
    pub value: f64,
    /// Standard deviation; none where it was not estimated.
    pub std: Option<f64>,
    /// Lower end of the 90 % interval.
    pub low: Option<f64>,
    /// Upper end of the 90 % interval.
    pub high: Option<f64>,
    /// Unit.
    pub unit: &'static str,
}

/// Least standard deviation of a value, over the value, that can be an error: less is rounding, of a simulation whose derivatives run away.
const EXACT: f64 = 1e-10;

/// Every shared value of a fitted model by name, with intervals.
pub(crate) fn quantities(fit: &Fit) -> BTreeMap<String, Quantity> {
    let model = &fit.model;
    let rigid = model.kind == Kind::RigidMass;
    let own = model.kind.parameters().iter().map(|p| p.unit);
    let scale = model.scale.iter().map(|_| "unit of pressure per m/s2");
    let effects = model.effects.iter().flat_map(|placed| placed.entry.parameters);
    let units = own.chain(scale).chain(effects.map(|p| if rigid { p.rigid_unit } else { p.unit }));
    let rows = model.names().into_iter().zip(model.values()).zip(fit.deviations()).zip(units);
    rows.map(|(((name, value), deviation), unit)| {
        let std = (deviation.is_finite() && deviation > EXACT * value.value.abs()).then_some(deviation);
        let edge = |sign: f64| {
            std.map(|s| {
                if value.positive {
                    value.value * (sign * NINETY * s / value.value).exp()
                } else {
                    value.value + sign * NINETY * s
                }
            })
        };
        (name, Quantity { value: value.value, std, low: edge(-1.0), high: edge(1.0), unit })
    })
    .chain(sizes(fit))
    .collect()
}

/// The sizes that follow from the runs' own values ([`Role::Size`]): the root of the mean over the runs of their sum of squares. They
/// have no deviation, for no fit has them as a value.
fn sizes(fit: &Fit) -> Vec<(String, Quantity)> {
    let rigid = fit.model.kind == Kind::RigidMass;
    let mut first = 0;
    let mut sizes = Vec::new();
    for placed in &fit.model.effects {
        let parameters = placed.entry.parameters;
        let count = parameters.iter().filter(|p| p.role == Role::PerRun).count();
        let squares = fit.locals.iter().flat_map(|local| local.effects.iter().skip(first).take(count));
        let size = (squares.map(|v| v.value.powi(2)).sum::<f64>() / fit.locals.len().max(1) as f64).sqrt();
        first += count;
        sizes.extend(parameters.iter().filter(|p| p.role == Role::Size).map(|p| {
            let unit = if rigid { p.rigid_unit } else { p.unit };
            (format!("{}.{}", placed.entry.id, p.key), Quantity { value: size, std: None, low: None, high: None, unit })
        }));
    }
    sizes
}

/// The same with profile intervals, one a shared value in the order of [`super::model::Model::values`]. Where an end is
/// open there is no standard deviation either: the data do not determine the value, or from one side only.
pub(crate) fn profiled(fit: &Fit, intervals: &[Option<Interval>]) -> BTreeMap<String, Quantity> {
    let mut quantities = quantities(fit);
    for (name, interval) in fit.model.names().iter().zip(intervals) {
        let (Some(interval), Some(quantity)) = (interval, quantities.get_mut(name)) else { continue };
        (quantity.low, quantity.high) = (interval.low, interval.high);
        quantity.std = quantity.std.filter(|_| interval.is_closed());
    }
    quantities
}

/// The stated model with its fitted values and the effects that were added.
pub(crate) fn stated_with(stated: &recording::Model, fit: &Fit) -> recording::Model {
    stated_as(stated, fit, &quantities(fit))
}

/// The same with quantities that are at hand. What the data do not determine at all stays as it was stated.
pub(crate) fn stated_as(
    stated: &recording::Model,
    fit: &Fit,
    quantities: &BTreeMap<String, Quantity>,
) -> recording::Model {
    use recording::{Accuracy, Place, StatedEffect};
    let mut model = stated.clone();
    let accuracy = |q: &Quantity| Accuracy { std: q.std, low: q.low, high: q.high };
    for parameter in fit.model.kind.parameters() {
        let given = stated.baseline.parameters().iter().any(|(name, _)| *name == parameter.key);
        let known = |q: &&Quantity| q.std.is_some() || (given && (q.low.is_some() || q.high.is_some()));
        let Some(quantity) = quantities.get(parameter.key).filter(known) else { continue };
        if model.baseline.set(parameter.key, quantity.value) {
            model.accuracy.insert(parameter.key.to_owned(), accuracy(quantity));
        }
    }
    for placed in &fit.model.effects {
        let id = placed.entry.id;
        let shared = || placed.entry.parameters.iter().filter(|p| p.role != Role::PerRun);
        let values =
            shared().filter_map(|p| Some((p.key.to_owned(), quantities.get(&format!("{id}.{}", p.key))?.value)));
        let effect = StatedEffect {
            id: id.to_owned(),
            parameters: values.collect(),
            place: Place::file(std::path::Path::new("diagnosis")),
        };
        model.effects.retain(|e| e.id != id);
        model.effects.push(effect);
        for parameter in shared() {
            let name = format!("{id}.{}", parameter.key);
            if let Some(quantity) = quantities.get(&name) {
                model.accuracy.insert(name, accuracy(quantity));
            }
        }
    }
    model
}
