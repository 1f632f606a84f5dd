//! Oil between valve and piston, and what passes the piston.

mod chambers;
mod hose;
mod stiff;

use super::{Dial, Form, Needs, Parameters, SERVO};
use crate::lab::closure::Map;
use crate::lab::law::Place;
use crate::lab::plant::Plant;
pub use chambers::Chambers;
pub use hose::Airy;
use std::f64::consts::TAU;
pub use stiff::Stiff;

/// Frequency (Hz) and damping ratio of the oil column: the loop must stay stable on it.
fn oil(dial: &Dial) -> (f64, f64) {
    let slowest = 1.2 * dial.scales.crossover / TAU;
    let frequency = (slowest / dial.s.max(1e-3)).min(400.0);
    let least = 0.8 * dial.scales.crossover / (TAU * frequency);
    (frequency, dial.draw.log_between(0, 0.05, 0.3).max(least).min(0.8))
}

fn chambers(plant: &mut Plant, dial: &Dial, hose: Option<(f64, f64)>) -> Parameters {
    let (frequency, damping) = oil(dial);
    plant.set_column(Chambers {
        frequency,
        damping,
        stroke: dial.draw.between(1, 2.5, 6.0) * dial.scales.stroke,
        supply: (4.0 * dial.scales.acceleration).max(20.0),
        edges: false,
        hose,
    });
    vec![("frequency", frequency), ("damping", damping)]
}

fn two_chambers(plant: &mut Plant, dial: &Dial) -> Parameters {
    chambers(plant, dial, None)
}

fn with_hose(plant: &mut Plant, dial: &Dial) -> Parameters {
    chambers(plant, dial, Some((dial.draw.between(2, 0.15, 0.4), dial.draw.between(3, 0.002, 0.008))))
}

fn airy(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (frequency, damping) = oil(dial);
    let size = (2.0 * dial.scales.acceleration).max(8.0);
    plant.set_column(Airy { frequency, damping, air: dial.draw.between(2, 0.05, 0.3), size });
    vec![("frequency", frequency), ("damping", damping)]
}

fn leak(dial: &Dial) -> f64 {
    0.3 * dial.s / dial.scales.crossover
}

fn annulus(plant: &mut Plant, dial: &Dial) -> Parameters {
    let coefficient = leak(dial);
    let turbulent = dial.draw.between(0, 0.0, 0.2) * coefficient / dial.scales.acceleration;
    plant.add(
        Place::Leak,
        Map(move |now, lost: f64| {
            lost + coefficient * now.pressure / (1.0 + turbulent / coefficient * now.pressure.abs()).sqrt()
        }),
    );
    vec![("coefficient", coefficient)]
}

fn eccentric(plant: &mut Plant, dial: &Dial) -> Parameters {
    let coefficient = leak(dial);
    // The piston lies off its axis at one end of the stroke: the gap there leaks more.
    let (slope, reach) = (dial.draw.between(0, 0.1, 0.4), 2.0 * dial.scales.stroke);
    plant.add(
        Place::Leak,
        Map(move |now, lost: f64| {
            lost + coefficient * now.pressure * (1.0 + slope * (now.x / reach).clamp(-1.0, 1.0)).powi(3)
        }),
    );
    vec![("coefficient", coefficient)]
}

fn seal(plant: &mut Plant, dial: &Dial) -> Parameters {
    let coefficient = leak(dial);
    // A lip that lifts: little passes at small pressure, more in proportion beyond.
    let lift = dial.draw.between(0, 0.05, 0.3) * dial.scales.acceleration;
    plant.add(
        Place::Leak,
        Map(move |now, lost: f64| {
            let p: f64 = now.pressure;
            lost + coefficient * (p - 0.7 * lift * (p / lift).tanh())
        }),
    );
    vec![("coefficient", coefficient)]
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
    form("oil_compliance", "two chambers", "volumes that change with the stroke, entrained air", two_chambers, SERVO),
    form("oil_compliance", "chambers and hoses", "the same behind hoses that swell", with_hose, SERVO),
    form(
        "oil_compliance",
        "air in the oil",
        "stiffness that grows with pressure, damping by friction of the pipe",
        airy,
        SERVO,
    ),
    form("leakage", "annular gap", "laminar, turning turbulent", annulus, SERVO),
    form("leakage", "eccentric piston", "gap that depends on the stroke", eccentric, SERVO),
    form("leakage", "lifting seal", "little below a pressure, in proportion above", seal, SERVO),
];

#[cfg(test)]
mod tests {
    use super::super::of;
    use crate::lab::engine::simulate;
    use crate::lab::plant::Plant;
    use crate::lab::stated::{Controller, Kind, Run};
    use crate::lab::testing::{dial, held, open_loop, servo};

    #[test]
    fn oil_only_delays_what_a_held_command_gives_at_last_and_rings_near_its_frequency() {
        for form in of("oil_compliance") {
            let mut plant = Plant::baseline(servo());
            let mut set = dial(0.25);
            set.draw.u = [0.0, 0.9, 0.0, 0.0];
            let stated = (form.build)(&mut plant, &set);
            let full = held(&Plant::baseline(servo()), 0.05, 2.0);
            assert!((held(&plant, 0.05, 3.0) / full - 1.0).abs() < 0.03, "{}", form.name);
            let ringing = simulate(&plant, &open_loop(0.05, 1.0), None).unwrap().velocity;
            let away: Vec<f64> = ringing.iter().skip(60).map(|v| v - full).collect();
            let crossings = away.windows(2).filter(|w| w[0] * w[1] < 0.0).count();
            assert!(crossings >= 2, "{}: {crossings} crossings at {} Hz", form.name, stated[0].1);
        }
    }

    #[test]
    fn after_a_motion_the_leaking_table_rests_without_a_command() {
        let dt = 1e-3;
        let bump = |k: u32| 0.03 * (1.0 - (std::f64::consts::TAU * f64::from(k) / 500.0).cos()) * f64::from(k < 500);
        let controller = Controller::plain(Kind::Pi { kp: 5.0, ki: 4.0 });
        let run = Run { reference: (0..9000).map(bump).collect(), dt, controller, number: 0 };
        for form in of("leakage") {
            for s in [0.1, 0.3, 0.6, 1.0] {
                let mut plant = Plant::baseline(servo());
                (form.build)(&mut plant, &dial(s));
                let made = simulate(&plant, &run, None).expect(form.name);
                let most = |x: &[f64]| x.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
                let (moving, resting) = (most(&made.command), most(&made.command[8000..]));
                assert!(resting < 1e-3 * moving, "{} at {s}: {resting} of {moving}", form.name);
            }
        }
    }
}
