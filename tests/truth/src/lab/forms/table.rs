//! Forces on the table that are not dry friction: lubricant, springs, ends of the stroke. Per table mass (m/s2).

mod spring;
mod stop;

use super::{ANY, Dial, Form, Needs, Parameters};
use crate::lab::closure::{Map, States};
use crate::lab::law::Place;
use crate::lab::plant::Plant;

fn coefficient(dial: &Dial) -> (f64, Parameters) {
    let value = 0.6 * dial.scales.pole * dial.s;
    (value, vec![("coefficient", value * dial.scales.mass)])
}

/// A lubricant that thins with speed.
fn thinning(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (c, parameters) = coefficient(dial);
    let (about, n) = (0.5 * dial.scales.velocity, dial.draw.between(0, 0.02, 0.12));
    plant.add(Place::Force, Map(move |now, f: f64| f + c * now.v * (1.0 + (now.v / about).powi(2)).powf(-n)));
    parameters
}

/// A lubricant that warms with the work done on it.
fn warming(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (c, parameters) = coefficient(dial);
    let (share, way) = (dial.draw.between(0, 0.05, 0.25), 20.0 * dial.scales.stroke);
    plant.add(Place::Force, Map(move |now, f: f64| f + c * now.v * (1.0 - share * (1.0 - (-now.path / way).exp()))));
    parameters
}

/// A film that takes a moment to build up.
fn film(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (c, parameters) = coefficient(dial);
    let (share, time) = (dial.draw.between(0, 0.1, 0.4), dial.draw.log_between(1, 0.005, 0.05));
    plant.add(
        Place::Force,
        States {
            count: 1,
            fastest: 1.0 / time,
            rates: move |now, _, y, dy| dy[0] = (now.v - y[0]) / time,
            out: move |now, f: f64, y: &[f64]| f + c * ((1.0 - share) * now.v + share * y[0]),
        },
    );
    parameters
}

const VISCOUS: Needs = Needs { damping_known: true, ..ANY };

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
    form("viscous_friction", "thinning lubricant", "Carreau", thinning, VISCOUS),
    form("viscous_friction", "warming lubricant", "viscosity by work done", warming, VISCOUS),
    form("viscous_friction", "film that builds up", "a share with a lag", film, VISCOUS),
    form("spring", "hose bundle", "spring with plays in parallel", spring::hoses, ANY),
    form("spring", "inclined cables", "geometric stiffness", spring::cables, ANY),
    form("spring", "gas spring", "polytropic either side", spring::gas, ANY),
    form("end_stop", "cushion by an exponent", "elastomer that stiffens", stop::elastomer, ANY),
    form("end_stop", "Hunt and Crossley's contact", "Hunt, Crossley 1975", stop::hunt_crossley, ANY),
    form("end_stop", "oil cushion", "throttled outflow behind a spring", stop::oil, ANY),
];

#[cfg(test)]
mod tests {
    use super::super::of;
    use crate::lab::law::Now;
    use crate::lab::plant::Plant;
    use crate::lab::testing::{dial, servo};

    /// Force (m/s2) at a place moved to slowly.
    fn force(plant: &Plant, x: f64, v: f64) -> f64 {
        let (mut y, mut m) = plant.at_rest(0.0);
        let mut dy = y;
        let steps = 20_000;
        for k in 0..=steps {
            y[crate::lab::plant::X] = x * f64::from(k) / f64::from(steps);
            y[crate::lab::plant::Z] = v;
            let seen = plant.rates(&Now { v, ..Now::default() }, &y, &m, &mut dy);
            plant.remember(&seen, 1e-4, &y, &mut m);
            for i in 5..plant.used() {
                y[i] += 1e-4 * dy[i];
            }
        }
        dy[crate::lab::plant::IMPULSE]
    }

    #[test]
    fn springs_pull_as_stated_and_stops_only_beyond_their_place() {
        for form in of("spring") {
            let mut plant = Plant::baseline(servo());
            let stated = (form.build)(&mut plant, &dial(0.3));
            let x = 0.03;
            let textbook = stated[0].1 * x + stated[1].1 * x.powi(3);
            let made = force(&plant, x, 1e-4);
            assert!((made / textbook - 1.0).abs() < 0.25, "{}: {made} for {textbook}", form.name);
        }
        for form in of("end_stop") {
            let mut plant = Plant::baseline(servo());
            let stated = (form.build)(&mut plant, &dial(0.5));
            let (position, stiffness) = (stated[0].1, stated[1].1);
            assert_eq!(force(&plant, 0.98 * position, 1e-4), 0.0, "{}", form.name);
            let depth = 0.01;
            let made = force(&plant, position + depth, 1e-4) / (stiffness * depth);
            assert!(made > 0.4 && made < 2.0, "{}: {made} of a linear spring", form.name);
        }
    }

    #[test]
    fn lubricants_resist_about_in_proportion_to_speed() {
        for form in of("viscous_friction") {
            let mut plant = Plant::baseline(servo());
            let c = (form.build)(&mut plant, &dial(0.3))[0].1;
            let ratio = force(&plant, 1e-6, 0.1) / (c * 0.1);
            assert!(ratio > 0.7 && ratio < 1.01, "{}: {ratio}", form.name);
        }
    }
}
