//! The classes of faults: how a member is dealt, and what the hazard table (docs/hazards.md) promises of it. A test reads
//! the promises off that table and compares.

use super::dice::Dice;
use super::machine::Break;
use super::spoil::Spoil;

/// Which signal a fault sits on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// LVDT.
    Displacement,
    /// Accelerometer.
    Acceleration,
    /// What drives the table: the reference, in guard mode the existing controller's command.
    Command,
}

/// What happens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// Nothing: the control of the experiment.
    None,
    /// A signal arrives as something else.
    Signal(Channel, Spoil),
    /// No byte of the stream of reference points arrives any more.
    LinkCut,
    /// This share of the stream's bytes has a bit flipped.
    LinkGarbled(f64),
    /// A frame of settings with so many bits flipped arrives.
    SettingsGarbled(u32),
    /// Settings with one number replaced by none, by infinity, by something huge or by its negative.
    SettingsNonsense,
    /// Gains are changed by factors up to this, either way, and the null bias by a twentieth of wide open, in settings that hold.
    SettingsWrong(f64),
    /// Every tick is longer or shorter by up to this share.
    Jitter(f64),
    /// So many ticks in a row do not run; the board notices at the next.
    Missed(u32),
    /// Something of the table breaks.
    Table(Break),
    /// The same behind an existing controller, whose valve is not the device's to judge.
    Behind(Break),
}

/// What starts the clock of a latency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Clock {
    /// The fault itself.
    Onset,
    /// The LVDT's reading is wrong by more than this, m.
    Displacement(f64),
    /// The mean accelerometer reading over 50 ms is wrong by more than this, m/s2.
    Acceleration(f64),
    /// The table has gone this way, m, that its command does not explain.
    Valve(f64),
    /// The table is this far, m, from where it would have been without the fault.
    Deviation(f64),
}

/// What the hazard table promises of a class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Promise {
    /// The guard trips, or the test is faded out, within this time (s) from the clock's start.
    Reported(Clock, f64),
    /// The relay is open within this time (s) from the clock's start, wherever the table goes meanwhile.
    Relay(Clock, f64),
    /// The table comes no farther than this (m) from where it would have been, or the guard trips.
    Harmless(f64),
    /// The table obeys, and stays inside its stroke.
    Inside,
    /// Nothing: what is left to people and hardware.
    Residual,
}

/// A class of faults.
#[derive(Debug, Clone, Copy)]
pub struct Class {
    /// Name in tables and files.
    pub id: &'static str,
    /// What happens, in words.
    pub what: &'static str,
    /// What is promised.
    pub promise: Promise,
    /// Deals a member.
    pub deal: fn(&mut Dice) -> Fault,
}

use Channel::{Acceleration, Command, Displacement};
use Promise::{Harmless, Inside, Relay, Reported, Residual};

fn signal(channel: Channel, spoil: Spoil) -> Fault {
    Fault::Signal(channel, spoil)
}

fn spikes(dice: &mut Dice, low: f64, high: f64) -> Spoil {
    let length = 1 + dice.below(20) as u32;
    let period = if dice.chance(0.5) { u32::MAX } else { length + 30 + dice.below(400) as u32 };
    Spoil::Spikes { height: dice.sign() * dice.scale(low, high), length, period }
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
        promise: Harmless(0.03),
        deal: |d| signal(Displacement, Spoil::Clipped(d.uniform(0.005, 0.06))),
    },
    Class {
        id: "lvdt-stuck",
        what: "LVDT: stands where it stood, to the last bit",
        promise: Harmless(0.03),
        deal: |_| signal(Displacement, Spoil::Stuck),
    },
    Class {
        id: "lvdt-detached",
        what: "LVDT: stands where it stood, with noise of 0.01 to 0.2 mm",
        promise: Harmless(0.04),
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
        promise: Residual,
        deal: |d| signal(Displacement, Spoil::Drifting(d.sign() * d.scale(5e-4, 0.15))),
    },
    Class {
        id: "lvdt-spikes",
        what: "LVDT: spikes of 1 to 200 mm, 1 to 20 ms",
        promise: Harmless(0.02),
        deal: |d| signal(Displacement, spikes(d, 1e-3, 0.2)),
    },
    Class {
        id: "lvdt-gap",
        what: "LVDT: no number for 1 to 9 ms",
        promise: Harmless(0.01),
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
        promise: Harmless(0.04),
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
        promise: Harmless(0.04),
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
        promise: Harmless(0.04),
        deal: |d| signal(Acceleration, spikes(d, 1.0, 100.0)),
    },
    Class {
        id: "accelerometer-reversed",
        what: "accelerometer: polarity turned",
        promise: Harmless(0.04),
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
        what: "the same for 1 to 9 ms",
        promise: Harmless(0.01),
        deal: |d| signal(Command, Spoil::Gap(1 + d.below(9) as u32)),
    },
    Class {
        id: "command-jump",
        what: "the same jumps by 5 mm to 1 m",
        promise: Inside,
        deal: |d| signal(Command, Spoil::Offset(d.sign() * d.scale(0.005, 1.0))),
    },
    Class {
        id: "command-stuck",
        what: "the same stands where it stood",
        promise: Inside,
        deal: |_| signal(Command, Spoil::Stuck),
    },
    Class {
        id: "command-runaway",
        what: "the same moves away at 10 mm/s to 2 m/s",
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
        promise: Harmless(0.02),
        deal: |d| {
            let (mass, blow) = (d.uniform(0.1, 1.0), d.scale(2.0, 50.0));
            Fault::Table(Break::Payload { mass, blow, length: d.scale(0.003, 0.05), count: 1 + d.below(5) as u32 })
        },
    },
    Class {
        id: "supply-lost",
        what: "the supply falls with a time constant of 30 ms to 1 s",
        promise: Reported(Clock::Deviation(0.06), 1.5),
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
        promise: Relay(Clock::Deviation(0.05), 0.5),
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
];

impl std::fmt::Display for Clock {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mm = |metres: f64| (1e3 * metres).round();
        match *self {
            Self::Onset => f.write_str("its start"),
            Self::Displacement(least) => write!(f, "the LVDT being {} mm wrong", mm(least)),
            Self::Acceleration(least) => write!(f, "the accelerometer being {least} m/s2 wrong"),
            Self::Valve(least) => write!(f, "{} mm of way that no command explains", mm(least)),
            Self::Deviation(least) => write!(f, "the table straying {} mm", mm(least)),
        }
    }
}

impl std::fmt::Display for Promise {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ms = |seconds: f64| (1e3 * seconds).round();
        match *self {
            Self::Reported(clock, within) => write!(f, "reported within {} ms of {clock}", ms(within)),
            Self::Relay(clock, within) => write!(f, "relay open within {} ms of {clock}", ms(within)),
            Self::Harmless(most) if most < 1e-6 => f.write_str("changes nothing, or reported"),
            Self::Harmless(most) => write!(f, "strays at most {} mm, or reported", (1e3 * most).round()),
            Self::Inside => f.write_str("stays inside its stroke"),
            Self::Residual => f.write_str("nothing"),
        }
    }
}

impl Class {
    /// The class of this name.
    pub fn named(id: &str) -> Option<&'static Self> {
        CLASSES.iter().find(|class| class.id == id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_once() {
        for (i, class) in CLASSES.iter().enumerate() {
            assert!(CLASSES[..i].iter().all(|other| other.id != class.id), "{}", class.id);
        }
        assert_eq!(CLASSES[0].id, "none");
    }

    /// What the watcher holds the guard to is what the hazard table says, word by word.
    #[test]
    fn the_hazard_table_makes_the_same_promises() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/hazards.md");
        let table = std::fs::read_to_string(&path).unwrap();
        for class in &CLASSES[1..] {
            let row = format!("| `{}` | {} | {} |", class.id, class.what, class.promise);
            assert!(table.contains(&row), "docs/hazards.md lacks the row that begins {row}");
        }
    }
}
