//! Clocks: 168 MHz from the 8 MHz crystal, or from the internal oscillator where no crystal starts.

use stm32f4xx_hal::{
    pac,
    prelude::*,
    rcc::{Config, Rcc},
};

/// Timer clock of APB1, Hz.
pub(crate) const TIMER_HZ: u32 = 84_000_000;

/// Sets the clocks.
pub(crate) fn start(rcc: pac::RCC) -> Rcc {
    rcc.freeze(Config::hse(8.MHz()).sysclk(168.MHz()).hclk(168.MHz()).pclk1(42.MHz()).pclk2(84.MHz()))
}

/// Whether the last reset was the watchdog's, or one that the program asked for after a panic; clears the flags.
pub(crate) fn restarted(rcc: &Rcc) -> bool {
    let flags = rcc.csr().read();
    let restarted = flags.wdgrstf().bit_is_set() || flags.sftrstf().bit_is_set();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    restarted
}
