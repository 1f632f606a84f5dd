//! The tick: TIM2's update is the converter's trigger, so that no program decides when a sample is taken.

use shakedown_firmware::OpenRelay;
use stm32f4xx_hal::{
    pac::TIM2,
    rcc::{Enable, Rcc, Reset},
};

use super::clock::TIMER_HZ;

/// The timer.
pub(crate) struct Ticker(TIM2);

impl Ticker {
    /// A timer of `rate` updates a second that does not run yet.
    pub(crate) fn new(timer: TIM2, rate: u32, rcc: &mut Rcc) -> Self {
        TIM2::enable(rcc);
        TIM2::reset(rcc);
        let ticker = Self(timer);
        ticker.0.cr2().modify(|_, w| w.mms().update());
        ticker.0.cr1().modify(|_, w| w.arpe().enabled());
        ticker.set_rate(rate);
        ticker
    }

    /// `rate` updates a second from the next one on; the nearest that 84 MHz divides to.
    pub(crate) fn set_rate(&self, rate: u32) {
        let period = (TIMER_HZ + rate / 2) / rate.max(1);
        self.0.arr().write(|w| w.set(period.max(1) - 1));
    }

    /// Lets it run.
    pub(crate) fn start(&self) {
        self.0.cr1().modify(|_, w| w.cen().enabled());
    }
}

/// Stops the ticks while `work` runs, for a flash erase, which stalls the processor.
pub(crate) fn without_ticks<T>(_: &OpenRelay, work: impl FnOnce() -> T) -> T {
    // SAFETY: only CR1.CEN is touched, and whoever owns the timer runs in ticks, of which there are none meanwhile.
    let timer = unsafe { TIM2::steal() };
    timer.cr1().modify(|_, w| w.cen().disabled());
    let done = work();
    timer.cr1().modify(|_, w| w.cen().enabled());
    done
}
