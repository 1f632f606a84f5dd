//! Settings by name, for hosts that speak neither Rust nor serde: one value under its dotted name, or a text of many.
//!
//! The text is the part of TOML that needs no allocation: `name = value` and `[table]`, where a name may be dotted and a
//! value is a number, `true`, `false` or a word in quotes, and `#` begins a comment. Names and words are those of the
//! settings file; what is not named keeps its value. Naming a part that is left out by default (`guard`, `tracking.oil`)
//! puts it in, with its defaults; of a part without defaults every number has to be named, or the settings are refused.

use super::{Mode, Modification, NameError, ReferenceRates, Settings, VelocitySource};
use crate::control::InnerLoop;
use crate::control::tracking::oil::OilSettings;
use crate::control::tracking::pressure::PressureSettings;
use crate::control::tracking::{NotchSettings, TrackingSettings};
use crate::guard::envelope::ForceSettings;
use crate::guard::{EnvelopeSettings, GuardSettings, InputSettings};

/// Most parts of a dotted name.
const DEPTH: usize = 4;

const UNKNOWN: NameError = NameError::Unknown { line: 0 };
const VALUE: NameError = NameError::Value { line: 0 };

type Named = Result<(), NameError>;

impl Settings {
    /// Takes `value`, written as in a settings file, for the setting of this dotted `name`. Nothing is checked but that the
    /// value is of the setting's kind: [`Settings::validate`] judges all of them together.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), NameError> {
        Path::default().take(self, name, value)
    }

    /// Takes every setting of `text`. On an error the settings are as they were.
    pub fn read(&mut self, text: &str) -> Result<(), NameError> {
        let mut read = *self;
        let mut table = Path::default();
        for (number, line) in (1..).zip(text.lines()) {
            let line = line.split('#').next().unwrap_or_default().trim();
            if line.is_empty() {
                continue;
            }
            let taken = match line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
                Some(name) => Path::default().within(name.trim()).ok_or(UNKNOWN).and_then(|path| {
                    table = path;
                    setting(&mut read, path.parts(), "")
                }),
                None => line.split_once('=').ok_or(VALUE).and_then(|(name, value)| table.take(&mut read, name, value)),
            };
            taken.map_err(|error| error.at(number))?;
        }
        *self = read;
        Ok(())
    }
}

/// A dotted name in its parts.
#[derive(Debug, Clone, Copy, Default)]
struct Path<'a> {
    parts: [&'a str; DEPTH],
    length: usize,
}

impl<'a> Path<'a> {
    /// This name followed by another, unless that is too long or has an empty part.
    fn within(mut self, name: &'a str) -> Option<Self> {
        for part in name.split('.') {
            *self.parts.get_mut(self.length)? = Some(part.trim()).filter(|part| !part.is_empty())?;
            self.length += 1;
        }
        Some(self)
    }

    /// Takes the value of a name in this table. An empty one is what a table's heading has.
    fn take(self, settings: &mut Settings, name: &str, value: &str) -> Named {
        let path = self.within(name.trim()).ok_or(UNKNOWN)?;
        let value = Some(value.trim()).filter(|value| !value.is_empty()).ok_or(VALUE)?;
        setting(settings, path.parts(), value)
    }

    fn parts(&self) -> &[&'a str] {
        self.parts.get(..self.length).unwrap_or_default()
    }
}

fn number(place: &mut f32, value: &str) -> Named {
    // What `f32::from_str` takes beside TOML's numbers.
    let plain = value.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E'));
    let word = matches!(value.trim_start_matches(['+', '-']), "inf" | "nan");
    *place = value.parse().ok().filter(|_| plain || word).ok_or(VALUE)?;
    Ok(())
}

fn switch(place: &mut bool, value: &str) -> Named {
    *place = match value {
        "true" => true,
        "false" => false,
        _ => return Err(VALUE),
    };
    Ok(())
}

/// One of a few words in quotes.
fn word<T: Copy>(place: &mut T, value: &str, words: &[(&str, T)]) -> Named {
    let value = value.strip_prefix('"').and_then(|value| value.strip_suffix('"')).ok_or(VALUE)?;
    let (_, meant) = words.iter().find(|(word, _)| *word == value).ok_or(VALUE)?;
    *place = *meant;
    Ok(())
}

/// The last part of a name, and what it stands for.
fn field<const N: usize>(path: &[&str], value: &str, fields: [(&str, &mut f32); N]) -> Named {
    match path {
        [] if value.is_empty() => Ok(()),
        [name] => match fields.into_iter().find(|(field, _)| field == name) {
            Some((_, place)) => number(place, value),
            None => Err(UNKNOWN),
        },
        _ => Err(UNKNOWN),
    }
}

macro_rules! fields {
    ($path:expr, $value:expr, $of:expr, $($name:ident),+) => {{
        let of = $of;
        field($path, $value, [$((stringify!($name), &mut of.$name)),+])
    }};
}

fn setting(s: &mut Settings, path: &[&str], value: &str) -> Named {
    let Some((head, rest)) = path.split_first() else { return Err(UNKNOWN) };
    match *head {
        "mode" => alone(rest, |()| word(&mut s.mode, value, &MODES)),
        "inner_loop" => alone(rest, |()| word(&mut s.inner_loop, value, &INNER_LOOPS)),
        "velocity_source" => alone(rest, |()| word(&mut s.velocity_source, value, &VELOCITY_SOURCES)),
        "anti_windup" => alone(rest, |()| switch(&mut s.anti_windup, value)),
        "displacement" => fields!(rest, value, &mut s.displacement, proportional, integral),
        "velocity" => fields!(rest, value, &mut s.velocity, proportional, integral),
        "acceleration" => fields!(rest, value, &mut s.acceleration, proportional, integral),
        "modification" => modification(&mut s.modification, rest, value),
        "reference_rates" => reference_rates(&mut s.reference_rates, rest, value),
        "observer" if *rest == ["accelerometer"] => switch(&mut s.observer.accelerometer, value),
        "observer" => fields!(rest, value, &mut s.observer, frequency, smoothing),
        "valve" => fields!(rest, value, &mut s.valve, gain, lag, null_bias, command_limit),
        "ranges" => {
            let r = &mut s.ranges;
            fields!(rest, value, r, reference, displacement, velocity, acceleration, external, pressure_difference)
        }
        "saturation" => {
            let detection = s.saturation.get_or_insert_default();
            fields!(rest, value, detection, plateau, error, shortfall, floor, hold, follow, recovery)
        }
        "tracking" => tracking(s.tracking.get_or_insert_default(), rest, value),
        "guard" => guard(s.guard.get_or_insert_default(), rest, value),
        _ => fields!(path, value, s, rate, velocity_limit, stroke, washout_frequency, blend),
    }
}

const MODES: [(&str, Mode); 3] =
    [("guard", Mode::Guard), ("modifier", Mode::Modifier), ("controller", Mode::Controller)];
const INNER_LOOPS: [(&str, InnerLoop); 2] = [("absent", InnerLoop::Absent), ("hardwired", InnerLoop::Hardwired)];
const VELOCITY_SOURCES: [(&str, VelocitySource); 2] =
    [("observer", VelocitySource::Observer), ("sensor", VelocitySource::Sensor)];
const MODIFICATIONS: [(&str, Modification); 3] =
    [("off", Modification::Off), ("clip", Modification::Clip), ("causal", Modification::Causal)];
const REFERENCE_RATES: [(&str, ReferenceRates); 3] = [
    ("differences", ReferenceRates::Differences),
    ("supplied", ReferenceRates::Supplied),
    ("zero", ReferenceRates::Zero),
];

/// A name that has no parts of its own.
fn alone(rest: &[&str], take: impl FnOnce(()) -> Named) -> Named {
    if rest.is_empty() { take(()) } else { Err(UNKNOWN) }
}

fn modification(place: &mut Modification, path: &[&str], value: &str) -> Named {
    let mut seconds = f32::NAN;
    match path {
        [] => return word(place, value, &MODIFICATIONS),
        ["preview"] if value.is_empty() => {}
        ["preview", "seconds"] => number(&mut seconds, value)?,
        _ => return Err(UNKNOWN),
    }
    *place = Modification::Preview { seconds };
    Ok(())
}

fn reference_rates(place: &mut ReferenceRates, path: &[&str], value: &str) -> Named {
    let mut frequency = f32::NAN;
    match path {
        [] => return word(place, value, &REFERENCE_RATES),
        ["derived"] if value.is_empty() => {}
        ["derived", "frequency"] => number(&mut frequency, value)?,
        _ => return Err(UNKNOWN),
    }
    *place = ReferenceRates::Derived { frequency };
    Ok(())
}

fn tracking(s: &mut TrackingSettings, path: &[&str], value: &str) -> Named {
    const NONE: f32 = f32::NAN;
    let Some((head, rest)) = path.split_first() else { return field(path, value, []) };
    match *head {
        "noise" => fields!(rest, value, &mut s.noise, displacement, acceleration),
        "flow" => fields!(rest, value, &mut s.flow, asymmetry, sharpness, stall, droop, recovery, overdrive),
        "friction" => fields!(rest, value, &mut s.friction, coulomb, viscous, velocity, deadband),
        "oil" => {
            let oil = s.oil.get_or_insert(OilSettings { frequency: NONE, damping: NONE });
            fields!(rest, value, oil, frequency, damping)
        }
        "pressure" => {
            let none = PressureSettings { area_per_mass: NONE, gain: NONE, corner: NONE };
            fields!(rest, value, s.pressure.get_or_insert(none), area_per_mass, gain, corner)
        }
        "notch" => {
            let notch = s.notch.get_or_insert(NotchSettings { frequency: NONE, damping: NONE });
            fields!(rest, value, notch, frequency, damping)
        }
        _ => fields!(path, value, s, bandwidth, disturbance, delay, lead, spacing),
    }
}

fn guard(s: &mut GuardSettings, path: &[&str], value: &str) -> Named {
    let Some((head, rest)) = path.split_first() else { return field(path, value, []) };
    match *head {
        "envelope" => envelope(&mut s.envelope, rest, value),
        "plausibility" => {
            fields!(rest, value, &mut s.plausibility, lost, stuck, disagreement, offset, acceleration_noise)
        }
        "witness" => fields!(rest, value, &mut s.witness, frequency, scale, delay, bias, noise),
        "valve" => fields!(rest, value, &mut s.valve, mismatch, memory),
        "inputs" => inputs(&mut s.inputs, rest, value),
        "ramps" => fields!(rest, value, &mut s.ramps, test, safe),
        _ => Err(UNKNOWN),
    }
}

fn envelope(s: &mut EnvelopeSettings, path: &[&str], value: &str) -> Named {
    if let Some((&"force", rest)) = path.split_first() {
        let none = ForceSettings { limit: f32::NAN, piston_area: f32::NAN };
        return fields!(rest, value, s.force.get_or_insert(none), limit, piston_area);
    }
    if matches!(path, ["stopping_latency" | "stopping_deceleration"]) {
        return fields!(path, value, s, stopping_latency, stopping_deceleration);
    }
    fields!(path, value, s, margin, velocity, acceleration, jerk, tracking, persistence)
}

fn inputs(s: &mut InputSettings, path: &[&str], value: &str) -> Named {
    match path {
        [] => field(path, value, []),
        ["second_displacement"] => number(s.second_displacement.insert(f32::NAN), value),
        ["relay_feedback"] => number(s.relay_feedback.insert(f32::NAN), value),
        ["limit_switches"] => switch(&mut s.limit_switches, value),
        _ => Err(UNKNOWN),
    }
}
