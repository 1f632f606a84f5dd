//! The independent watchdog: a program that hangs is reset, and a reset opens the relay.
//!
//! Its clock is any between 29 and 34 kHz (data sheet, f_LSI over temperature and supply), 32 at most parts: what is 56 ms on most is 52
//! to 62 ms. It is fed when the ticks go on and the link has been served since: one that hangs alone would leave a stop unheard.

use shakedown_firmware::OpenRelay;
use shakedown_firmware::signs_of_life::SignsOfLife;
use stm32g4::stm32g474::IWDG;

const UNLOCK: u16 = 0x5555;
const RELOAD: u16 = 0xAAAA;
const START: u16 = 0xCCCC;
/// Counts of 8 ms at a prescaler of 256 and 32 kHz.
const PRESCALER_256: u8 = 0b110;
/// 7 periods: 52 to 62 ms.
const WATCHFUL: u16 = 6;
/// 7.5 to 8.8 s, longer than any erase of a page (25 ms).
const PATIENT: u16 = 1000;

/// Looks at a setting that takes five periods of the watchdog's clock, 0.3 ms at most. Without a clock it would take for ever, and
/// there is nothing to be said then that the absence of resets at commissioning does not say.
const CROSSING: u32 = 100_000;

static SIGNS: SignsOfLife = SignsOfLife::new();

/// The watchdog, running.
pub struct Watchdog(IWDG);

impl Watchdog {
    /// Starts it; nothing but a reset stops it.
    pub fn start(watchdog: IWDG) -> Self {
        let watchdog = Self(watchdog);
        watchdog.key(START);
        watchdog.limit(WATCHFUL);
        watchdog
    }

    /// The ticks go on; if the link does too, the program is alive.
    #[inline]
    pub fn feed(&self) {
        if SIGNS.ticked() {
            self.key(RELOAD);
        }
    }

    fn settle(&self) {
        let _ = (0..CROSSING).any(|_| self.0.sr().read().bits() == 0);
    }

    #[inline]
    fn key(&self, key: u16) {
        // SAFETY: every key is a value that the register is specified for.
        self.0.kr().write(|w| unsafe { w.bits(key) });
    }

    fn limit(&self, counts: u16) {
        self.key(UNLOCK);
        self.settle();
        // SAFETY: 6 is the last prescaler the register is specified for.
        self.0.pr().write(|w| unsafe { w.bits(u16::from(PRESCALER_256)) });
        // SAFETY: twelve bits of a count.
        self.0.rlr().write(|w| unsafe { w.bits(counts) });
        self.settle();
        self.key(RELOAD);
    }
}

/// The link has been served.
pub fn served() {
    SIGNS.served();
}

/// Lets `work` take seconds. Only with the ticks stopped, so that nobody feeds the watchdog meanwhile.
pub fn patiently<T>(_: &OpenRelay, work: impl FnOnce() -> T) -> T {
    // SAFETY: whoever owns the watchdog runs in ticks, of which there are none meanwhile.
    let watchdog = Watchdog(unsafe { IWDG::steal() });
    watchdog.limit(PATIENT);
    let done = work();
    watchdog.limit(WATCHFUL);
    done
}
