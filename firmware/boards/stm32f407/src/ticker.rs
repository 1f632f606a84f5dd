//! The tick: TIM2's update is the converter's trigger, so that no program decides when a sample is taken.

use shakedown_firmware::OpenRelay;
use shakedown_firmware::parts::{self, Ticker as _};
use stm32f4xx_hal::{
    pac::TIM2,
    rcc::{Enable, Rcc, Reset},
};

use crate::clock::TIMER_HZ;

/// Counts of the pulse that starts a conversion: 1 microsecond.
const START_PULSE: u32 = 84;

/// Looks for the first update, of ten cycles each: 30 ms, longer than any period, shorter than the watchdog.
const FIRST: u32 = 500_000;

/// The timer, and whether a conversion's end is a compare.
pub struct Ticker(TIM2, bool);

impl Ticker {
    /// A timer of `rate` updates a second that does not run yet.
    ///
    /// Where a conversion takes so many counts and does not tell its end itself, the tick comes with a compare of channel 1 so long
    /// after the update, and channel 2 starts the conversion by a pulse on its pin.
    pub fn new(timer: TIM2, rate: u32, conversion: Option<u32>, rcc: &mut Rcc) -> Self {
        TIM2::enable(rcc);
        TIM2::reset(rcc);
        let ticker = Self(timer, conversion.is_some());
        ticker.0.cr2().modify(|_, w| w.mms().update());
        // Before the reload is preloaded: else it would count from the next update on, which at the register's reset value is 51 s away.
        ticker.set_rate(rate);
        ticker.0.cr1().modify(|_, w| w.arpe().enabled());
        if let Some(counts) = conversion {
            ticker.0.ccr1().write(|w| w.ccr().set(counts));
            ticker.0.ccr2().write(|w| w.ccr().set(START_PULSE));
            ticker.0.ccmr1_output().write(|w| w.oc2m().pwm_mode1());
            ticker.0.ccer().write(|w| w.cc2e().set_bit());
        }
        ticker
    }

    /// Lets it run. Where the tick comes by a compare, the first is the one after the first update, which starts the first conversion.
    pub fn start(&self) {
        self.0.cr1().modify(|_, w| w.cen().enabled());
        if self.1 {
            let _ = (0..FIRST).any(|_| self.0.sr().read().uif().bit_is_set());
            // SAFETY: zeros clear every flag.
            self.0.sr().write(|w| unsafe { w.bits(0) });
            self.0.dier().write(|w| w.cc1ie().enabled());
        }
    }
}

impl parts::Ticker for Ticker {
    /// `rate` updates a second from the next one on; the nearest that 84 MHz divides to.
    fn set_rate(&self, rate: u32) {
        let period = (TIMER_HZ + rate / 2) / rate.max(1);
        self.0.arr().write(|w| w.set(period.max(1) - 1));
    }
}

/// Stops the ticks while `work` runs, for a flash erase, which stalls the processor.
pub fn without_ticks<T>(_: &OpenRelay, work: impl FnOnce() -> T) -> T {
    // SAFETY: only CR1.CEN is touched, and whoever owns the timer runs in ticks, of which there are none meanwhile.
    let timer = unsafe { TIM2::steal() };
    timer.cr1().modify(|_, w| w.cen().disabled());
    let done = work();
    timer.cr1().modify(|_, w| w.cen().enabled());
    done
}
