//! Lands wider than their ports, in three geometries.

use crate::lab::closure::{Map, Memories};
use crate::lab::forms::{Dial, Parameters};
use crate::lab::law::Place;
use crate::lab::plant::Plant;

fn half_width(dial: &Dial) -> f64 {
    0.15 * dial.scales.command * dial.s
}

/// Round ports: behind the lap the area grows as a circular segment's, then in proportion.
pub(super) fn round_ports(plant: &mut Plant, dial: &Dial) -> Parameters {
    let d = half_width(dial);
    let radius = dial.draw.between(0, 0.1, 0.4) * d;
    let area = move |open: f64| {
        // Slope grows from 0 as the square root until the port's chord is reached.
        if open < radius { 2.0 / 3.0 * open * (open / radius).sqrt() } else { open - radius / 3.0 }
    };
    plant.add(Place::Valve, Map(move |_, w: f64| w.signum() * area((w.abs() - d).max(0.0))));
    vec![("half_width", d)]
}

/// A lap with radial clearance: a little flows within it, and the edge is round.
pub(super) fn leaking(plant: &mut Plant, dial: &Dial) -> Parameters {
    let d = half_width(dial);
    let clearance = dial.draw.between(0, 0.05, 0.15) * d;
    let leak = dial.draw.between(1, 0.02, 0.08);
    plant.add(
        Place::Valve,
        Map(move |_, w: f64| {
            let beyond = w.abs() - d;
            let open = 0.5 * (beyond + beyond.hypot(clearance));
            w.signum() * (open - 0.5 * (d.hypot(clearance) - d)) * (1.0 - leak) + leak * w
        }),
    );
    vec![("half_width", d)]
}

/// A lap whose spool stays where it is until the command is some way off.
pub(super) fn sticking(plant: &mut Plant, dial: &Dial) -> Parameters {
    let d = half_width(dial);
    let stick = dial.draw.between(0, 0.03, 0.12) * d;
    plant.add(
        Place::Valve,
        Memories {
            count: 1,
            fastest: 0.0,
            remember: move |_, w: f64, _, m: &mut [f64]| m[0] = m[0].clamp(w - stick, w + stick),
            out: move |_, w: f64, m: &[f64]| {
                let spool = m[0].clamp(w - stick, w + stick);
                spool.signum() * (spool.abs() - d).max(0.0)
            },
        },
    );
    vec![("half_width", d)]
}
