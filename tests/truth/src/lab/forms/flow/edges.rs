//! The valve's edges under load: flow by the root of the pressure that is left.

use crate::lab::closure::Map;
use crate::lab::forms::column::Chambers;
use crate::lab::forms::{Dial, Parameters};
use crate::lab::law::Place;
use crate::lab::plant::Plant;

fn stall(dial: &Dial) -> f64 {
    1.1 * dial.scales.acceleration / dial.s.max(1e-3)
}

/// The orifice law at each of the four edges, between chambers of stiff oil.
pub(super) fn four_edges(plant: &mut Plant, dial: &Dial) -> Parameters {
    let supply = stall(dial);
    plant.set_column(Chambers {
        frequency: dial.draw.between(0, 120.0, 200.0),
        damping: dial.draw.between(1, 0.3, 0.6),
        stroke: 5.0 * dial.scales.stroke,
        supply,
        edges: true,
        hose: None,
    });
    vec![("stall_acceleration", supply)]
}

/// One loaded edge whose flow is laminar at small pressure differences.
pub(super) fn laminar(plant: &mut Plant, dial: &Dial) -> Parameters {
    let supply = stall(dial);
    let bend = dial.draw.between(0, 0.02, 0.15);
    plant.add(
        Place::Edge,
        Map(move |now, q: f64| {
            let left = (1.0 - q.signum() * now.pressure / supply).clamp(-1.0, 2.0);
            let root = |r: f64| r / (r.abs() + bend).sqrt();
            q * root(left) / root(1.0)
        }),
    );
    vec![("stall_acceleration", supply)]
}

/// A return line whose back pressure grows with the square of the flow.
pub(super) fn back_pressure(plant: &mut Plant, dial: &Dial) -> Parameters {
    let supply = stall(dial);
    let back = dial.draw.between(0, 0.05, 0.25);
    let limit = dial.scales.limit;
    plant.add(
        Place::Edge,
        Map(move |now, q: f64| {
            let used = q.signum() * now.pressure / supply + back * (q / limit).powi(2).min(1.0);
            let left = (1.0 - used).clamp(-1.0, 2.0);
            q * left.signum() * left.abs().sqrt()
        }),
    );
    vec![("stall_acceleration", supply)]
}
