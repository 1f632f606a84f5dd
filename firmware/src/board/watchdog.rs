//! The independent watchdog: a program that hangs for 50 ms is reset, and a reset opens the relay.

use shakedown_firmware::OpenRelay;
use stm32f4xx_hal::pac::IWDG;

const UNLOCK: u16 = 0x5555;
const RELOAD: u16 = 0xAAAA;
const START: u16 = 0xCCCC;
/// Counts of 8 ms at a prescaler of 256 and 32 kHz.
const PRESCALER_256: u8 = 0b110;
/// About 50 ms.
const WATCHFUL: u16 = 6;
/// About 8 s, longer than the slowest erase of a 128 KiB sector (4 s at 1.8 V, data sheet table 40).
const PATIENT: u16 = 1000;

/// The watchdog, running.
pub(crate) struct Watchdog(IWDG);

impl Watchdog {
    /// Starts it; nothing but a reset stops it.
    pub(crate) fn start(watchdog: IWDG) -> Self {
        let watchdog = Self(watchdog);
        watchdog.key(START);
        watchdog.limit(WATCHFUL);
        watchdog
    }

    /// The program is alive.
    #[inline]
    pub(crate) fn feed(&self) {
        self.key(RELOAD);
    }

    #[inline]
    fn key(&self, key: u16) {
        // SAFETY: every key is a value that the register is specified for.
        self.0.kr().write(|w| unsafe { w.key().bits(key) });
    }

    fn limit(&self, counts: u16) {
        self.key(UNLOCK);
        while self.0.sr().read().bits() != 0 {}
        // SAFETY: 6 is the last prescaler the register is specified for.
        self.0.pr().write(|w| unsafe { w.pr().bits(PRESCALER_256) });
        self.0.rlr().write(|w| w.rl().set(counts));
        while self.0.sr().read().bits() != 0 {}
        self.key(RELOAD);
    }
}

/// Lets `work` take seconds. Only with the ticks stopped, so that nobody feeds the watchdog meanwhile.
pub(crate) fn patiently<T>(_: &OpenRelay, work: impl FnOnce() -> T) -> T {
    // SAFETY: whoever owns the watchdog runs in ticks, of which there are none meanwhile.
    let watchdog = Watchdog(unsafe { IWDG::steal() });
    watchdog.limit(PATIENT);
    let done = work();
    watchdog.limit(WATCHFUL);
    done
}
