//! Three words that the loop publishes each tick and anyone may read.

use core::sync::atomic::{AtomicU32, Ordering};

use shakedown_firmware::queues::Standing;

static STANDING: AtomicU32 = AtomicU32::new(0);
static TICKS: AtomicU32 = AtomicU32::new(0);
static DROPPED: AtomicU32 = AtomicU32::new(0);

/// Publishes. Returns whether the standing changed.
#[inline]
pub(crate) fn publish(standing: Standing, ticks: u32, dropped: u32) -> bool {
    let word = standing.to_word();
    let changed = STANDING.load(Ordering::Relaxed) != word;
    STANDING.store(word, Ordering::Relaxed);
    TICKS.store(ticks, Ordering::Relaxed);
    DROPPED.store(dropped, Ordering::Relaxed);
    changed
}

/// What was published last: where the loop stands, ticks, records dropped.
pub(crate) fn read() -> (Standing, u32, u32) {
    (
        Standing::from_word(STANDING.load(Ordering::Relaxed)),
        TICKS.load(Ordering::Relaxed),
        DROPPED.load(Ordering::Relaxed),
    )
}
