//! The memories of a plant's laws, and the supply that one of them may hold.

use super::{Plant, State};
use crate::lab::law::{Now, Part, Place};

impl Plant {
    /// Updates the memories over `h` seconds from the instant as [`Self::rates`] gave it.
    pub fn remember(&self, now: &Now, h: f64, y: &State, m: &mut State) {
        for k in 0..self.parts.len() {
            let (part, (i, j)) = (&self.parts[k], self.layout[k]);
            let memories = part.law.memories();
            if memories == 0 {
                continue;
            }
            let input = self.input(k, now, y, m);
            part.law.remember(now, input, h, &mut m[j..j + memories]);
            part.law.watch(&y[i..i + part.law.states()], &mut m[j..j + memories]);
        }
    }

    /// The signal in front of part `k`.
    fn input(&self, k: usize, now: &Now, y: &State, m: &State) -> f64 {
        let place = self.parts[k].place;
        let start = match place {
            Place::Command => now.command,
            Place::Valve => self.through(Place::Command, now, now.command, y, m),
            Place::Displacement => now.x,
            Place::Link => now.v,
            Place::Force | Place::Leak => 0.0,
            _ => now.v,
        };
        let mut signal = start;
        for (part, &(i, j)) in self.parts.iter().zip(&self.layout).take(k) {
            if part.place == place {
                let law = &part.law;
                signal = part.out(now, signal, &y[i..i + law.states()], &m[j..j + law.memories()]);
            }
        }
        signal
    }

    /// Supply pressure over its start (1).
    pub fn supply(&self, y: &State) -> f64 {
        let of = |(part, at): (&Part, &(usize, usize))| part.law.supply(&y[at.0..at.0 + part.law.states()]);
        self.parts.iter().zip(&self.layout).find_map(of).unwrap_or(1.0)
    }
}
