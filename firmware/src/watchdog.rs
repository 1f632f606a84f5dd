//! An independent watchdog of ST's kind: a program that hangs is reset, and a reset opens the relay. Which times its counts are is the
//! board's to say, for its clock is as exact as the chip makes it.
//!
//! It is fed when the ticks go on and the link has been served since: one that hangs alone would leave a stop unheard.

use crate::OpenRelay;
use crate::signs_of_life::SignsOfLife;

const UNLOCK: u16 = 0x5555;
const RELOAD: u16 = 0xAAAA;
const START: u16 = 0xCCCC;
/// Counts of 8 ms at a prescaler of 256 and 32 kHz.
const PRESCALER_256: u8 = 0b110;
/// 7 periods: 56 ms at 32 kHz.
const WATCHFUL: u16 = 6;
/// 8 s at 32 kHz.
const PATIENT: u16 = 1000;

/// Looks at a setting that takes five periods of the watchdog's clock, 0.3 ms at most. Without a clock it would take for ever, and
/// there is nothing to be said then that the absence of resets at commissioning does not say.
const CROSSING: u32 = 100_000;

static SIGNS: SignsOfLife = SignsOfLife::new();

/// Its registers.
pub trait Registers {
    /// Writes one of its keys.
    fn key(&self, key: u16);

    /// Whether a setting has not reached the watchdog's own clock yet.
    fn busy(&self) -> bool;

    /// Sets prescaler and reload, once unlocked.
    fn set(&self, prescaler: u8, reload: u16);
}

/// The watchdog, running.
#[derive(Debug)]
pub struct Watchdog<R>(R);

impl<R: Registers> Watchdog<R> {
    /// Starts it; nothing but a reset stops it.
    pub fn start(registers: R) -> Self {
        let watchdog = Self(registers);
        watchdog.0.key(START);
        watchdog.limit(WATCHFUL);
        watchdog
    }

    /// The one that was started, in other hands.
    pub const fn running(registers: R) -> Self {
        Self(registers)
    }

    /// The ticks go on; if the link does too, the program is alive.
    #[inline]
    pub fn feed(&self) {
        if SIGNS.ticked() {
            self.0.key(RELOAD);
        }
    }

    /// Lets `work` take seconds. Only with the ticks stopped, so that nobody feeds the watchdog meanwhile.
    pub fn patiently<T>(&self, _: &OpenRelay, work: impl FnOnce() -> T) -> T {
        self.limit(PATIENT);
        let done = work();
        self.limit(WATCHFUL);
        done
    }

    fn settle(&self) {
        let _ = (0..CROSSING).any(|_| !self.0.busy());
    }

    fn limit(&self, counts: u16) {
        self.0.key(UNLOCK);
        self.settle();
        self.0.set(PRESCALER_256, counts);
        self.settle();
        self.0.key(RELOAD);
    }
}

/// The link has been served.
pub fn served() {
    SIGNS.served();
}
