//! Limits on velocity with other corners than the hard clamp, and other levels either side.

use crate::lab::closure::Map;
use crate::lab::forms::{Dial, Parameters};
use crate::lab::law::Place;
use crate::lab::plant::Plant;
use std::f64::consts::LN_2;

/// The sharpness at which the library's corner passes the same point where the demand is the limit.
fn sharpness(there: f64) -> Parameters {
    vec![("sharpness", LN_2 / -there.clamp(0.3, 0.999).ln())]
}

fn smooth_minimum(asked: f64, most: f64, width: f64) -> f64 {
    let rise = |x: f64| if x > 30.0 { x } else { x.exp().ln_1p() };
    asked - width * (rise((asked - most) / width) - rise(-most / width))
}

/// Two restrictions in a row.
pub(super) fn soft_minimum(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (limit, share) = (dial.scales.limit, 0.35 * dial.s);
    plant.add(Place::Limit, Map(move |_, d: f64| d.signum() * smooth_minimum(d.abs(), limit, share * limit)));
    sharpness(1.0 - share * LN_2)
}

/// A port that runs out over the last part of its opening.
pub(super) fn knee(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (limit, share) = (dial.scales.limit, (0.9 * dial.s).min(0.9));
    let from = (1.0 - share) * limit;
    let bend = move |a: f64| if a < from { a } else { from + share * limit * ((a - from) / (share * limit)).tanh() };
    plant.add(Place::Limit, Map(move |_, d: f64| d.signum() * bend(d.abs())));
    sharpness(bend(limit) / limit)
}

/// A line in front of the valve takes pressure with the square of the flow; the spool has its end.
pub(super) fn line(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (limit, share) = (dial.scales.limit, 0.8 * dial.s);
    let flow = move |a: f64| (a / (1.0 + share * (a / limit).powi(2)).sqrt()).min(limit);
    plant.add(Place::Limit, Map(move |_, d: f64| d.signum() * flow(d.abs())));
    sharpness(flow(limit) / limit)
}

fn levels(dial: &Dial) -> (f64, f64) {
    let off = 0.25 * dial.draw.sign * dial.s;
    (dial.scales.limit * (1.0 + off), dial.scales.limit * (1.0 - off))
}

/// Unequal areas, with a corner that is a little round.
pub(super) fn sides(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (positive, negative) = levels(dial);
    let round = dial.draw.between(0, 0.01, 0.04);
    let most = move |d: f64| if d > 0.0 { positive } else { negative };
    plant.add(Place::Limit, Map(move |_, d: f64| d.signum() * smooth_minimum(d.abs(), most(d), round * most(d))));
    vec![("positive", positive), ("negative", negative)]
}

/// A throttle in one direction: its limit is approached, the other's is a stop.
pub(super) fn throttled(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (positive, negative) = levels(dial);
    let bend = move |a: f64, most: f64| a / (1.0 + (a / most).powi(10)).powf(0.1);
    plant.add(Place::Limit, Map(move |_, d: f64| if d > 0.0 { bend(d, positive) } else { d.max(-negative) }));
    vec![("positive", positive), ("negative", negative)]
}

/// Stops of the spool that move a little as it warms.
pub(super) fn creeping(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (positive, negative) = levels(dial);
    let (creep, time) = (dial.draw.between(0, -0.02, 0.02), dial.scales.duration);
    plant.add(
        Place::Limit,
        Map(move |now, d: f64| {
            let warm = 1.0 + creep * (1.0 - (-now.t / time).exp());
            d.clamp(-negative * warm, positive * warm)
        }),
    );
    vec![("positive", positive), ("negative", negative)]
}
