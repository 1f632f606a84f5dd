//! The independent watchdog's registers and times.
//!
//! Its clock is any between 29 and 34 kHz (data sheet, f_LSI over temperature and supply), 32 at most parts: what is 56 ms on most is 52
//! to 62 ms, and 8 s are 7.5 to 8.8, longer than any erase of a page (25 ms).

use shakedown_firmware::OpenRelay;
use shakedown_firmware::watchdog;
use stm32g4::stm32g474::IWDG;

/// The watchdog, running.
pub type Watchdog = watchdog::Watchdog<Registers>;

/// Its registers.
pub struct Registers(pub IWDG);

impl watchdog::Registers for Registers {
    #[inline]
    fn key(&self, key: u16) {
        // SAFETY: every key is a value that the register is specified for.
        self.0.kr().write(|w| unsafe { w.bits(key) });
    }

    fn busy(&self) -> bool {
        self.0.sr().read().bits() != 0
    }

    fn set(&self, prescaler: u8, reload: u16) {
        // SAFETY: 6 is the last prescaler the register is specified for, and a reload has twelve bits.
        self.0.pr().write(|w| unsafe { w.bits(u16::from(prescaler)) });
        self.0.rlr().write(|w| unsafe { w.bits(reload) });
    }
}

/// Lets `work` take seconds. Only with the ticks stopped, so that nobody feeds the watchdog meanwhile.
pub fn patiently<T>(open: &OpenRelay, work: impl FnOnce() -> T) -> T {
    // SAFETY: whoever owns the watchdog runs in ticks, of which there are none meanwhile.
    Watchdog::running(Registers(unsafe { IWDG::steal() })).patiently(open, work)
}
