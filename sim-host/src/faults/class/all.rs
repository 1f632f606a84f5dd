//! Every class, in the order of tables: sensors, commands, link, settings, time, table.

use super::Channel::{self, Acceleration, Command, Displacement};
use super::Promise::{Harmless, Inside, Relay, Reported};
use super::{Class, Clock, Fault};
use crate::faults::dice::Dice;
use crate::faults::machine::Break;
use crate::faults::spoil::Spoil;

fn signal(channel: Channel, spoil: Spoil) -> Fault {
    Fault::Signal(channel, spoil)
}

fn spikes(dice: &mut Dice, low: f64, high: f64) -> Spoil {
    let length = 1 + dice.below(20) as u32;
    let period = if dice.chance(0.5) { u32::MAX } else { length + 30 + dice.below(400) as u32 };
    Spoil::Spikes { height: dice.sign() * dice.scale(low, high), length, period }
}

fn gain(dice: &mut Dice) -> Spoil {
    Spoil::Gain { left: dice.uniform(0.5, 1.5), over: dice.scale(1.0, 20.0) }
}

/// Every class. Lengths in m, accelerations in m/s2.
pub const CLASSES: &[Class] = &[
    Class { id: "none", what: "nothing", promise: Harmless(0.0), deal: |_| Fault::None },
    Class {
        id: "lvdt-open",
        what: "LVDT: no number",
        promise: Reported(Clock::Onset, 0.013),
        deal: |_| signal(Displacement, Spoil::Open),
    },
    Class {
        id: "lvdt-saturated",
        what: "LVDT: at a rail of its converter",
        promise: Reported(Clock::Onset, 0.013),
        deal: |d| signal(Displacement, Spoil::Rail(0.1524 * 1.1 * d.sign())),
    },
    Class {
        id: "lvdt-clipped",
        what: "LVDT: held within 5 to 60 mm of the middle",
        promise: Harmless(0.04),
        deal: |d| signal(Displacement, Spoil::Clipped(d.uniform(0.005, 0.06))),
    },
    Class {
        id: "lvdt-stuck",
        what: "LVDT: stands where it stood, to the last bit",
        promise: Harmless(0.04),
        deal: |_| signal(Displacement, Spoil::Stuck),
    },
    Class {
        id: "lvdt-detached",
        what: "LVDT: stands where it stood, with noise of 0.01 to 0.2 mm",
        promise: Harmless(0.05),
        deal: |d| signal(Displacement, Spoil::Detached(d.scale(1e-5, 2e-4))),
    },
    Class {
        id: "lvdt-noisy",
        what: "LVDT: white noise of 0.1 to 30 mm",
        promise: Reported(Clock::Deviation(0.02), 0.1),
        deal: |d| signal(Displacement, Spoil::Noisy(d.scale(1e-4, 0.03))),
    },
    Class {
        id: "lvdt-drifting",
        what: "LVDT: moves away at 0.15 to 1 m/s",
        promise: Reported(Clock::Displacement(0.005), 0.5),
        deal: |d| signal(Displacement, Spoil::Drifting(d.sign() * d.scale(0.15, 1.0))),
    },
    Class {
        id: "lvdt-creeping",
        what: "LVDT: moves away at 0.5 to 150 mm/s",
        promise: Inside,
        deal: |d| signal(Displacement, Spoil::Drifting(d.sign() * d.scale(5e-4, 0.15))),
    },
    Class {
        id: "lvdt-spikes",
        what: "LVDT: spikes of 1 to 200 mm, 1 to 20 ms",
        promise: Harmless(0.03),
        deal: |d| signal(Displacement, spikes(d, 1e-3, 0.2)),
    },
    Class {
        id: "lvdt-gap",
        what: "LVDT: no number for 1 to 9 ms",
        promise: Harmless(0.02),
        deal: |d| signal(Displacement, Spoil::Gap(1 + d.below(9) as u32)),
    },
    Class {
        id: "lvdt-reversed",
        what: "LVDT: polarity turned",
        promise: Harmless(0.06),
        deal: |_| signal(Displacement, Spoil::Reversed),
    },
    Class {
        id: "accelerometer-open",
        what: "accelerometer: no number",
        promise: Reported(Clock::Onset, 0.013),
        deal: |_| signal(Acceleration, Spoil::Open),
    },
    Class {
        id: "accelerometer-saturated",
        what: "accelerometer: at a rail of its converter",
        promise: Reported(Clock::Onset, 0.013),
        deal: |d| signal(Acceleration, Spoil::Rail(61.0 * d.sign())),
    },
    Class {
        id: "accelerometer-stuck",
        what: "accelerometer: stands where it stood",
        promise: Harmless(0.05),
        deal: |_| signal(Acceleration, Spoil::Stuck),
    },
    Class {
        id: "accelerometer-off",
        what: "accelerometer: off by 3.5 to 20 m/s2",
        promise: Reported(Clock::Onset, 0.1),
        deal: |d| signal(Acceleration, Spoil::Offset(d.sign() * d.scale(3.5, 20.0))),
    },
    Class {
        id: "accelerometer-noisy",
        what: "accelerometer: white noise of 0.5 to 30 m/s2",
        promise: Harmless(0.05),
        deal: |d| signal(Acceleration, Spoil::Noisy(d.scale(0.5, 30.0))),
    },
    Class {
        id: "accelerometer-drifting",
        what: "accelerometer: moves away at 0.1 to 30 m/s3",
        promise: Reported(Clock::Acceleration(3.5), 0.3),
        deal: |d| signal(Acceleration, Spoil::Drifting(d.sign() * d.scale(0.1, 30.0))),
    },
    Class {
        id: "accelerometer-spikes",
        what: "accelerometer: spikes of 1 to 100 m/s2, 1 to 20 ms",
        promise: Harmless(0.05),
        deal: |d| signal(Acceleration, spikes(d, 1.0, 100.0)),
    },
    Class {
        id: "accelerometer-reversed",
        what: "accelerometer: polarity turned",
        promise: Harmless(0.05),
        deal: |_| signal(Acceleration, Spoil::Reversed),
    },
    Class {
        id: "command-lost",
        what: "reference or existing command: no number",
        promise: Reported(Clock::Onset, 0.013),
        deal: |_| signal(Command, Spoil::Open),
    },
    Class {
        id: "command-gap",
        what: "reference or existing command: no number for 1 to 9 ms",
        promise: Harmless(0.02),
        deal: |d| signal(Command, Spoil::Gap(1 + d.below(9) as u32)),
    },
    Class {
        id: "command-jump",
        what: "reference or existing command: jumps by 5 mm to 1 m",
        promise: Inside,
        deal: |d| signal(Command, Spoil::Offset(d.sign() * d.scale(0.005, 1.0))),
    },
    Class {
        id: "command-stuck",
        what: "reference or existing command: stands where it stood",
        promise: Inside,
        deal: |_| signal(Command, Spoil::Stuck),
    },
    Class {
        id: "command-runaway",
        what: "reference or existing command: moves away at 10 mm/s to 2 m/s",
        promise: Inside,
        deal: |d| signal(Command, Spoil::Drifting(d.sign() * d.scale(0.01, 2.0))),
    },
    Class {
        id: "link-cut",
        what: "no point of the stream arrives any more",
        promise: Reported(Clock::Onset, 1.1),
        deal: |_| Fault::LinkCut,
    },
    Class {
        id: "link-garbled",
        what: "one bit in 10^2 to 10^5 bytes of the stream is flipped",
        promise: Harmless(1e-9),
        deal: |d| Fault::LinkGarbled(d.scale(1e-5, 1e-2)),
    },
    Class {
        id: "settings-garbled",
        what: "a frame of settings with 1 to 64 bits flipped",
        promise: Harmless(1e-9),
        deal: |d| Fault::SettingsGarbled(1 + d.below(64) as u32),
    },
    Class {
        id: "settings-nonsense",
        what: "settings with one number no number, infinite, huge or negative",
        promise: Inside,
        deal: |_| Fault::SettingsNonsense,
    },
    Class {
        id: "settings-wrong",
        what: "gains off by factors up to 30, null by up to 5 mm",
        promise: Inside,
        deal: |d| Fault::SettingsWrong(d.scale(1.5, 30.0)),
    },
    Class {
        id: "jitter",
        what: "ticks longer or shorter by up to 1 to 30 %",
        promise: Inside,
        deal: |d| Fault::Jitter(d.scale(0.01, 0.3)),
    },
    Class {
        id: "missed-ticks",
        what: "1 to 20 ticks do not run",
        promise: Reported(Clock::Onset, 0.022),
        deal: |d| Fault::Missed(1 + d.below(20) as u32),
    },
    Class {
        id: "payload-loose",
        what: "the payload comes off and knocks",
        promise: Harmless(0.05),
        deal: |d| {
            let (mass, blow) = (d.uniform(0.1, 1.0), d.scale(2.0, 50.0));
            Fault::Table(Break::Payload { mass, blow, length: d.scale(0.003, 0.05), count: 1 + d.below(5) as u32 })
        },
    },
    Class {
        id: "supply-lost",
        what: "the supply falls with a time constant of 30 ms to 1 s",
        promise: Reported(Clock::Deviation(0.06), 3.0),
        deal: |d| Fault::Table(Break::Supply(d.scale(0.03, 1.0))),
    },
    Class {
        id: "valve-hard-over",
        what: "the valve stuck hard over",
        promise: Relay(Clock::Valve(0.01), 0.15),
        deal: |d| Fault::Table(Break::Stuck(d.sign() * d.scale(0.12, 10.0))),
    },
    Class {
        id: "valve-frozen",
        what: "the valve stuck where it was",
        promise: Relay(Clock::Deviation(0.05), 1.5),
        deal: |_| Fault::Table(Break::Frozen),
    },
    Class {
        id: "valve-shut",
        what: "the valve stuck shut",
        promise: Reported(Clock::Deviation(0.02), 0.5),
        deal: |_| Fault::Table(Break::Stuck(0.0)),
    },
    Class {
        id: "existing-valve-over",
        what: "behind a modifier, the valve stuck hard over",
        promise: Relay(Clock::Deviation(0.06), 0.3),
        deal: |d| Fault::Behind(Break::Stuck(d.sign() * d.scale(0.12, 10.0))),
    },
    Class {
        id: "existing-valve-shut",
        what: "behind a modifier, the valve stuck shut",
        promise: Reported(Clock::Deviation(0.06), 0.3),
        deal: |_| Fault::Behind(Break::Stuck(0.0)),
    },
    Class {
        id: "lvdt-gain",
        what: "LVDT: its gain goes to 0.5 to 1.5 of itself over 1 to 20 s",
        promise: Inside,
        deal: |d| signal(Displacement, gain(d)),
    },
    Class {
        id: "shared-lvdt-open",
        what: "an LVDT shared with the loop behind the device: no number, a rail for the loop",
        promise: Reported(Clock::Onset, 0.013),
        deal: |_| Fault::Shared(Spoil::Open),
    },
    Class {
        id: "shared-lvdt-stuck",
        what: "an LVDT shared with the loop behind the device: stands where it stood, to the last bit",
        promise: Inside,
        deal: |_| Fault::Shared(Spoil::Stuck),
    },
    Class {
        id: "shared-lvdt-drifting",
        what: "an LVDT shared with the loop behind the device: moves away at 0.1 to 1 m/s",
        promise: Inside,
        deal: |d| Fault::Shared(Spoil::Drifting(d.sign() * d.scale(0.1, 1.0))),
    },
    Class {
        id: "shared-lvdt-creeping",
        what: "an LVDT shared with the loop behind the device: moves away at 0.5 to 100 mm/s",
        promise: Inside,
        deal: |d| Fault::Shared(Spoil::Drifting(d.sign() * d.scale(5e-4, 0.1))),
    },
    Class {
        id: "shared-lvdt-gain",
        what: "an LVDT shared with the loop behind the device: its gain goes to 0.5 to 1.5 of itself over 1 to 20 s",
        promise: Inside,
        deal: |d| Fault::Shared(gain(d)),
    },
];
