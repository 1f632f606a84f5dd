//! Which case a number is: cycles of fixed content, shuffled by the seed, so that any campaign has the same mix.

use super::forms;
use crate::plan::Strength;
use crate::rng::Stream;

/// What a case is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stratum {
    /// Nothing missing; everything as stated but for the noise, or a set-up as laboratories have it.
    Null {
        /// As stated.
        perfect: bool,
    },
    /// One listed effect, by its number in [`forms::effects`].
    Single(usize, Strength),
}

impl Stratum {
    /// A name for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Null { .. } => "null",
            Self::Single(..) => "single",
        }
    }
}

/// Cases in a cycle.
pub fn cycle() -> u64 {
    deck().len() as u64
}

fn deck() -> Vec<Stratum> {
    let mut deck = Vec::new();
    for (what, count) in [(Stratum::Null { perfect: true }, 16), (Stratum::Null { perfect: false }, 24)] {
        deck.extend(std::iter::repeat_n(what, count));
    }
    for effect in 0..forms::effects().len() {
        deck.extend(Strength::ALL.map(|strength| Stratum::Single(effect, strength)));
    }
    deck
}

/// The stratum of case `number` under `seed`.
pub fn stratum(seed: u64, number: u64) -> Stratum {
    let mut deck = deck();
    let count = deck.len() as u64;
    Stream::new(seed, number / count, 0x6c61_6270_6c61).shuffle(&mut deck);
    deck[(number % count) as usize]
}

/// Draws how much a flaw of a class is to add to chi2: from barely there to gross without gaps.
pub fn target(strength: Strength, rng: &mut Stream) -> f64 {
    match strength {
        Strength::Faint => rng.log_uniform(0.02, 5.0),
        Strength::Clear => rng.log_uniform(5.0, 99.0),
        Strength::Gross => rng.log_uniform(99.0, 800.0),
    }
}
