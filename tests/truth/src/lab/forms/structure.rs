//! What is mounted on the table and what it stands on. Stretches m, absolute velocities m/s, forces per table mass m/s2.

mod base;
mod payload;

use super::{ACCELEROMETER, ANY, Dial, Form, Needs, Parameters, SERVO};
use crate::lab::plant::Plant;

const fn form(
    effect: &'static str,
    name: &'static str,
    source: &'static str,
    build: fn(&mut Plant, &Dial) -> Parameters,
    needs: Needs,
) -> Form {
    Form { effect, name, source, build, needs }
}

/// The floor moves: only a servo model with an accelerometer tells.
const BASE: Needs = Needs { servo: SERVO.servo, ..ACCELEROMETER };

pub(super) const FORMS: &[Form] = &[
    form("payload_resonance", "two storeys", "shear frame with a second mode", payload::storeys, ANY),
    form(
        "payload_resonance",
        "sloshing tank",
        "Housner: pendulum mass that hardens, rigid mass beside it",
        payload::sloshing,
        ANY,
    ),
    form("payload_resonance", "yielding frame", "Bouc-Wen hysteresis", payload::yielding, ANY),
    form("payload_resonance", "cracking wall", "stiffness that sinks with the largest drift", payload::cracking, ANY),
    form("base_compliance", "hardening soil", "reaction mass on a cubic spring", base::hardening, BASE),
    form("base_compliance", "soil with hysteresis", "springs with plays", base::hysteretic, BASE),
    form("base_compliance", "sway and rocking", "two modes of the reaction mass", base::rocking, BASE),
];

#[cfg(test)]
mod tests {
    use super::super::of;
    use crate::lab::engine::simulate;
    use crate::lab::plant::Plant;
    use crate::lab::stated::{Controller, Kind, Run};
    use crate::lab::testing::{dial, servo};
    use crate::refit::squares;
    use std::f64::consts::TAU;

    /// Amplitude ratio of the accelerometer with and without the structure at a frequency (Hz).
    fn ratio(plant: &Plant, frequency: f64) -> f64 {
        let dt = 2e-3;
        let reference: Vec<f64> = (0..6000)
            .map(|k| {
                let t = f64::from(k) * dt;
                2e-3 * (t / 4.0).min(1.0) * (TAU * frequency * t).sin()
            })
            .collect();
        let run = Run { reference, dt, controller: Controller::plain(Kind::Pi { kp: 5.0, ki: 0.0 }), number: 0 };
        let size = |p: &Plant| squares(&simulate(p, &run, None).unwrap().acceleration[4000..]);
        (size(plant) / size(&Plant::baseline(servo()))).sqrt()
    }

    #[test]
    fn structures_are_felt_near_their_frequency_and_little_far_below() {
        for effect in ["payload_resonance", "base_compliance"] {
            for form in of(effect) {
                let mut plant = Plant::baseline(servo());
                let stated = (form.build)(&mut plant, &dial(0.4));
                let frequency = stated.iter().find(|p| p.0 == "frequency").unwrap().1;
                let near = [0.8, 0.95, 1.1]
                    .map(|f| (ratio(&plant, f * frequency) - 1.0).abs())
                    .into_iter()
                    .fold(0.0, f64::max);
                let below = (ratio(&plant, 0.15 * frequency) - 1.0).abs();
                assert!(near > 0.02 && near > 1.5 * below, "{}: {near} near {frequency} Hz, {below} below", form.name);
            }
        }
    }
}
