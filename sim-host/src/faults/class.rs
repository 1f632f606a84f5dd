//! The classes of faults: how a member is dealt, and what the hazard table (docs/hazards.md) promises of it. A test reads
//! the promises off that table and compares.

mod all;

use super::dice::FaultRng;
use super::machine::PlantFault;
use super::spoil::SignalFault;
pub use all::CLASSES;
use serde::Serialize;

/// Which signal a fault sits on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Channel {
    /// LVDT.
    Displacement,
    /// Second displacement sensor.
    Second,
    /// Accelerometer.
    Acceleration,
    /// What drives the table: the reference, in guard mode the existing controller's command.
    Command,
}

/// What happens.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fault {
    /// Nothing: the control of the experiment.
    None,
    /// A signal arrives as something else.
    Signal(Channel, SignalFault),
    /// The one LVDT that the device and a loop behind it read, an existing controller's or a hard-wired one (Fig. 2), shows
    /// something else to both; where it shows no number the loop behind reads a rail.
    Shared(SignalFault),
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
    Table(PlantFault),
    /// The same behind an existing controller, whose valve is not the device's to judge.
    Behind(PlantFault),
    /// The relay's contact is welded: it stays closed. By itself it comes with an emergency stop.
    Welded,
    /// The hydraulic block takes this long to shut, s.
    Block(f64),
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
    /// The table has gone a way that its command does not explain: this far within [`WINDOW`], m, or this far in all beyond an even
    /// [`HIDDEN`], m.
    Valve(f64, f64),
    /// The table is this far, m, from where it would have been without the fault.
    Deviation(f64),
}

/// Room that a reference leaves at either end of the stroke where the model has to tell where the table is, m: what its errors hide
/// of an LVDT's creep, stopping and margin.
pub const ROOM: f64 = 0.04;

/// An even speed that is hidden from the guard: what an unknown null of the valve may make, m/s (docs/hazards.md).
pub const HIDDEN: f64 = 0.008;

/// Over which the way of a table is taken that its command does not explain, s.
pub const WINDOW: f64 = 0.2;

/// How far an LVDT has to outrun what an unknown null of the valve hides before the valve command contradicts it, m:
/// `valve.mismatch`.
pub const OUTRUN: f64 = 0.02;

/// How far a table's gain may be from that of its model, as a share of it, for the valve command to tell an LVDT that goes wrong before
/// the table has moved for [`LEARNED`].
pub const NEAR_MODEL: f64 = 0.15;

/// How long a table has to have moved at more than a tenth of its speed for its gain to be learned, s.
pub const LEARNED: f64 = 2.0;

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
    /// The same, by the valve command and the model alone where the reference leaves [`ROOM`] at either end, the LVDT goes wrong so
    /// fast that they can tell, and the table's gain was learned before, or is near its model's where the fault cannot pass for a gain.
    Roomy {
        /// Whether the fault passes for another gain of the table while that is not learned.
        as_gain: bool,
    },
    /// The same where limit switches or a second displacement sensor are fitted: nothing else that the device reads contradicts
    /// the LVDT. Without them what becomes of it is measured.
    Aided,
    /// Nothing is: what becomes of it is measured.
    Measured,
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
    pub deal: fn(&mut FaultRng) -> Fault,
    /// Deals a second fault, where there are two.
    pub second: Option<fn(&mut FaultRng) -> Fault>,
}

impl std::fmt::Display for Clock {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mm = |metres: f64| (1e3 * metres).round();
        match *self {
            Self::Onset => f.write_str("its start"),
            Self::Displacement(least) => write!(f, "the LVDT being {} mm wrong", mm(least)),
            Self::Acceleration(least) => write!(f, "the accelerometer being {least} m/s2 wrong"),
            Self::Valve(lately, all) => write!(
                f,
                "{} mm of travel in {} ms, or {} mm in all beyond {} mm/s, that no command explains",
                mm(lately),
                mm(WINDOW),
                mm(all),
                mm(HIDDEN)
            ),
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
            Self::Roomy { as_gain } => {
                write!(
                    f,
                    "stays inside its stroke; the guard alone where the reference leaves {:.0} mm, the LVDT outruns {:.0} mm/s by {:.0} mm, and ",
                    1e3 * ROOM,
                    1e3 * HIDDEN,
                    1e3 * OUTRUN,
                )?;
                if !as_gain {
                    write!(f, "the table's gain is within {:.0} % of its model's or ", 1e2 * NEAR_MODEL)?;
                }
                write!(f, "the table moved for {LEARNED:.0} s before")
            }
            Self::Aided => f.write_str("stays inside its stroke with limit switches or a second displacement sensor"),
            Self::Measured => f.write_str("nothing: measured"),
        }
    }
}

impl Class {
    /// A class of one fault.
    const fn new(id: &'static str, what: &'static str, promise: Promise, deal: fn(&mut FaultRng) -> Fault) -> Self {
        Self { id, what, promise, deal, second: None }
    }

    /// The same with a second fault beside it.
    const fn with(self, second: fn(&mut FaultRng) -> Fault) -> Self {
        Self { second: Some(second), ..self }
    }

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
