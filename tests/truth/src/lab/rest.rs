//! What every form and every unlisted kind owes whatever its equation: the table comes to rest without a command unless the
//! law has a reason, an odd law answers the opposite motion with the opposite, and the integration step does not matter.

use super::engine::simulate;
use super::forms::{Dial, all};
use super::law::{Law, Now, Place};
use super::plant::Plant;
use super::stated::{Controller, Kind, Run};
use super::testing::{dial, servo};
use super::unlisted::grammar::Built;
use super::unlisted::{BUILT, NAMED};
use crate::closed_loop::Traces;
use crate::effect::Draw;
use crate::plant::Machine;
use crate::refit::squares;
use std::f64::consts::{PI, TAU};

type Build = Box<dyn Fn(&mut Plant, &Dial)>;

/// Seconds at which the motion begins and ends.
const MOTION: (f64, f64) = (1.0, 5.0);
const SECONDS: f64 = 15.0;
/// As slow as cases are sampled with a loop of this speed: the step is then the longest.
const DT: f64 = 4e-3;
const SIZE: f64 = 0.03;

/// Forms and kinds that may rest with a command or with an error, and why.
const NO_REST: &[(&str, &str)] = &[
    ("null_bias", "an offset by nature"),
    ("coulomb_friction", "a stuck table holds against a command within the band"),
    ("stribeck_friction", "a stuck table holds against a command within the band"),
    ("rough patch of the guide", "friction"),
    ("random break-away", "friction"),
    ("friction that ages", "friction"),
    ("valve_deadband", "any command within the lap is rest"),
    ("torque-motor hysteresis", "remembers a command"),
    ("displacement core with play", "the loop hunts within the play"),
    ("spring/hose bundle", "plays that hold a force"),
    ("ripple per distance", "a table may lie in any trough"),
    ("amplifier oscillates", "never at rest"),
    ("external shaking", "never at rest"),
];

/// Forms and kinds whose two directions differ, and why.
const NOT_ODD: &[(&str, &str)] = &[
    ("null_bias", "an offset by nature"),
    ("asymmetric_gain", "its directions differ by nature"),
    ("asymmetric_limit", "its directions differ by nature"),
    ("valve_rate_limit/pilot fed from both sides", "its directions differ by nature"),
    ("leakage/eccentric piston", "a gap wider at one end of the stroke"),
    ("displacement_nonlinearity", "a centre beside the middle"),
    ("acceleration_bias", "an offset by nature"),
    ("mains_hum", "a course in time"),
    ("amplifier oscillates", "a course in time"),
    ("external shaking", "a course in time"),
    ("gain depends on place", "differs along the stroke"),
    ("rough patch of the guide", "beside the middle"),
    ("guide that binds off its middle", "beside the middle"),
    ("ripple per distance", "a phase at the middle"),
    ("accelerometer slews", "compresses one side more"),
];

/// Forms and kinds whose switching falls on one step or the next, and why.
const SWITCHES: &[(&str, &str)] = &[
    ("coulomb_friction", "sticks and slips"),
    ("stribeck_friction", "sticks and slips"),
    ("random break-away", "another level at every reversal, however small"),
    ("valve_rate_limit", "a loop at its rate limit cycles"),
];

/// Does nothing but ask for short steps.
#[derive(Debug)]
struct Finer(f64);

impl Law for Finer {
    fn out(&self, _: &Now, input: f64, _: &[f64], _: &[f64]) -> f64 {
        input
    }

    fn fastest(&self) -> f64 {
        self.0
    }
}

/// Every form by `effect/name` and every kind with a name.
fn everything() -> Vec<(String, bool, Build)> {
    let forms = all().into_iter().map(|form| -> (String, bool, Build) {
        let name = format!("{}/{}", form.effect, form.name);
        (name, form.needs.servo, Box::new(move |plant, dial| drop((form.build)(plant, dial))))
    });
    let kinds = NAMED.iter().map(|kind| -> (String, bool, Build) {
        (kind.name.to_owned(), kind.needs.servo, Box::new(|plant, dial| (kind.build)(plant, dial)))
    });
    forms.chain(kinds).collect()
}

fn listed(name: &str, list: &[(&str, &str)]) -> bool {
    list.iter().any(|(start, _)| name.starts_with(start))
}

/// A rigid mass as quick as the servo model.
fn rigid() -> Machine {
    let (mass, pole) = (800.0, 57.65);
    Machine::Rigid { mass, viscous: pole * mass, gain: 138.0 * mass }
}

fn settings(machine: Machine, s: f64) -> [Dial; 3] {
    let draws = [([0.5; 4], 1.0), ([0.05; 4], -1.0), ([0.95; 4], 1.0)];
    draws.map(|(u, sign)| {
        let mut set = Dial { draw: Draw { sign, u }, ..dial(s) };
        if let Machine::Rigid { mass, .. } = machine {
            set.scales.mass = mass;
        }
        set
    })
}

fn plant(machine: Machine, build: &Build, set: &Dial) -> Plant {
    let mut plant = Plant::baseline(machine);
    build(&mut plant, set);
    plant
}

/// A burst about the middle of the stroke and a long rest, under a controller that integrates.
fn moved(plant: &Plant, sign: f64) -> Option<Traces> {
    let reference = (0..(SECONDS / DT) as usize).map(|k| {
        let t = k as f64 * DT;
        let through = ((t - MOTION.0) / (MOTION.1 - MOTION.0)).clamp(0.0, 1.0);
        sign * SIZE * (PI * through).sin().powi(2) * (TAU * 1.5 * (t - MOTION.0)).sin()
    });
    let controller = Controller::plain(Kind::Pi { kp: 5.0, ki: 4.0 });
    simulate(plant, &Run { reference: reference.collect(), dt: DT, controller, number: 0 }, None)
}

fn root_mean_square(x: &[f64]) -> f64 {
    (squares(x) / x.len() as f64).sqrt()
}

/// Mean over the last five seconds against the size during the motion; its window leaves out what still rings.
fn left(x: &[f64]) -> f64 {
    let tail = &x[((SECONDS - 5.0) / DT) as usize..];
    let moving = root_mean_square(&x[(MOTION.0 / DT) as usize..(MOTION.1 / DT) as usize]);
    let window = |k: usize| 2.0 * (PI * (k as f64 + 0.5) / tail.len() as f64).sin().powi(2);
    tail.iter().enumerate().map(|(k, v)| window(k) * v).sum::<f64>().abs() / tail.len() as f64 / moving
}

fn apart(x: &[f64], y: &[f64], sign: f64) -> f64 {
    let off: Vec<f64> = x.iter().zip(y).map(|(a, b)| a - sign * b).collect();
    root_mean_square(&off) / root_mean_square(x)
}

#[test]
fn after_a_motion_a_table_at_rest_needs_no_command() {
    for (name, needs_servo, build) in everything().iter().filter(|(name, ..)| !listed(name, NO_REST)) {
        for machine in [servo(), rigid()].into_iter().take(if *needs_servo { 1 } else { 2 }) {
            for set in settings(machine, 0.4) {
                let made = moved(&plant(machine, build, &set), 1.0).expect(name);
                let (command, place) = (left(&made.command), left(&made.displacement));
                assert!(command < 2e-3 && place < 2e-3, "{name} rests with {command} of its command, {place} off");
            }
        }
    }
}

#[test]
fn the_opposite_motion_has_the_opposite_answer() {
    for (name, needs_servo, build) in everything() {
        for machine in [servo(), rigid()].into_iter().take(if needs_servo { 1 } else { 2 }) {
            let set = settings(machine, 0.2)[2];
            let plant = plant(machine, &build, &set);
            let (there, back) = (moved(&plant, 1.0).expect(&name), moved(&plant, -1.0).expect(&name));
            let even = [
                apart(&there.displacement, &back.displacement, -1.0),
                apart(&there.acceleration, &back.acceleration, -1.0),
            ];
            let odd = even[0].max(even[1]) < 1e-9;
            assert_eq!(odd, !listed(&name, NOT_ODD), "{name}: {even:?}");
        }
    }
}

/// How far a quarter of the step moves the table otherwise, against its motion.
fn by_the_step(plant: &Plant) -> f64 {
    let mut finer = plant.clone();
    finer.add(Place::Acceleration, Finer(4.0 * plant.fastest().max(400.0)));
    match (moved(plant, 1.0), moved(&finer, 1.0)) {
        (Some(coarse), Some(fine)) => apart(&fine.displacement, &coarse.displacement, 1.0),
        (None, None) => 0.0,
        _ => f64::INFINITY,
    }
}

#[test]
fn the_integration_step_does_not_matter() {
    for (name, needs_servo, build) in everything() {
        let most = if listed(&name, SWITCHES) { 0.1 } else { 1e-3 };
        for machine in [servo(), rigid()].into_iter().take(if needs_servo { 1 } else { 2 }) {
            for set in settings(machine, 0.7) {
                let off = by_the_step(&plant(machine, &build, &set));
                assert!(off < most, "{name}, {:?}, {machine:?}: {off}", set.draw.u);
            }
        }
    }
}

#[test]
fn nor_does_it_for_what_the_grammar_builds() {
    for kind in (0..6).flat_map(|lock| (0..BUILT).map(move |i| Built::draw(lock, i))) {
        let build: Build = Box::new(move |plant, dial| kind.build(plant, dial));
        let off = by_the_step(&plant(servo(), &build, &dial(0.5)));
        assert!(off < 5e-3, "{}: {off}", kind.name());
    }
}

#[test]
fn nor_where_a_quick_motion_makes_a_force_steep() {
    let kind = NAMED.iter().find(|kind| kind.name == "friction that ages").unwrap();
    let mut set = dial(1.0);
    set.scales.acceleration = 15.0;
    for machine in [servo(), rigid()] {
        let mut plant = Plant::baseline(machine);
        (kind.build)(&mut plant, &set);
        let off = by_the_step(&plant);
        assert!(off < 0.02, "{machine:?}: {off}");
    }
}
