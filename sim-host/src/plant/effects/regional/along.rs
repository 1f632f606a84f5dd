//! What a part of a run or a region of the state is measured along.

use crate::plant::effects::Instant;
use crate::scalar::Scalar;

/// What an effect's strength depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Along {
    /// Time from the start of a run, s.
    Time,
    /// Displacement, m.
    Displacement,
    /// Velocity, m/s.
    Velocity,
    /// Its magnitude, m/s.
    Speed,
    /// What the controller asks for, unit of u.
    Command,
}

impl Along {
    /// All of them.
    pub(crate) const ALL: [Self; 5] = [Self::Time, Self::Displacement, Self::Velocity, Self::Speed, Self::Command];

    /// The name used in files and results.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Speed => "speed",
            Self::Command => "command",
        }
    }

    /// Its unit.
    pub(super) fn unit(self) -> &'static str {
        match self {
            Self::Time => "s",
            Self::Displacement => "m",
            Self::Velocity | Self::Speed => "m/s",
            Self::Command => "unit of u",
        }
    }

    /// Its value, with the controller's command beside the motion.
    pub(in crate::plant::effects) fn of<S: Scalar>(self, at: &Instant<S>, command: S) -> S {
        match self {
            Self::Time => S::from(at.time),
            Self::Displacement => at.displacement,
            Self::Velocity => at.velocity,
            Self::Speed => at.velocity.abs(),
            Self::Command => command,
        }
    }
}
