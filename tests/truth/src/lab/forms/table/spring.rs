//! What pulls the table back to its middle.

use crate::lab::closure::{Map, Memories};
use crate::lab::forms::{Dial, Parameters};
use crate::lab::law::Place;
use crate::lab::plant::Plant;

fn stiffness(dial: &Dial) -> f64 {
    // At full strength as much as the largest acceleration at the largest displacement.
    2.0 * dial.s * dial.scales.acceleration / dial.scales.stroke
}

/// A hose bundle: a spring, and a share that drags along plays.
pub(super) fn hoses(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (k, share) = (stiffness(dial), dial.draw.between(0, 0.05, 0.2));
    let widths = [0.05, 0.15].map(|w| w * dial.scales.stroke);
    plant.add(
        Place::Force,
        Memories {
            count: 2,
            fastest: 0.0,
            remember: move |now, _, _, m: &mut [f64]| {
                for (play, width) in m.iter_mut().zip(widths) {
                    *play = play.clamp(now.x - width, now.x + width);
                }
            },
            out: move |now, f: f64, m: &[f64]| f + k * ((1.0 - share) * now.x + 0.5 * share * (m[0] + m[1])),
        },
    );
    let mass = dial.scales.mass;
    vec![("stiffness", k * mass), ("cubic", 0.0)]
}

/// Cables that stand across the motion: tension, and stretch by geometry.
pub(super) fn cables(plant: &mut Plant, dial: &Dial) -> Parameters {
    let k = stiffness(dial);
    // Length over stroke sets how soon the stretch is felt.
    let length = dial.draw.between(0, 1.5, 4.0) * dial.scales.stroke;
    let tension = dial.draw.between(1, 0.3, 0.9);
    plant.add(
        Place::Force,
        Map(move |now, f: f64| {
            let stretched = now.x.hypot(length);
            let pull = tension + (1.0 - tension) * (stretched - length) / (0.1 * length);
            f + k * now.x * pull * length / stretched
        }),
    );
    let cubic = k * (5.0 * (1.0 - tension) - 0.5 * tension) / (length * length);
    let mass = dial.scales.mass;
    vec![("stiffness", k * tension * mass), ("cubic", cubic * mass)]
}

/// Gas on either side of a balancing piston.
pub(super) fn gas(plant: &mut Plant, dial: &Dial) -> Parameters {
    let k = stiffness(dial);
    let n = dial.draw.between(0, 1.1, 1.4);
    let length = dial.draw.between(1, 2.0, 4.0) * dial.scales.stroke;
    plant.add(
        Place::Force,
        Map(move |now, f: f64| {
            let r = (now.x / length).clamp(-0.85, 0.85);
            f + 0.5 * k * length / n * ((1.0 - r).powf(-n) - (1.0 + r).powf(-n))
        }),
    );
    let mass = dial.scales.mass;
    vec![("stiffness", k * mass), ("cubic", k * (n + 1.0) * (n + 2.0) / (6.0 * length * length) * mass)]
}
