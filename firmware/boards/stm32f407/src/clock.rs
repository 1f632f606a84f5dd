//! Clocks: 168 MHz from the 8 MHz crystal, from an external clock on its pin, or from the internal oscillator where neither
//! starts within its bound. A clock that stops later ends the program, see [`crate::failure`].

use shakedown_core::link::Clock;
use stm32f4xx_hal::{
    pac,
    prelude::*,
    rcc::{Config, Rcc},
};

/// Timer clock of APB1, Hz.
pub const TIMER_HZ: u32 = 84_000_000;
/// Looks at a crystal that is to start: at 16 MHz and about 10 cycles each 20 ms, ten times what one takes (data sheet, t_SU(HSE)
/// 2 ms), and well within the watchdog's shortest time.
const CRYSTAL: u32 = 32_000;
/// The same of an external clock, which runs already: 1 ms.
const EXTERNAL: u32 = 1600;

/// Sets the clocks; which one it is.
pub fn start(rcc: pac::RCC) -> (Rcc, Clock) {
    let clock = find(&rcc);
    let hse = Config::hse(8.MHz());
    let config = match clock {
        Clock::Crystal => hse,
        Clock::External => hse.bypass_hse_oscillator(),
        Clock::Internal => Config::hsi(),
    };
    let config = config.sysclk(168.MHz()).hclk(168.MHz()).pclk1(42.MHz()).pclk2(84.MHz()).require_pll48clk();
    let rcc = rcc.freeze(config);
    if clock != Clock::Internal {
        rcc.cr().modify(|_, w| w.csson().set_bit());
    }
    (rcc, clock)
}

/// The first that starts: crystal, external clock, and the internal oscillator, which runs since the reset.
fn find(rcc: &pac::RCC) -> Clock {
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    if ready(rcc, CRYSTAL) {
        return Clock::Crystal;
    }
    // Bypassed only while off (RM0090, 7.3.1).
    rcc.cr().modify(|_, w| w.hseon().clear_bit());
    rcc.cr().modify(|_, w| w.hsebyp().set_bit());
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    if ready(rcc, EXTERNAL) {
        return Clock::External;
    }
    rcc.cr().modify(|_, w| w.hseon().clear_bit());
    rcc.cr().modify(|_, w| w.hsebyp().clear_bit());
    Clock::Internal
}

fn ready(rcc: &pac::RCC, looks: u32) -> bool {
    (0..looks).any(|_| rcc.cr().read().hserdy().bit_is_set())
}

/// Whether the last reset was the watchdog's, or one that the program asked for after a panic; clears the flags.
pub fn restarted(rcc: &Rcc) -> bool {
    let flags = rcc.csr().read();
    let restarted = flags.wdgrstf().bit_is_set() || flags.sftrstf().bit_is_set();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    restarted
}
