//! A number that differs from reset to reset, for challenges.

use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU32, Ordering};

/// Memory that a reset leaves as it was, and power-on leaves to chance.
#[unsafe(link_section = ".uninit.entropy")]
static KEPT: MaybeUninit<AtomicU32> = MaybeUninit::uninit();

/// What chance left at power-on, stirred by every reset since; `cycles` adds what it can.
pub(crate) fn since_power_on(cycles: u32) -> u64 {
    // SAFETY: every bit pattern is an `AtomicU32`, and the linker gave it memory of its own.
    let kept = unsafe { KEPT.assume_init_ref() };
    let stirred = kept.load(Ordering::Relaxed).wrapping_mul(0x9E37_79B1).wrapping_add(1);
    kept.store(stirred, Ordering::Relaxed);
    u64::from(stirred) << 32 | u64::from(cycles)
}
