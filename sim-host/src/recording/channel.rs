//! The channels a recording may have, and one value for each of them.

use super::unit::Dimension;
use std::fmt;

/// One measured or commanded quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    /// When each row was taken, s.
    Time,
    /// Where the table should be, m.
    Reference,
    /// Where the displacement sensor sees it, m.
    Displacement,
    /// Its velocity, m/s.
    Velocity,
    /// Its acceleration, m/s2.
    Acceleration,
    /// What the controller sent: valve command or force, in the model's unit of u.
    Command,
    /// A known input added to the command after the controller, in the command's unit.
    Disturbance,
    /// Pressure difference over the piston, Pa, or an uncalibrated number.
    PressureDifference,
    /// Supply pressure, Pa, or an uncalibrated number.
    SupplyPressure,
    /// Acceleration of the specimen on the table, m/s2.
    SpecimenAcceleration,
}

impl Channel {
    /// Every channel.
    pub const ALL: [Self; 10] = [
        Self::Time,
        Self::Reference,
        Self::Displacement,
        Self::Velocity,
        Self::Acceleration,
        Self::Command,
        Self::Disturbance,
        Self::PressureDifference,
        Self::SupplyPressure,
        Self::SpecimenAcceleration,
    ];

    /// Its key in an experiment's `[channels]`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Reference => "reference",
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Command => "command",
            Self::Disturbance => "disturbance",
            Self::PressureDifference => "pressure_difference",
            Self::SupplyPressure => "supply_pressure",
            Self::SpecimenAcceleration => "specimen_acceleration",
        }
    }

    /// The channel of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.name() == name)
    }

    /// What its unit may measure.
    pub fn dimensions(self) -> &'static [Dimension] {
        use Dimension::{Acceleration, Current, Force, Length, Number, Pressure, Time, Velocity, Voltage};
        match self {
            Self::Time => &[Time],
            Self::Reference | Self::Displacement => &[Length],
            Self::Velocity => &[Velocity],
            Self::Acceleration | Self::SpecimenAcceleration => &[Acceleration],
            Self::Command | Self::Disturbance => &[Number, Length, Voltage, Current, Force],
            Self::PressureDifference => &[Pressure, Number, Voltage, Current, Force],
            Self::SupplyPressure => &[Pressure, Number, Voltage, Current],
        }
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One value a channel, where it has one.
#[derive(Debug, Clone, PartialEq)]
pub struct PerChannel<T>([Option<T>; Channel::ALL.len()]);

impl<T> Default for PerChannel<T> {
    fn default() -> Self {
        Self(std::array::from_fn(|_| None))
    }
}

impl<T> PerChannel<T> {
    /// The value of a channel.
    pub fn get(&self, channel: Channel) -> Option<&T> {
        self.0[channel as usize].as_ref()
    }

    /// The value of a channel, to change.
    pub fn get_mut(&mut self, channel: Channel) -> Option<&mut T> {
        self.0[channel as usize].as_mut()
    }

    /// Sets the value of a channel.
    pub fn set(&mut self, channel: Channel, value: T) {
        self.0[channel as usize] = Some(value);
    }

    /// Takes the value of a channel away.
    pub fn remove(&mut self, channel: Channel) -> Option<T> {
        self.0[channel as usize].take()
    }

    /// The channels that have a value, with it.
    pub fn iter(&self) -> impl Iterator<Item = (Channel, &T)> {
        Channel::ALL.into_iter().filter_map(|c| self.get(c).map(|v| (c, v)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_places_agree() {
        for (place, channel) in Channel::ALL.into_iter().enumerate() {
            assert_eq!(channel as usize, place);
            assert_eq!(Channel::named(channel.name()), Some(channel));
        }
        assert_eq!(Channel::named("Displacement"), None);
    }
}
