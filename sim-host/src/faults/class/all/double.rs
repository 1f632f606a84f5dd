//! Two faults at once, and a hydraulic block that is slower than declared: nothing is promised of these, what they do is
//! measured, and the measure against them is outside the device.

use super::super::Promise::Measured;
use super::super::{Class, Fault};
use super::{DEVICE, SENSORS, TABLE};
use crate::faults::dice::FaultRng;
use crate::faults::machine::{BLOCK, PlantFault};

fn hard_over(dice: &mut FaultRng) -> Fault {
    Fault::Table(PlantFault::Stuck(dice.sign() * dice.scale(0.12, 10.0)))
}

/// Any fault of a sensor, or of the table but its relay.
fn any(dice: &mut FaultRng) -> Fault {
    let from = if dice.chance(0.7) { SENSORS } else { TABLE };
    let count = from.iter().filter(|class| class.id != "relay-welded").count();
    (from[dice.below(count)].deal)(dice)
}

/// Any fault of a sensor, a command or the table.
fn first(dice: &mut FaultRng) -> Fault {
    let from = if dice.chance(0.3) { DEVICE } else { return any(dice) };
    // The first classes are those of commands.
    (from[dice.below(10)].deal)(dice)
}

/// Every class of two faults.
pub(super) const DOUBLE: &[Class] = &[
    Class::new("two-faults", "two of the above, within 2 s of each other", Measured, first).with(any),
    Class::new(
        "hard-over-slow-block",
        "the valve stuck hard over, and a block that shuts in 30 to 300 ms",
        Measured,
        hard_over,
    )
    .with(|d| Fault::Block(d.scale(BLOCK, 0.3))),
    Class::new("hard-over-relay-welded", "the valve stuck hard over, and the relay welded", Measured, hard_over)
        .with(|_| Fault::Welded),
    Class::new("any-slow-block", "one of the above, and a block that shuts in 30 to 300 ms", Measured, first)
        .with(|d| Fault::Block(d.scale(BLOCK, 0.3))),
];
