//! The end of a program that has failed: the relay opens, the output goes to what stops the oil, and the watchdog
//! resets the processor within 50 ms. The reset is told apart from others, and the device starts tripped.

use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::interrupt::{self, Mutex};
use cortex_m_rt::{ExceptionFrame, exception};
use shakedown_core::link::Setup;
use shakedown_firmware::{defaults, output};

use super::{converters, pins};

/// Where the table was in the last tick, m, as bits.
static DISPLACEMENT: AtomicU32 = AtomicU32::new(0);
/// How the output is wired.
static SETUP: Mutex<Cell<Option<Setup>>> = Mutex::new(Cell::new(None));

/// Remembers where the table is, m.
#[inline]
pub(crate) fn remember(displacement: f32) {
    DISPLACEMENT.store(displacement.to_bits(), Ordering::Relaxed);
}

/// Remembers how the output is wired.
pub(crate) fn prepare(setup: &Setup) {
    interrupt::free(|free| SETUP.borrow(free).set(Some(*setup)));
}

/// The end.
pub(crate) fn park() -> ! {
    interrupt::disable();
    pins::open_relay();
    let setup = interrupt::free(|free| SETUP.borrow(free).get()).unwrap_or_else(defaults::setup);
    let displacement = f32::from_bits(DISPLACEMENT.load(Ordering::Relaxed));
    converters::write_last(output::zero_flow(&setup, displacement));
    loop {
        cortex_m::asm::nop();
    }
}

#[panic_handler]
fn panic(_info: &core::panic::PanicInfo<'_>) -> ! {
    defmt::error!("panic");
    park()
}

// SAFETY: nothing is read of the state that failed.
#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    park()
}
