//! Every class, in the order of tables: sensors, commands, link, settings, time, table, a shared LVDT, two faults.

mod device;
mod double;
mod sensors;
mod shared;
mod table;

use super::Channel;
use super::Promise::Harmless;
use super::{Class, Fault};
use crate::faults::dice::FaultRng;
use crate::faults::spoil::{BITS, SignalFault};
use device::DEVICE;
use double::DOUBLE;
use sensors::SENSORS;
use shared::SHARED;
use std::sync::LazyLock;
use table::TABLE;

/// Every class; the first is no fault.
pub static CLASSES: LazyLock<Vec<Class>> = LazyLock::new(|| {
    let none = [Class::new("none", "nothing", Harmless(0.0), |_| Fault::None)];
    [&none, SENSORS, DEVICE, TABLE, SHARED, DOUBLE].concat()
});

fn signal(channel: Channel, spoil: SignalFault) -> Fault {
    Fault::Signal(channel, spoil)
}

fn spikes(dice: &mut FaultRng, low: f64, high: f64) -> SignalFault {
    let length = 1 + dice.below(20) as u32;
    let period = if dice.chance(0.5) { u32::MAX } else { length + 30 + dice.below(400) as u32 };
    SignalFault::Spikes { height: dice.sign() * dice.scale(low, high), length, period }
}

fn returning(dice: &mut FaultRng) -> SignalFault {
    let rate = dice.sign() * dice.scale(0.02, 0.15);
    SignalFault::Returning { rate, most: dice.scale(0.01, 0.06), left: dice.uniform(0.0, 0.9) }
}

fn gain(dice: &mut FaultRng) -> SignalFault {
    SignalFault::Gain { left: dice.uniform(0.5, 1.5), over: dice.scale(1.0, 20.0) }
}

fn flicker(dice: &mut FaultRng) -> SignalFault {
    let length = 1 + dice.below(30) as u32;
    SignalFault::Flicker { length, period: length + dice.scale(5.0, 100.0) as u32 }
}

fn hum(dice: &mut FaultRng, low: f64, high: f64) -> SignalFault {
    SignalFault::Hum { amplitude: dice.scale(low, high), frequency: dice.scale(45.0, 420.0) }
}

/// A bit of a converter that covers `span` either way.
fn bit(dice: &mut FaultRng, span: f64) -> SignalFault {
    SignalFault::Bit { span, bit: dice.below(BITS[0] as usize) as u32, set: dice.chance(0.5) }
}

/// What a second displacement sensor may do.
fn second(dice: &mut FaultRng) -> SignalFault {
    match dice.below(5) {
        0 => SignalFault::Open,
        1 => SignalFault::Stuck,
        2 => SignalFault::Drifting(dice.sign() * dice.scale(5e-4, 1.0)),
        3 => SignalFault::Reversed,
        _ => gain(dice),
    }
}
