//! What tests of single laws share.

use super::engine::simulate;
use super::forms::{Dial, Scales};
use super::plant::Plant;
use super::stated::{Controller, Kind, Run};
use crate::effect::Draw;
use crate::plant::Machine;

/// A table of medium size.
pub(super) fn servo() -> Machine {
    Machine::Servo { b1: 0.69, b0: 138.0, a1: 57.65, velocity_limit: 0.242 }
}

/// A setting of middling draws.
pub(super) fn dial(s: f64) -> Dial {
    let scales = Scales {
        command: 0.1,
        command_rate: 1.5,
        stroke: 0.06,
        velocity: 0.2,
        acceleration: 3.0,
        duration: 20.0,
        crossover: 12.0,
        limit: 0.242,
        pole: 57.65,
        mass: 1.0,
        top: 5.0,
    };
    Dial { s, draw: Draw { sign: 1.0, u: [0.5; 4] }, scales }
}

/// A run that commands `command` openly: a controller of gain one whose error stays it.
pub(super) fn open_loop(command: f64, seconds: f64) -> Run {
    let dt = 1e-3;
    let law = Kind::Pi { kp: 1e-9, ki: 0.0 };
    // The reference is so far away that the motion does not change the error.
    let mut reference = vec![command * 1e9; (seconds / dt) as usize];
    reference[0] = 0.0;
    Run { reference, dt, controller: Controller::plain(law), number: 0 }
}

/// Velocity (m/s) after `seconds` of a held command.
pub(super) fn held(plant: &Plant, command: f64, seconds: f64) -> f64 {
    simulate(plant, &open_loop(command, seconds), None).and_then(|t| t.velocity.last().copied()).unwrap_or(f64::NAN)
}
