//! A number that differs from reset to reset, for challenges.

use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::{DCB, DWT};
use stm32g4::stm32g474::RNG;

/// Looks at a generator that takes some hundred of the processor's cycles for a word, and longer for its first.
const LOOKS: u32 = 10_000;
/// `RNG_CR`: on. `RNG_SR`: a word is ready, no error of clock or seed.
const ON: u32 = 1 << 2;
const STATUS: u32 = 0b111;
const READY: u32 = 1;

/// Memory that a reset leaves as it was, and power-on leaves to chance.
#[unsafe(link_section = ".uninit.entropy")]
static KEPT: MaybeUninit<AtomicU32> = MaybeUninit::uninit();

/// The chip's random numbers, stirred into what chance left at power-on, every reset since and the cycles that the start took:
/// a generator that fails leaves the rest.
pub fn gather(random: &RNG, dcb: &mut DCB, dwt: &mut DWT) -> u64 {
    dcb.enable_trace();
    dwt.enable_cycle_counter();
    random.cr().write(|w| unsafe { w.bits(ON) });
    let drawn = u64::from(word(random)) << 32 | u64::from(word(random));
    random.cr().write(|w| unsafe { w.bits(0) });
    drawn ^ since_power_on(DWT::cycle_count())
}

/// The next word; 0 where none comes.
fn word(random: &RNG) -> u32 {
    let drawn = (0..LOOKS).any(|_| random.sr().read().bits() & STATUS == READY);
    if drawn { random.dr().read().bits() } else { 0 }
}

fn since_power_on(cycles: u32) -> u64 {
    // SAFETY: every bit pattern is an `AtomicU32`, and the linker gave it memory of its own.
    let kept = unsafe { KEPT.assume_init_ref() };
    let stirred = kept.load(Ordering::Relaxed).wrapping_mul(0x9E37_79B1).wrapping_add(1);
    kept.store(stirred, Ordering::Relaxed);
    u64::from(stirred) << 32 | u64::from(cycles)
}
