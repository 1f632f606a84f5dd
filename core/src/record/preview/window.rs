//! The last N steps of the reference, and where the extremes of every aligned run of 4, 16 and 64 of them lie.

/// A ring of steps. Beside it, for each run, the places of its highest and its lowest step within it: the runs of 4 first,
/// two places in a byte, then those of 16 likewise, then those of 64, each place a byte. A run counts what has been pushed
/// of it so far. Steps from before it was brought to rest are none, whatever their slots hold: to empty it takes one store,
/// not a pass over it.
#[derive(Debug, Clone)]
pub(super) struct Window<const N: usize, const PLACES: usize> {
    /// Displacement moved in one tick, m.
    steps: [f32; N],
    places: [u8; PLACES],
    /// Steps pushed since it rested, below [`Self::WRAP`]; past that it goes back to [`Self::FULL`], which a power of two
    /// does not notice.
    count: u32,
}

/// Bytes that the places of `n` steps take.
pub(super) const fn places(n: usize) -> usize {
    n / 4 + n / 16 + 2 * (n / 64)
}

/// A step at a distance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ahead {
    /// Displacement moved in one tick, m.
    pub(super) step: f32,
    /// How many ticks after the last step answered.
    pub(super) ticks: f32,
}

/// The extremes of one run of steps in view.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    /// How many ticks ahead it begins, and how many steps it holds.
    #[cfg(test)]
    span: (u32, u32),
    pub(super) highest: Ahead,
    pub(super) lowest: Ahead,
}

impl<const N: usize, const PLACES: usize> Window<N, PLACES> {
    /// Slots are found by masking.
    const MASK: u32 = {
        assert!(N.is_power_of_two() && N >= 2 && N <= 1 << 15, "the preview window holds a power of two of samples");
        assert!(PLACES >= places(N), "the preview window has `places(N)` bytes for its runs");
        N as u32 - 1
    };
    /// The longest run holds 2 to this power steps: 64, and never more than half the window.
    const TOP: u32 = {
        let mut top = 6;
        while top > 0 && 1 << top > N / 2 {
            top -= 2;
        }
        top
    };

    /// Indices from here on, those below zero, are from before it rested.
    const WRAP: u32 = 1 << 31;
    /// More steps than any window holds, a multiple of them all.
    const FULL: u32 = 1 << 16;

    /// A reference that has always rested.
    pub(super) const fn at_rest() -> Self {
        Self { steps: [0.0; N], places: [0; PLACES], count: 0 }
    }

    /// Forgets all that moved, in a time that does not depend on its length.
    pub(super) fn rest(&mut self) {
        self.count = 0;
    }

    /// Takes the newest step and shows it to the runs that it belongs to.
    pub(super) fn push(&mut self, step: f32) {
        let index = self.count;
        self.count = if index == Self::WRAP - 1 { Self::FULL } else { index + 1 };
        if let Some(slot) = self.steps.get_mut((index & Self::MASK) as usize) {
            *slot = step;
        }
        let mut power = 2;
        while power <= Self::TOP {
            let within = index & ((1 << power) - 1);
            let (mut highest, mut lowest) = (within, within);
            if within > 0 {
                let first = index - within;
                let (high, low) = self.extremes(index, power);
                // Of equals the later: on a level stretch it is the one that binds.
                highest = if self.step(first.wrapping_add(high)) > step { high } else { within };
                lowest = if self.step(first.wrapping_add(low)) < step { low } else { within };
            }
            self.keep(index, power, highest, lowest);
            power += 2;
        }
    }

    /// The step pushed `delay` ticks before the newest, m.
    pub(super) fn late(&self, delay: u32) -> f32 {
        self.step(self.count.wrapping_sub(1).wrapping_sub(delay))
    }

    /// Shows `look` the runs that cover the newest `ahead` + 1 steps, oldest first, until it has its answer. The next size
    /// up takes over where it fits and is not longer than it is far away.
    #[inline]
    pub(super) fn scan<T>(&self, ahead: u32, mut look: impl FnMut(Run) -> Option<T>) -> Option<T> {
        let first = self.count.wrapping_sub(1).wrapping_sub(ahead);
        let mut cursor = Cursor { index: first, ticks: 1, left: ahead + 1 };
        let mut found = self.runs::<0, T>(&mut cursor, &mut look);
        if found.is_none() {
            found = self.runs::<2, T>(&mut cursor, &mut look);
        }
        if found.is_none() {
            found = self.runs::<4, T>(&mut cursor, &mut look);
        }
        if found.is_none() {
            found = self.runs::<6, T>(&mut cursor, &mut look);
        }
        found
    }

    /// The runs of 2^POWER steps of a scan.
    #[inline]
    fn runs<const POWER: u32, T>(&self, cursor: &mut Cursor, look: &mut impl FnMut(Run) -> Option<T>) -> Option<T> {
        let length = 1 << POWER;
        let last = if POWER < Self::TOP { cursor.before(4 << POWER) } else { cursor.left };
        let mut left = last;
        while left > 0 {
            let (index, ticks) = (cursor.index, cursor.ticks);
            // Runs are aligned, and so is the first step: one that began before it holds rest alone.
            let (high, low) = if POWER == 0 || index >= Self::WRAP { (0, 0) } else { self.extremes(index, POWER) };
            let ahead =
                |place: u32| Ahead { step: self.step(index.wrapping_add(place)), ticks: (ticks + place) as f32 };
            let highest = ahead(high);
            let lowest = if POWER == 0 { highest } else { ahead(low) };
            cursor.index = index.wrapping_add(length);
            cursor.ticks = ticks + length;
            left = left.saturating_sub(length);
            let run = Run {
                #[cfg(test)]
                span: (ticks, length),
                highest,
                lowest,
            };
            if let Some(found) = look(run) {
                return Some(found);
            }
        }
        cursor.left -= last;
        None
    }

    fn step(&self, index: u32) -> f32 {
        if index >= Self::WRAP {
            return 0.0;
        }
        self.steps.get((index & Self::MASK) as usize).copied().unwrap_or(0.0)
    }

    /// Where the run of 2^power steps that holds `index` keeps the places of its extremes.
    fn place(index: u32, power: u32) -> usize {
        let run = ((index & Self::MASK) >> power) as usize;
        match power {
            2 => run,
            4 => N / 4 + run,
            _ => N / 4 + N / 16 + 2 * run,
        }
    }

    /// The places of the highest and the lowest step within the run of 2^power steps that holds `index`.
    #[inline]
    fn extremes(&self, index: u32, power: u32) -> (u32, u32) {
        let place = Self::place(index, power);
        let byte = |at: usize| self.places.get(at).copied().map_or(0, u32::from);
        if power == 6 { (byte(place), byte(place + 1)) } else { (byte(place) >> 4, byte(place) & 15) }
    }

    /// Sets them.
    #[inline]
    fn keep(&mut self, index: u32, power: u32, highest: u32, lowest: u32) {
        let place = Self::place(index, power);
        let mut set = |at: usize, value: u32| {
            if let Some(byte) = self.places.get_mut(at) {
                *byte = value as u8;
            }
        };
        if power == 6 {
            set(place, highest);
            set(place + 1, lowest);
        } else {
            set(place, (highest << 4) | lowest);
        }
    }
}

/// Where a scan has come to.
#[derive(Debug)]
struct Cursor {
    /// Where the next run begins.
    index: u32,
    /// How far ahead that is.
    ticks: u32,
    /// Steps still to be seen.
    left: u32,
}

impl Cursor {
    /// Steps before a run of `size`, a power of two, can begin.
    fn before(&self, size: u32) -> u32 {
        let earliest = self.index.wrapping_add(size.saturating_sub(self.ticks));
        let aligned = earliest.wrapping_add(size - 1) & !(size - 1);
        let steps = aligned.wrapping_sub(self.index);
        if steps < self.left { steps } else { self.left }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::{Window, places};
    use proptest::prelude::*;
    use std::vec::Vec;

    const N: usize = 128;
    type Small = Window<N, { places(N) }>;

    proptest! {
        /// At any time and reach, the runs tile the steps in view and name their extremes and where they lie.
        #[test]
        fn runs_are_what_a_scan_finds(steps in prop::collection::vec(-1.0..1.0f32, 1..500), ahead in 0..N as u32) {
            let mut window = Small::at_rest();
            for &step in &steps {
                window.push(step);
            }
            let seen: Vec<f32> = (0..=ahead as usize)
                .rev()
                .map(|back| if back < steps.len() { steps[steps.len() - 1 - back] } else { 0.0 })
                .collect();
            let mut reached = 0;
            let mut runs = Vec::new();
            window.scan::<()>(ahead, |run| {
                runs.push(run);
                None
            });
            for run in runs {
                let (from, length) = (run.span.0 as usize, run.span.1 as usize);
                prop_assert_eq!(from, reached + 1);
                prop_assert!(length <= from, "{} at {}", length, from);
                let part = &seen[reached..(reached + length).min(seen.len())];
                let highest = part.iter().copied().fold(f32::MIN, f32::max);
                let lowest = part.iter().copied().fold(f32::MAX, f32::min);
                prop_assert_eq!((run.highest.step, run.lowest.step), (highest, lowest));
                for extreme in [run.highest, run.lowest] {
                    prop_assert_eq!(seen[extreme.ticks as usize - 1], extreme.step);
                    prop_assert!((reached + 1..=reached + part.len()).contains(&(extreme.ticks as usize)));
                }
                reached += part.len();
            }
            prop_assert_eq!(reached, seen.len());
        }

        /// A window brought to rest is one that never moved, whatever its slots still hold.
        #[test]
        fn rest_forgets(
            before in prop::collection::vec(-1.0..1.0f32, 1..500),
            after in prop::collection::vec(-1.0..1.0f32, 0..300),
        ) {
            let (mut rested, mut fresh) = (Small::at_rest(), Small::at_rest());
            for step in before {
                rested.push(step);
            }
            rested.rest();
            prop_assert_eq!(shown(&rested), shown(&fresh));
            for step in after {
                rested.push(step);
                fresh.push(step);
                prop_assert_eq!(shown(&rested), shown(&fresh));
            }
        }

        /// A window that has counted as far as it can shows what one shows that has begun anew.
        #[test]
        fn the_count_wraps_unnoticed(steps in prop::collection::vec(-1.0..1.0f32, 2 * N..4 * N), early in 1..=2 * N as u32) {
            let (mut old, mut young) = (Small::at_rest(), Small::at_rest());
            (old.count, young.count) = (Small::WRAP - early, Small::FULL - early);
            for &step in &steps {
                old.push(step);
                young.push(step);
                prop_assert_eq!(shown(&old), shown(&young));
            }
            prop_assert!(old.count == young.count);
        }
    }

    /// All that it can be asked: every step, and the extremes of every run at every reach.
    fn shown(window: &Small) -> Vec<[(f32, f32); 2]> {
        let mut seen: Vec<_> = (0..N as u32).map(|delay| [(window.late(delay), 0.0); 2]).collect();
        for ahead in 0..N as u32 {
            window.scan::<()>(ahead, |run| {
                seen.push([(run.highest.step, run.highest.ticks), (run.lowest.step, run.lowest.ticks)]);
                None
            });
        }
        seen
    }

    /// Every reach at every phase of the runs.
    #[test]
    fn the_work_of_a_tick_is_bounded() {
        let mut window = Window::<512, { places(512) }>::at_rest();
        let mut most = 0;
        for _ in 0..512 {
            window.push(0.0);
            for ahead in 0..512 {
                let mut runs = 0;
                window.scan::<()>(ahead, |_| {
                    runs += 1;
                    None
                });
                most = most.max(runs);
            }
        }
        assert_eq!(most, 25);
    }
}
