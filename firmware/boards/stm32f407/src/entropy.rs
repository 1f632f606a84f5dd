//! A number that differs from reset to reset, for challenges.

use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::{DCB, DWT};
use stm32f4xx_hal::{
    pac::RNG,
    rcc::{Enable, Rcc, Reset},
};

/// Looks at a generator that takes 40 of its cycles, 140 of the processor's, for a word.
const LOOKS: u32 = 1000;

/// Memory that a reset leaves as it was, and power-on leaves to chance.
#[unsafe(link_section = ".uninit.entropy")]
static KEPT: MaybeUninit<AtomicU32> = MaybeUninit::uninit();

/// The chip's random numbers, stirred into what chance left at power-on, every reset since and the cycles that the start took:
/// a generator that fails leaves the rest.
pub fn gather(random: &RNG, dcb: &mut DCB, dwt: &mut DWT, rcc: &mut Rcc) -> u64 {
    dcb.enable_trace();
    dwt.enable_cycle_counter();
    RNG::enable(rcc);
    RNG::reset(rcc);
    random.cr().modify(|_, w| w.rngen().set_bit());
    let drawn = u64::from(word(random)) << 32 | u64::from(word(random));
    random.cr().modify(|_, w| w.rngen().clear_bit());
    drawn ^ since_power_on(DWT::cycle_count())
}

/// The next word; 0 where none comes.
fn word(random: &RNG) -> u32 {
    // With `DRDY` set and no error of clock or seed (RM0090, 24.3.1).
    let drawn = (0..LOOKS).any(|_| random.sr().read().bits() & 0b111 == 1);
    if drawn { random.dr().read().bits() } else { 0 }
}

fn since_power_on(cycles: u32) -> u64 {
    // SAFETY: every bit pattern is an `AtomicU32`, and the linker gave it memory of its own.
    let kept = unsafe { KEPT.assume_init_ref() };
    let stirred = kept.load(Ordering::Relaxed).wrapping_mul(0x9E37_79B1).wrapping_add(1);
    kept.store(stirred, Ordering::Relaxed);
    u64::from(stirred) << 32 | u64::from(cycles)
}
