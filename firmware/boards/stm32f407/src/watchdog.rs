//! The independent watchdog's registers and times.
//!
//! Its clock is any between 17 and 47 kHz (data sheet, f_LSI), 32 at most parts: what is 56 ms on most is 38 to 105 ms, and 8 s are 5.4 to
//! 15, longer than the slowest erase of a 128 KiB sector (4 s at 1.8 V, data sheet table 40).

use shakedown_firmware::OpenRelay;
use shakedown_firmware::watchdog;
use stm32f4xx_hal::pac::IWDG;

/// The watchdog, running.
pub type Watchdog = watchdog::Watchdog<Registers>;

/// Its registers.
pub struct Registers(pub IWDG);

impl watchdog::Registers for Registers {
    #[inline]
    fn key(&self, key: u16) {
        // SAFETY: every key is a value that the register is specified for.
        self.0.kr().write(|w| unsafe { w.key().bits(key) });
    }

    fn busy(&self) -> bool {
        self.0.sr().read().bits() != 0
    }

    fn set(&self, prescaler: u8, reload: u16) {
        // SAFETY: 6 is the last prescaler the register is specified for, and a reload has twelve bits.
        self.0.pr().write(|w| unsafe { w.pr().bits(prescaler) });
        self.0.rlr().write(|w| w.rl().set(reload));
    }
}

/// Lets `work` take seconds. Only with the ticks stopped, so that nobody feeds the watchdog meanwhile.
pub fn patiently<T>(open: &OpenRelay, work: impl FnOnce() -> T) -> T {
    // SAFETY: whoever owns the watchdog runs in ticks, of which there are none meanwhile.
    Watchdog::running(Registers(unsafe { IWDG::steal() })).patiently(open, work)
}
