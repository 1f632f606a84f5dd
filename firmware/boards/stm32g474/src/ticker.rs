//! The tick: TIM2's update is the converter's trigger, so that no program decides when a sample is taken.

use shakedown_firmware::OpenRelay;
use shakedown_firmware::parts::{self, Ticker as _};
use stm32g4::stm32g474::TIM2;

use crate::clock::TIMER_HZ;

/// `CR1`: counts, the reload preloaded. `CR2`: the update is the trigger output.
const COUNTS: u32 = 1;
const PRELOADED: u32 = 1 << 7;
const UPDATE: u32 = 0b010 << 4;

/// The timer.
pub struct Ticker(TIM2);

impl Ticker {
    /// A timer of `rate` updates a second that does not run yet.
    pub fn new(timer: TIM2, rate: u32) -> Self {
        let ticker = Self(timer);
        ticker.0.cr2().write(|w| unsafe { w.bits(UPDATE) });
        // Before the reload is preloaded: else it would count from the next update on, which at the register's reset value is 25 s away.
        ticker.set_rate(rate);
        ticker.0.cr1().write(|w| unsafe { w.bits(PRELOADED) });
        ticker
    }

    /// Lets it run.
    pub fn start(&self) {
        self.0.cr1().modify(|r, w| unsafe { w.bits(r.bits() | COUNTS) });
    }
}

impl parts::Ticker for Ticker {
    /// `rate` updates a second from the next one on; the nearest that 170 MHz divides to.
    fn set_rate(&self, rate: u32) {
        let period = (TIMER_HZ + rate / 2) / rate.max(1);
        // SAFETY: the register takes any 32 bits.
        self.0.arr().write(|w| unsafe { w.bits(period.max(1) - 1) });
    }
}

/// Stops the ticks while `work` runs, for a flash erase.
pub fn without_ticks<T>(_: &OpenRelay, work: impl FnOnce() -> T) -> T {
    // SAFETY: only CR1.CEN is touched, and whoever owns the timer runs in ticks, of which there are none meanwhile.
    let timer = unsafe { TIM2::steal() };
    timer.cr1().modify(|r, w| unsafe { w.bits(r.bits() & !COUNTS) });
    let done = work();
    timer.cr1().modify(|r, w| unsafe { w.bits(r.bits() | COUNTS) });
    done
}
