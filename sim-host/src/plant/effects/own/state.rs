//! What of the plant an expression can see.

use super::dimension::Dimension;
use crate::scalar::Scalar;

/// What of the plant an expression can see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum State {
    /// Displacement of the table, m.
    Displacement,
    /// Velocity, m/s.
    Velocity,
    /// Acceleration that the accelerometer would show, m/s2.
    Acceleration,
    /// The command, unit of u.
    Command,
    /// Sign of the velocity as a dry contact has it, -1 to 1.
    VelocitySign,
    /// Way travelled since the start, m.
    Path,
    /// Time since the start, s.
    Time,
}

impl State {
    /// Every state.
    pub(crate) const ALL: [Self; 7] = [
        Self::Displacement,
        Self::Velocity,
        Self::Acceleration,
        Self::Command,
        Self::VelocitySign,
        Self::Path,
        Self::Time,
    ];

    /// Its name in files and expressions.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Command => "command",
            Self::VelocitySign => "velocity_sign",
            Self::Path => "path",
            Self::Time => "time",
        }
    }

    /// The state of a name, or of the symbol by which textbooks call it.
    pub(super) fn named(name: &str) -> Option<Self> {
        let symbol = match name {
            "x" => "displacement",
            "v" => "velocity",
            "a" => "acceleration",
            "u" => "command",
            "t" => "time",
            other => other,
        };
        Self::ALL.into_iter().find(|state| state.name() == symbol)
    }

    pub(super) fn dimension(self) -> Dimension {
        match self {
            Self::Displacement | Self::Path => Dimension::LENGTH,
            Self::Velocity => Dimension::VELOCITY,
            Self::Acceleration => Dimension::ACCELERATION,
            Self::Command => Dimension::COMMAND,
            Self::VelocitySign => Dimension::NONE,
            Self::Time => Dimension::TIME,
        }
    }
}

/// The values of every state.
#[derive(Debug, Clone, Copy)]
pub(super) struct OwnInputs<S> {
    pub(super) displacement: S,
    pub(super) velocity: S,
    pub(super) acceleration: S,
    pub(super) command: S,
    pub(super) velocity_sign: S,
    pub(super) path: S,
    pub(super) time: f64,
}

impl<S: Scalar> OwnInputs<S> {
    pub(super) fn none() -> Self {
        let zero = S::from(0.0);
        Self {
            displacement: zero,
            velocity: zero,
            acceleration: zero,
            command: zero,
            velocity_sign: zero,
            path: zero,
            time: 0.0,
        }
    }

    /// The value of one state.
    pub(super) fn of(&self, state: State) -> S {
        match state {
            State::Displacement => self.displacement,
            State::Velocity => self.velocity,
            State::Acceleration => self.acceleration,
            State::Command => self.command,
            State::VelocitySign => self.velocity_sign,
            State::Path => self.path,
            State::Time => S::from(self.time),
        }
    }
}
