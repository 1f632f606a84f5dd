//! The end of a program that has failed: the relay opens, the output goes to what stops the oil, and the watchdog
//! resets the processor within 50 ms. The reset is told apart from others, and the device starts tripped.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m_rt::{ExceptionFrame, exception};

use super::{converters, pins};

static SAFE_CODE: AtomicU32 = AtomicU32::new(2048);

/// Remembers the output code that would stop the oil now.
#[inline]
pub(crate) fn remember(code: u16) {
    SAFE_CODE.store(u32::from(code), Ordering::Relaxed);
}

/// The end.
pub(crate) fn park() -> ! {
    cortex_m::interrupt::disable();
    pins::open_relay();
    converters::write_last(SAFE_CODE.load(Ordering::Relaxed) as u16);
    loop {
        cortex_m::asm::nop();
    }
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    defmt::error!("panic: {}", defmt::Display2Format(info));
    park()
}

// SAFETY: nothing is read of the state that failed.
#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    park()
}
