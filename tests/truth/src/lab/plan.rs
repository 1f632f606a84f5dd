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
    /// One listed effect in a part of the runs or in a region of state.
    Located,
    /// Two listed effects.
    Pair,
    /// Three listed effects.
    Triple,
    /// A flaw in no library.
    Unlisted,
    /// Two of them.
    TwoUnlisted,
    /// A listed effect beside a flaw in no library.
    Mixed,
    /// A listed effect that the data do not tell from another.
    Confounded,
    /// Recordings that no model should be judged by.
    BadData,
}

use Stratum as S;

impl Stratum {
    /// A name for tables.
    pub fn name(self) -> &'static str {
        match self {
            S::Null { .. } => "null",
            S::Single(..) => "single",
            S::Located => "located",
            S::Pair => "pair",
            S::Triple => "triple",
            S::Unlisted => "unlisted",
            S::TwoUnlisted => "two unlisted",
            S::Mixed => "listed with unlisted",
            S::Confounded => "confounded",
            S::BadData => "bad data",
        }
    }
}

/// Cases in a cycle beside the singles.
const COUNTS: [(Stratum, usize); 10] = [
    (S::Null { perfect: true }, 16),
    (S::Null { perfect: false }, 24),
    (S::Located, 12),
    (S::Pair, 28),
    (S::Triple, 8),
    (S::Unlisted, 16),
    (S::TwoUnlisted, 6),
    (S::Mixed, 10),
    (S::Confounded, 8),
    (S::BadData, 8),
];

fn deck() -> Vec<Stratum> {
    let mut deck = Vec::new();
    for (what, count) in COUNTS {
        deck.extend(std::iter::repeat_n(what, count));
    }
    for effect in 0..forms::effects().len() {
        deck.extend(Strength::ALL.map(|strength| S::Single(effect, strength)));
    }
    deck
}

/// Cases in a cycle.
pub fn cycle() -> u64 {
    deck().len() as u64
}

/// The stratum of case `number` under `seed`.
pub fn stratum(seed: u64, number: u64) -> Stratum {
    let mut deck = deck();
    let count = deck.len() as u64;
    Stream::new(seed, number / count, 0x6c61_6270_6c61).shuffle(&mut deck);
    deck[(number % count) as usize]
}

/// How many of its kind came before it in the campaign: kinds of flaws take turns.
pub fn turn(seed: u64, number: u64) -> usize {
    let kind = std::mem::discriminant(&stratum(seed, number));
    let mut deck = deck();
    let count = deck.len() as u64;
    let in_cycle = deck.iter().filter(|s| std::mem::discriminant(*s) == kind).count();
    Stream::new(seed, number / count, 0x6c61_6270_6c61).shuffle(&mut deck);
    let before = deck.iter().take((number % count) as usize).filter(|s| std::mem::discriminant(*s) == kind).count();
    (number / count) as usize * in_cycle + before
}

/// Draws how much a flaw of a class is to add to chi2: from barely there to gross without gaps.
pub fn target(strength: Strength, rng: &mut Stream) -> f64 {
    match strength {
        Strength::Faint => rng.log_uniform(0.02, 5.0),
        Strength::Clear => rng.log_uniform(5.0, 99.0),
        Strength::Gross => rng.log_uniform(99.0, 800.0),
    }
}

#[cfg(test)]
mod tests {
    use super::{S, cycle, stratum, turn};
    use crate::lab::forms;

    #[test]
    fn a_cycle_holds_every_effect_at_every_strength_and_every_stratum() {
        let all: Vec<_> = (0..cycle()).map(|n| stratum(11, n)).collect();
        assert_eq!(forms::effects().len(), 28);
        assert_eq!(all.iter().filter(|s| matches!(s, S::Single(..))).count(), 84);
        assert_eq!(all.iter().filter(|s| matches!(s, S::Null { .. })).count(), 40);
        assert_eq!(all.iter().filter(|s| **s == S::Pair).count(), 28);
    }

    #[test]
    fn turns_count_up() {
        let turns: Vec<_> = (0..2 * cycle()).filter(|n| stratum(5, *n) == S::Unlisted).map(|n| turn(5, n)).collect();
        assert_eq!(turns, (0..32).collect::<Vec<_>>());
    }
}
