//! Clocks: 170 MHz from the board's 24 MHz crystal, from an external clock on its pin, or from the internal oscillator where neither starts
//! within its bound; and which peripherals have one. A clock that stops later ends the program, see [`crate::failure`].

use shakedown_core::link::Clock;
use stm32g4::stm32g474::{FLASH, PWR, RCC};

/// Clock of the timers, Hz.
pub const TIMER_HZ: u32 = 170_000_000;
/// Looks at a crystal that is to start: at 16 MHz and about 10 cycles each 20 ms, ten times what one takes, and well within the watchdog's
/// shortest time. The same of an external clock, which runs already: 1 ms. And of what the chip itself makes ready.
const CRYSTAL: u32 = 32_000;
const EXTERNAL: u32 = 1600;
const INTERNAL: u32 = 1600;

const HSE_ON: u32 = 1 << 16;
const HSE_READY: u32 = 1 << 17;
const HSE_BYPASS: u32 = 1 << 18;
const CSS_ON: u32 = 1 << 19;
const PLL_ON: u32 = 1 << 24;
const PLL_READY: u32 = 1 << 25;
/// `PLLCFGR`: 4 MHz times 85, output R on, by 2. The source's divider and its choice are added: 24 MHz by 6, or 16 by 4.
const PLL: u32 = 85 << 8 | 1 << 24;
const FROM_HSE: u32 = (6 - 1) << 4 | 0b11;
const FROM_HSI: u32 = (4 - 1) << 4 | 0b10;
/// `ACR`: four wait states, with prefetch and both caches (table of the wait states, range 1 boost).
const WAIT_STATES: u32 = 4 | 1 << 8 | 1 << 9 | 1 << 10;
/// `CFGR`: from the PLL, buses undivided; the core's clock halved while it changes over.
const SYSCLK_PLL: u32 = 0b11;
const HALVED: u32 = 0b1000 << 4;
/// `PWR_CR5`: not set is boost.
const NO_BOOST: u32 = 1 << 8;
/// Cycles of the change-over at half speed: 1 microsecond and more.
const CHANGE_OVER: u32 = 200;

/// Sets the clocks, and gives one to each peripheral that is used; which clock it is, or none where the chip's own loop does not lock.
pub fn start(rcc: &RCC, flash: &FLASH, power: &PWR) -> Option<Clock> {
    enable(rcc);
    power.cr5().modify(|r, w| unsafe { w.bits(r.bits() & !NO_BOOST) });
    flash.acr().modify(|r, w| unsafe { w.bits(r.bits() & !0xF | WAIT_STATES) });
    let clock = find(rcc);
    let source = if clock == Clock::Internal { FROM_HSI } else { FROM_HSE };
    rcc.pllcfgr().write(|w| unsafe { w.bits(PLL | source) });
    set(rcc, PLL_ON);
    if !ready(rcc, PLL_READY, INTERNAL) {
        return None;
    }
    rcc.cfgr().write(|w| unsafe { w.bits(HALVED | SYSCLK_PLL) });
    if !(0..INTERNAL).any(|_| rcc.cfgr().read().bits() >> 2 & 0b11 == SYSCLK_PLL) {
        return None;
    }
    cortex_m::asm::delay(CHANGE_OVER);
    rcc.cfgr().write(|w| unsafe { w.bits(SYSCLK_PLL) });
    if clock != Clock::Internal {
        set(rcc, CSS_ON);
    }
    // 48 MHz for the generator of random numbers.
    rcc.crrcr().modify(|r, w| unsafe { w.bits(r.bits() | 1) });
    Some(clock)
}

/// Clocks of what is used, and a read after each, for the next access may come two cycles too early otherwise.
fn enable(rcc: &RCC) {
    // DMA1, DMAMUX.
    rcc.ahb1enr().modify(|r, w| unsafe { w.bits(r.bits() | 1 | 1 << 2) });
    // GPIOA, B, C; ADC12; DAC1; RNG.
    rcc.ahb2enr().modify(|r, w| unsafe { w.bits(r.bits() | 0b111 | 1 << 13 | 1 << 16 | 1 << 26) });
    // TIM2, USART3, PWR.
    rcc.apb1enr1().modify(|r, w| unsafe { w.bits(r.bits() | 1 | 1 << 18 | 1 << 28) });
    let _ = (rcc.ahb1enr().read(), rcc.ahb2enr().read(), rcc.apb1enr1().read());
}

/// The first that starts: crystal, external clock, and the internal oscillator, which runs since the reset.
fn find(rcc: &RCC) -> Clock {
    set(rcc, HSE_ON);
    if ready(rcc, HSE_READY, CRYSTAL) {
        return Clock::Crystal;
    }
    // Bypassed only while off.
    clear(rcc, HSE_ON);
    set(rcc, HSE_BYPASS);
    set(rcc, HSE_ON);
    if ready(rcc, HSE_READY, EXTERNAL) {
        return Clock::External;
    }
    clear(rcc, HSE_ON);
    clear(rcc, HSE_BYPASS);
    Clock::Internal
}

fn set(rcc: &RCC, bit: u32) {
    rcc.cr().modify(|r, w| unsafe { w.bits(r.bits() | bit) });
}

fn clear(rcc: &RCC, bit: u32) {
    rcc.cr().modify(|r, w| unsafe { w.bits(r.bits() & !bit) });
}

fn ready(rcc: &RCC, bit: u32, looks: u32) -> bool {
    (0..looks).any(|_| rcc.cr().read().bits() & bit != 0)
}

/// Whether the last reset was the watchdog's, or one that the program asked for after a panic; clears the flags.
pub fn restarted(rcc: &RCC) -> bool {
    const WATCHDOG: u32 = 1 << 29;
    const SOFTWARE: u32 = 1 << 28;
    const CLEAR: u32 = 1 << 23;
    let flags = rcc.csr().read().bits();
    rcc.csr().modify(|r, w| unsafe { w.bits(r.bits() | CLEAR) });
    flags & (WATCHDOG | SOFTWARE) != 0
}
