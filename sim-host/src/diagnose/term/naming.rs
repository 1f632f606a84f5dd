//! Terms of the grammar in names and in words.

use super::grammar::{Follows, Form, Memory, Term, Times};

impl Term {
    /// A short name, unlike that of any other term.
    pub(super) fn slug(self) -> String {
        let form = match self.form {
            Form::Linear => "linear",
            Form::Magnitude => "magnitude",
            Form::OddSquare => "odd_square",
            Form::Square => "square",
            Form::Cube => "cube",
            Form::Root => "root",
            Form::Direction => "direction",
            Form::Wave => "wave",
        };
        let memory = match self.memory {
            Memory::None => "",
            Memory::Lag => "_lag",
            Memory::Late => "_late",
            Memory::Play => "_play",
            Memory::Relay => "_relay",
        };
        let times = match self.times {
            Times::One => "",
            Times::Against => "_dry",
            Times::Velocity => "_damping",
            Times::Passing => "_gain",
        };
        let state = match self.follows {
            Follows::Place => "x",
            Follows::Velocity => "v",
            Follows::Acceleration => "a",
            Follows::Command => "u",
            Follows::Path => "path",
            Follows::Time => "time",
        };
        format!("{state}_{form}{memory}{times}")
    }

    /// What it is, in words.
    pub(super) fn words(self) -> String {
        let state = match self.follows {
            Follows::Place => "displacement",
            Follows::Velocity => "velocity",
            Follows::Acceleration => "acceleration",
            Follows::Command => "command",
            Follows::Path => "the way travelled",
            Follows::Time => "time",
        };
        let form = match self.form {
            Form::Linear if self.memory == Memory::Lag => {
                return format!(
                    "in proportion to {state} less its value behind a first-order lag{}",
                    self.times.words()
                );
            }
            Form::Linear if self.memory == Memory::Play => {
                return format!("in proportion to {state} less its value behind a play{}", self.times.words());
            }
            Form::Linear => format!("in proportion to {state}"),
            Form::Magnitude => format!("with the magnitude of {state}"),
            Form::OddSquare => format!("odd in {state}, with its square"),
            Form::Square => format!("even in {state}, with its square"),
            Form::Cube => format!("with the cube of {state}"),
            Form::Root => format!("with the square root of {state}"),
            Form::Direction => format!("with the direction of {state} alone"),
            Form::Wave => format!("a wave along {state}"),
        };
        let memory = match self.memory {
            Memory::None => "no memory",
            Memory::Lag => "behind a first-order lag",
            Memory::Late => "and its effect lags, first order",
            Memory::Play => "behind a play",
            Memory::Relay => "switched by a relay with hysteresis",
        };
        format!("{form}{}, {memory}", self.times.words())
    }
}

impl Times {
    /// What it multiplies, in words.
    fn words(self) -> &'static str {
        match self {
            Self::One => "",
            Self::Against => ", against the motion",
            Self::Velocity => ", times velocity",
            Self::Passing => ", times what passes there",
        }
    }
}
