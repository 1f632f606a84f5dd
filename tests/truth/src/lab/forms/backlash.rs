//! Lost motion between actuator and table in three forms, on the velocity that passes.

mod compliant;
mod contact;
mod hysteron;

use super::{ACCELEROMETER, Dial, Form, Parameters};
use crate::lab::law::Place;
use crate::lab::plant::Plant;
pub use compliant::CompliantPlay;
pub use contact::Contact;
pub use hysteron::Hysteron;

fn gap(dial: &Dial) -> f64 {
    (0.03 * dial.scales.stroke).min(2e-3) * dial.s
}

fn contact(plant: &mut Plant, dial: &Dial) -> Parameters {
    let law = Contact {
        gap: gap(dial),
        frequency: dial.draw.between(0, 60.0, 120.0),
        damping: dial.draw.between(1, 0.3, 0.7),
    };
    plant.add(Place::Link, law);
    vec![("gap", law.gap)]
}

fn hysteron(plant: &mut Plant, dial: &Dial) -> Parameters {
    let gap = gap(dial);
    plant.add(Place::Link, Hysteron::new(gap, dial.draw.between(0, 0.1, 0.4)));
    vec![("gap", gap)]
}

fn compliant(plant: &mut Plant, dial: &Dial) -> Parameters {
    let law = CompliantPlay { gap: gap(dial), pace: dial.draw.log_between(0, 400.0, 1200.0) };
    plant.add(Place::Link, law);
    vec![("gap", law.gap)]
}

pub(super) const FORMS: &[Form] = &[
    Form {
        effect: "backlash",
        name: "dead zone with contact",
        source: "table mass between two spring-damper stops",
        build: contact,
        needs: ACCELEROMETER,
    },
    Form {
        effect: "backlash",
        name: "hysterons",
        source: "Prandtl-Ishlinskii plays of several widths",
        build: hysteron,
        needs: ACCELEROMETER,
    },
    Form {
        effect: "backlash",
        name: "compliant play",
        source: "play with an elastic joint against the guide's viscous resistance",
        build: compliant,
        needs: ACCELEROMETER,
    },
];

#[cfg(test)]
mod tests {
    use super::{CompliantPlay, Contact, Hysteron};
    use crate::lab::law::Law;
    use crate::lab::law::Now;

    /// Distance that the table makes while the actuator goes there and back by `way` (m) slowly: least, then last place.
    fn travel(law: &dyn Law, way: f64) -> (f64, f64) {
        let (mut y, mut m) = (vec![0.0; law.states()], vec![0.0; law.memories()]);
        let mut dy = y.clone();
        law.at_rest(0.0, &mut y, &mut m);
        let (h, speed) = (2e-5, 2e-3);
        let (mut place, mut far) = (0.0_f64, 0.0_f64);
        let steps = (way / speed / h) as usize;
        for k in 0..2 * steps {
            let v = if k < steps { speed } else { -speed };
            let now = Now { v, ..Now::default() };
            law.remember(&now, v, h, &mut m);
            dy.fill(0.0);
            law.rates(&now, v, &y, &m, &mut dy);
            place += h * law.out(&now, v, &y, &m);
            for (state, rate) in y.iter_mut().zip(&dy) {
                *state += h * rate;
            }
            far = far.max(place);
        }
        (far, place)
    }

    #[test]
    fn the_table_loses_half_the_gap_first_and_the_whole_gap_at_each_turn() {
        let gap = 4e-4;
        let laws: [(&str, Box<dyn Law>); 3] = [
            ("contact", Box::new(Contact { gap, frequency: 80.0, damping: 0.5 })),
            ("hysterons", Box::new(Hysteron::new(gap, 0.3))),
            ("compliant play", Box::new(CompliantPlay { gap, pace: 800.0 })),
        ];
        for (name, law) in laws {
            let (far, last) = travel(law.as_ref(), 5e-3);
            assert!((far - (5e-3 - 0.5 * gap)).abs() < 0.15 * gap, "{name}: {far} m");
            assert!((last - 0.5 * gap).abs() < 0.15 * gap, "{name} ends at {last} m");
        }
    }
}
