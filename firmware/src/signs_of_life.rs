//! When the watchdog is fed: the ticks go on, and the link has been served since it was fed last. A link that hangs alone would
//! leave a stop unheard, ticks that end alone a valve where it stood.

use core::sync::atomic::{AtomicBool, Ordering};

/// What the two tasks have shown of themselves.
#[derive(Debug)]
pub struct SignsOfLife {
    served: AtomicBool,
}

impl SignsOfLife {
    /// Both alive, as at the start.
    pub const fn new() -> Self {
        Self { served: AtomicBool::new(true) }
    }

    /// The link has been served.
    #[inline]
    pub fn served(&self) {
        self.served.store(true, Ordering::Relaxed);
    }

    /// The ticks go on: whether the link has been served since this last said so.
    #[inline]
    pub fn ticked(&self) -> bool {
        // Ticks interrupt the link and are not interrupted by it.
        let alive = self.served.load(Ordering::Relaxed);
        if alive {
            self.served.store(false, Ordering::Relaxed);
        }
        alive
    }
}

impl Default for SignsOfLife {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Feedings in `rounds` of one tick each, the link being served after every one of them up to `hangs`.
    fn fed(rounds: u32, hangs: u32) -> u32 {
        let signs = SignsOfLife::new();
        let mut fed = 0;
        for round in 0..rounds {
            fed += u32::from(signs.ticked());
            if round < hangs {
                signs.served();
            }
        }
        fed
    }

    #[test]
    fn a_link_that_hangs_starves_the_watchdog() {
        assert_eq!(fed(100, 100), 100);
        // The one that it was served for last, and none after.
        assert_eq!(fed(100, 40), 41);
        assert_eq!(fed(100, 0), 1);
    }

    #[test]
    fn a_link_that_is_served_without_ticks_feeds_nothing() {
        let signs = SignsOfLife::new();
        (0..100).for_each(|_| signs.served());
        assert!(signs.ticked() && !signs.ticked());
    }
}
