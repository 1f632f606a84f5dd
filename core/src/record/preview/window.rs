//! The last N samples of the reference, and the extremes of every aligned run of 2, 4, 8 ... of them.

/// One sample of the reference.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// Displacement, m.
    pub(super) displacement: f32,
    /// Displacement moved in that tick, m.
    pub(super) step: f32,
}

/// A step and the slot that holds it.
#[derive(Debug, Clone, Copy)]
struct Extreme {
    step: f32,
    slot: u16,
}

/// The highest and the lowest step of a run of samples.
#[derive(Debug, Clone, Copy)]
struct Extremes {
    highest: Extreme,
    lowest: Extreme,
}

/// A ring of samples under a pyramid of extremes: the runs of 2 in the first half of `pyramid`, of 4 in the next quarter...
#[derive(Debug, Clone)]
pub(super) struct Window<const N: usize> {
    samples: [Point; N],
    pyramid: [Extremes; N],
    /// Samples pushed so far; wraps, which a power of two does not notice.
    count: u32,
}

/// A step at a distance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ahead {
    /// Displacement moved in one tick, m.
    pub(super) step: f32,
    /// How many ticks after the last sample answered.
    pub(super) ticks: f32,
}

/// The extremes of one run of samples in view.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    pub(super) highest: Ahead,
    pub(super) lowest: Ahead,
}

/// A run is at most its distance divided by this: 4 costs less than 0.1 % of the acceleration error (`tests.rs`).
const FINENESS: u32 = 4;

impl<const N: usize> Window<N> {
    /// Slots are found by masking and written in 16 bits.
    const MASK: u32 = {
        assert!(N.is_power_of_two() && N >= 2 && N <= 1 << 15, "the preview window holds a power of two of samples");
        N as u32 - 1
    };

    /// Full of one sample.
    pub(super) fn filled(point: Point) -> Self {
        let none = Extreme { step: point.step, slot: 0 };
        let mut window = Self { samples: [point; N], pyramid: [Extremes { highest: none, lowest: none }; N], count: 0 };
        for _ in 0..N {
            window.push(point);
        }
        window
    }

    /// Takes the newest sample and completes the runs that end with it.
    pub(super) fn push(&mut self, point: Point) {
        let index = self.count;
        if let Some(slot) = self.samples.get_mut((index & Self::MASK) as usize) {
            *slot = point;
        }
        self.count = index.wrapping_add(1);
        let mut level = 1;
        while level <= N.trailing_zeros() && self.count.trailing_zeros() >= level {
            let half = 1 << (level - 1);
            let early = self.extremes(index.wrapping_sub(2 * half - 1), level - 1);
            let late = self.extremes(index.wrapping_sub(half - 1), level - 1);
            if let Some(place) = self.pyramid.get_mut(Self::place(index, level)) {
                *place = merge(early, late);
            }
            level += 1;
        }
    }

    /// The sample pushed `delay` ticks before the newest.
    pub(super) fn point(&self, delay: u32) -> Point {
        let index = self.count.wrapping_sub(1).wrapping_sub(delay);
        self.samples.get((index & Self::MASK) as usize).copied().unwrap_or(Point { displacement: 0.0, step: 0.0 })
    }

    /// The runs that cover the newest `ahead` + 1 samples, oldest first.
    pub(super) fn runs(&self, ahead: u32) -> Runs<'_, N> {
        let first = self.count.wrapping_sub(1).wrapping_sub(ahead);
        Runs { window: self, first, ticks: 1, last: ahead + 1 }
    }

    /// Where the run of 2^level samples that holds `index` keeps its extremes.
    fn place(index: u32, level: u32) -> usize {
        let base = N - (N >> (level - 1));
        base + ((index & Self::MASK) >> level) as usize
    }

    /// The extremes of the run of 2^level samples that holds `index`.
    fn extremes(&self, index: u32, level: u32) -> Extremes {
        let slot = index & Self::MASK;
        if level > 0
            && let Some(extremes) = self.pyramid.get(Self::place(index, level))
        {
            return *extremes;
        }
        let step = self.samples.get(slot as usize).map_or(0.0, |point| point.step);
        let extreme = Extreme { step, slot: slot as u16 };
        Extremes { highest: extreme, lowest: extreme }
    }
}

/// The extremes of two neighbouring runs; of equals the earlier, which binds first.
fn merge(early: Extremes, late: Extremes) -> Extremes {
    Extremes {
        highest: if late.highest.step > early.highest.step { late.highest } else { early.highest },
        lowest: if late.lowest.step < early.lowest.step { late.lowest } else { early.lowest },
    }
}

/// Runs in order of time.
#[derive(Debug)]
pub(super) struct Runs<'a, const N: usize> {
    window: &'a Window<N>,
    first: u32,
    ticks: u32,
    last: u32,
}

impl<const N: usize> Iterator for Runs<'_, N> {
    type Item = Run;

    fn next(&mut self) -> Option<Run> {
        let left = (self.last + 1).checked_sub(self.ticks).filter(|&left| left > 0)?;
        let index = self.first.wrapping_add(self.ticks - 1);
        let level = index
            .trailing_zeros()
            .min((self.ticks / FINENESS).checked_ilog2().unwrap_or(0))
            .min(left.checked_ilog2().unwrap_or(0));
        self.ticks += 1 << level;
        let found = self.window.extremes(index, level);
        let ahead = |extreme: Extreme| Ahead {
            step: extreme.step,
            ticks: (u32::from(extreme.slot).wrapping_sub(self.first) & Window::<N>::MASK) as f32 + 1.0,
        };
        Some(Run { highest: ahead(found.highest), lowest: ahead(found.lowest) })
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::{Point, Window};
    use proptest::prelude::*;
    use std::vec::Vec;

    const N: usize = 64;

    proptest! {
        /// At any time and reach, the runs tile the samples in view and name their extremes and where they lie.
        #[test]
        fn runs_are_what_a_scan_finds(steps in prop::collection::vec(-1.0..1.0f32, 1..300), ahead in 0..N as u32) {
            let mut window = Window::<N>::filled(Point { displacement: 0.0, step: 0.0 });
            for &step in &steps {
                window.push(Point { displacement: 0.0, step });
            }
            let seen: Vec<f32> = (0..=ahead as usize)
                .rev()
                .map(|back| if back < steps.len() { steps[steps.len() - 1 - back] } else { 0.0 })
                .collect();
            let mut reached = 0;
            let mut runs = 0;
            let mut iterator = window.runs(ahead);
            while let Some(run) = iterator.next() {
                let end = iterator.ticks as usize - 1;
                let part = &seen[reached..end];
                let highest = part.iter().copied().fold(f32::MIN, f32::max);
                let lowest = part.iter().copied().fold(f32::MAX, f32::min);
                prop_assert_eq!((run.highest.step, run.lowest.step), (highest, lowest));
                prop_assert_eq!(seen[run.highest.ticks as usize - 1], highest);
                prop_assert_eq!(seen[run.lowest.ticks as usize - 1], lowest);
                prop_assert!((reached + 1..=end).contains(&(run.highest.ticks as usize)));
                prop_assert!(part.len() == 1 || part.len() * 4 <= reached + 1, "{} at {}", part.len(), reached);
                reached = end;
                runs += 1;
            }
            prop_assert_eq!(reached, seen.len());
            prop_assert!(runs <= 6 * N.ilog2() - 13);
        }
    }

    /// Every reach at every phase of the pyramid: the whole window takes 37 runs at most, a reach that ends off the
    /// pyramid's joints four more.
    #[test]
    fn the_work_of_a_tick_is_bounded() {
        let mut window = Window::<512>::filled(Point { displacement: 0.0, step: 0.0 });
        let (mut whole, mut any) = (0, 0);
        for _ in 0..512 {
            window.push(Point { displacement: 0.0, step: 0.0 });
            whole = whole.max(window.runs(511).count());
            any = (0..512).map(|ahead| window.runs(ahead).count()).fold(any, usize::max);
        }
        assert_eq!((whole, any), (37, 41));
    }
}
