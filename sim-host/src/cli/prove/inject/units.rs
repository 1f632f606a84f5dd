//! The units that a stretch's samples are written in.

use crate::recording::channel::Channel;

/// The SI unit that a channel's samples are in, given its entry.
pub(super) fn si(channel: Channel, stated: Option<&toml::Value>) -> &'static str {
    let unit = stated.and_then(|s| s.get("unit")).and_then(toml::Value::as_str).unwrap_or("1");
    match channel {
        Channel::Time => "s",
        Channel::Reference | Channel::Displacement => "m",
        Channel::Velocity => "m/s",
        Channel::Acceleration | Channel::SpecimenAcceleration => "m/s2",
        _ if unit.ends_with('V') => "V",
        _ if unit.ends_with('A') => "A",
        _ if unit.ends_with("Pa") || matches!(unit, "bar" | "psi") => "Pa",
        _ if unit.ends_with('N') || matches!(unit, "lbf" | "kip" | "kgf") => "N",
        _ => "1",
    }
}
