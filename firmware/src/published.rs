//! Three words that the loop publishes and anyone may read.

use core::sync::atomic::{AtomicU32, Ordering};

use crate::queues::TestStatus;

static STANDING: AtomicU32 = AtomicU32::new(0);
static TICKS: AtomicU32 = AtomicU32::new(0);
static DROPPED: AtomicU32 = AtomicU32::new(0);

/// Publishes where the loop stands, how many ticks there were and how many records found no room; needed before the server is
/// woken.
pub fn publish(standing: TestStatus, ticks: u32, dropped: u32) {
    TICKS.store(ticks, Ordering::Relaxed);
    STANDING.store(standing.to_word(), Ordering::Relaxed);
    DROPPED.store(dropped, Ordering::Relaxed);
}

/// What was published last: where the loop stands, ticks, records dropped.
pub fn read() -> (TestStatus, u32, u32) {
    (
        TestStatus::from_word(STANDING.load(Ordering::Relaxed)),
        TICKS.load(Ordering::Relaxed),
        DROPPED.load(Ordering::Relaxed),
    )
}
