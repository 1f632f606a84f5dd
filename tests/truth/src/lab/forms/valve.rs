//! From the command to the spool's opening: offset, delay, overlap, spool dynamics, and what changes their gain.

mod overlap;
mod spool;

use super::{ANY, Dial, Form, Needs, Parameters, SERVO};
use crate::lab::closure::{Map, States};
use crate::lab::law::Place;
use crate::lab::plant::Plant;

fn null_bias(plant: &mut Plant, dial: &Dial) -> Parameters {
    let sign = dial.draw.sign;
    let (warming, time) = (dial.draw.between(0, -0.15, 0.15), dial.scales.duration);
    if dial.scales.mass > 1.0 {
        let force = sign * dial.s;
        plant.add(Place::Force, Map(move |now, f| f - force * (1.0 + warming * (1.0 - (-now.t / time).exp()))));
        return vec![("offset", force * dial.scales.mass)];
    }
    let offset = sign * 0.2 * dial.s * dial.scales.command;
    plant.add(Place::Command, Map(move |now, u| u + offset * (1.0 + warming * (1.0 - (-now.t / time).exp()))));
    vec![("offset", offset)]
}

fn command_delay(plant: &mut Plant, dial: &Dial) -> Parameters {
    let time = 0.4 * dial.s / dial.scales.crossover;
    plant.delay = (time, dial.draw.between(0, 0.0, 0.2));
    vec![("time", time)]
}

fn gain_drift(plant: &mut Plant, dial: &Dial) -> Parameters {
    let rate = dial.draw.sign * 0.6 * dial.s / dial.scales.duration;
    let time = dial.draw.log_between(0, 3.0, 10.0) * dial.scales.duration;
    plant.add(Place::Valve, Map(move |now, w| w * (1.0 + rate * time * (1.0 - (-now.t / time).exp()))));
    vec![("rate", rate)]
}

/// Gains either side of zero from a strength.
fn sides(dial: &Dial) -> (f64, f64) {
    let off = 0.5 * dial.draw.sign * dial.s;
    (1.0 + off, 1.0 - off)
}

fn areas(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (positive, negative) = sides(dial);
    // Single-rod piston: the two sides change over within the spool's lap.
    let lap = dial.draw.between(0, 0.003, 0.02) * dial.scales.command;
    let (mean, half) = (0.5 * (positive + negative), 0.5 * (positive - negative));
    plant.add(Place::Valve, Map(move |_, w| w * (mean + half * (w / lap).tanh())));
    vec![("positive", positive), ("negative", negative)]
}

fn ports(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (positive, negative) = sides(dial);
    // Ports cut to different depths: the difference grows over the first part of the opening.
    let full = dial.draw.between(0, 0.05, 0.25) * dial.scales.command;
    let gain = move |w: f64| {
        let side = if w > 0.0 { positive } else { negative };
        1.0 + (side - 1.0) * (w.abs() / (w.abs() + full)) * 1.15
    };
    plant.add(Place::Valve, Map(move |_, w| w * gain(w)));
    vec![("positive", positive), ("negative", negative)]
}

fn amplifier(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (positive, negative) = sides(dial);
    // Two output stages with a band of their own each.
    let pace = dial.draw.log_between(0, 400.0, 900.0);
    plant.add(
        Place::Command,
        States {
            count: 1,
            fastest: pace,
            rates: move |_, u, y, dy| dy[0] = pace * (u * if u > 0.0 { positive } else { negative } - y[0]),
            out: |_, _, y| y[0],
        },
    );
    vec![("positive", positive), ("negative", negative)]
}

const fn form(
    effect: &'static str,
    name: &'static str,
    source: &'static str,
    build: fn(&mut Plant, &Dial) -> Parameters,
    needs: Needs,
) -> Form {
    Form { effect, name, source, build, needs }
}

pub(super) const FORMS: &[Form] = &[
    form("null_bias", "offset that warms", "torque motor with temperature", null_bias, ANY),
    form("command_delay", "buffer with scatter", "network controller", command_delay, ANY),
    form("gain_drift", "gain that settles", "oil that warms", gain_drift, SERVO),
    form("asymmetric_gain", "unequal areas", "single-rod piston", areas, ANY),
    form("asymmetric_gain", "unequal ports", "port gradients that differ", ports, ANY),
    form("asymmetric_gain", "unequal amplifier stages", "two output stages with a pole", amplifier, ANY),
    form("valve_deadband", "round ports", "area of a circular segment beyond the lap", overlap::round_ports, ANY),
    form("valve_deadband", "leaking lap", "flow through the radial clearance within the lap", overlap::leaking, ANY),
    form("valve_deadband", "spool that sticks", "lap with stiction of the spool", overlap::sticking, ANY),
    form("valve_lag", "torque motor and spool", "third order", spool::third_order, ANY),
    form("valve_lag", "spool with limited force", "second order, acceleration saturates", spool::limited_force, ANY),
    form(
        "valve_lag",
        "spool with flow forces",
        "second order, stiffness and damping grow with opening",
        spool::flow_forces,
        ANY,
    ),
    form("valve_rate_limit", "pilot stage", "tanh of the pilot's opening", spool::pilot, SERVO),
    form("valve_rate_limit", "pilot with inertia", "second order with limited rate", spool::inertial, SERVO),
    form("valve_rate_limit", "pilot fed from both sides", "rate unequal by direction", spool::unequal, SERVO),
];

#[cfg(test)]
mod tests {
    use super::super::{Dial, Form, of};
    use crate::effect::Draw;
    use crate::lab::plant::Plant;
    use crate::lab::testing::{dial, held, servo};

    fn plant(form: &Form, dial: &Dial) -> Plant {
        let mut plant = Plant::baseline(servo());
        (form.build)(&mut plant, dial);
        plant
    }

    #[test]
    fn a_held_command_gives_the_stated_models_speed_behind_every_slow_valve() {
        for effect in ["valve_lag", "valve_rate_limit", "command_delay"] {
            for form in of(effect) {
                let v = held(&plant(&form, &dial(0.3)), 0.02, 1.5);
                assert!((v / held(&Plant::baseline(servo()), 0.02, 1.5) - 1.0).abs() < 0.06, "{}: {v} m/s", form.name);
            }
        }
    }

    #[test]
    fn the_lap_loses_about_its_half_width_of_a_large_command_and_nearly_all_of_a_small_one() {
        let full = held(&Plant::baseline(servo()), 0.05, 1.5);
        for form in of("valve_deadband") {
            let mut set = dial(0.5);
            set.draw = Draw { u: [0.3; 4], ..set.draw };
            let mut plant = Plant::baseline(servo());
            let width = (form.build)(&mut plant, &set)[0].1;
            let large = held(&plant, 0.05, 1.5) / full;
            let small = held(&plant, 0.4 * width, 1.5) / (0.4 * width / 0.05 * full);
            assert!((large - (1.0 - width / 0.05)).abs() < 0.45 * width / 0.05, "{}: {large} of {width}", form.name);
            assert!(small < 0.35, "{}: {small} within the lap", form.name);
        }
    }

    #[test]
    fn the_two_directions_differ_as_stated() {
        for form in of("asymmetric_gain") {
            let mut plant = Plant::baseline(servo());
            let parameters = (form.build)(&mut plant, &dial(0.3));
            let ratio = held(&plant, 0.05, 1.0) / -held(&plant, -0.05, 1.0);
            let stated = parameters[0].1 / parameters[1].1;
            assert!((ratio / stated - 1.0).abs() < 0.1, "{}: {ratio} for {stated}", form.name);
        }
    }
}
