//! Families of effects: what an examination counts together.

/// What an effect is one of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// What happens to the command on its way to the valve.
    Command,
    /// The spool and its amplifier.
    Valve,
    /// Flow through the valve and its supply.
    Flow,
    /// The oil between valve and piston.
    OilColumn,
    /// Forces that oppose motion.
    Friction,
    /// Forces of a place: stops, joints, springs.
    Contact,
    /// What moves with the table, or beneath it.
    Structure,
    /// Sensors and their lines.
    Sensors,
}

impl Family {
    /// The name used in results.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Command => "command",
            Self::Valve => "valve",
            Self::Flow => "flow",
            Self::OilColumn => "oil column",
            Self::Friction => "friction",
            Self::Contact => "contact",
            Self::Structure => "structure",
            Self::Sensors => "sensors",
        }
    }
}
