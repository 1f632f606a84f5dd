//! Which case a number is: cycles of fixed content, shuffled by the seed, so that any campaign has the same mix.

use crate::effect::Effect;
use crate::rng::Stream;

/// How visible a flaw is to be; what it came to be is measured and stated in the answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Strength {
    /// Adds less than 5 to the chi2 of the run held out, down to a few parts in a hundred.
    Faint,
    /// Between 6 and 100.
    Clear,
    /// Above 100.
    Gross,
}

impl Strength {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Faint, Self::Clear, Self::Gross];

    /// Draws how much is to be added to chi2.
    pub fn target(self, rng: &mut Stream) -> f64 {
        match self {
            Self::Faint => rng.log_uniform(0.03, 4.0),
            Self::Clear => rng.log_uniform(9.0, 70.0),
            Self::Gross => rng.log_uniform(150.0, 600.0),
        }
    }

    /// The class of a chi2 of the refitted baseline on the run held out.
    pub fn of(chi2: f64) -> Self {
        if chi2 > 100.0 {
            Self::Gross
        } else if chi2 > 6.0 {
            Self::Clear
        } else {
            Self::Faint
        }
    }

    /// A name for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Faint => "faint",
            Self::Clear => "clear",
            Self::Gross => "gross",
        }
    }
}

/// What a case is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stratum {
    /// Nothing missing.
    Null,
    /// One listed effect.
    Single(Effect, Strength),
    /// Two listed effects.
    Pair,
    /// A flaw in no library.
    Unlisted,
    /// Effects that these data cannot tell apart.
    Confounded,
    /// Bad data.
    BadData,
}

impl Stratum {
    /// A name for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Single(..) => "single",
            Self::Pair => "pair",
            Self::Unlisted => "unlisted",
            Self::Confounded => "confounded",
            Self::BadData => "bad data",
        }
    }
}

/// Cases in a cycle: ten cycles hold 300 nulls, ten of each effect at each strength, 100 pairs, 100 unlisted, 50
/// confounded, 70 of bad data.
pub const CYCLE: u64 = 140;

const NULLS: usize = 30;
const PAIRS: usize = 10;
const UNLISTED: usize = 10;
const CONFOUNDED: usize = 5;
const BAD: usize = 7;

/// The stratum of case `number` under `seed`.
pub fn stratum(seed: u64, number: u64) -> Stratum {
    let mut deck = vec![Stratum::Null; NULLS];
    for effect in Effect::ALL {
        deck.extend(Strength::ALL.map(|strength| Stratum::Single(effect, strength)));
    }
    for (what, count) in [
        (Stratum::Pair, PAIRS),
        (Stratum::Unlisted, UNLISTED),
        (Stratum::Confounded, CONFOUNDED),
        (Stratum::BadData, BAD),
    ] {
        deck.extend(std::iter::repeat_n(what, count));
    }
    Stream::new(seed, number / CYCLE, 0x706c_616e).shuffle(&mut deck);
    deck[(number % CYCLE) as usize % deck.len()]
}

/// How many of its kind came before it: unlisted flaws and faults of data take turns.
pub fn turn(seed: u64, number: u64) -> u64 {
    let kind = std::mem::discriminant(&stratum(seed, number));
    let cycle = number / CYCLE;
    let first = cycle * CYCLE;
    let of_kind = |n: &u64| std::mem::discriminant(&stratum(seed, *n)) == kind;
    let before = (first..number).filter(of_kind).count() as u64;
    let in_cycle = (first..first + CYCLE).filter(of_kind).count() as u64;
    cycle * in_cycle + before
}

#[cfg(test)]
mod tests {
    use super::{CYCLE, Stratum, Strength, stratum, turn};
    use crate::effect::Effect;

    #[test]
    fn ten_cycles_hold_what_the_frozen_result_needs() {
        let all: Vec<_> = (0..10 * CYCLE).map(|n| stratum(11, n)).collect();
        let count = |what: Stratum| all.iter().filter(|s| **s == what).count();
        assert_eq!(count(Stratum::Null), 300);
        assert_eq!(count(Stratum::Pair), 100);
        assert_eq!(count(Stratum::Unlisted), 100);
        for effect in Effect::ALL {
            for strength in Strength::ALL {
                assert_eq!(count(Stratum::Single(effect, strength)), 10);
            }
        }
    }

    #[test]
    fn turns_of_a_kind_count_up() {
        let turns: Vec<_> =
            (0..2 * CYCLE).filter(|n| stratum(5, *n) == Stratum::Unlisted).map(|n| turn(5, n)).collect();
        assert_eq!(turns, (0..20).collect::<Vec<u64>>());
    }
}
