//! The end of a program that has failed: the relay opens, the output goes to what stops the oil, and the watchdog
//! resets the processor within 50 ms. The reset is told apart from others, and the device starts tripped.

use core::cell::Cell;

use cortex_m::interrupt::{self, Mutex};
use cortex_m_rt::{ExceptionFrame, exception};
use shakedown_firmware::{defaults, output::ZeroFlow};

use super::{converters, pins};

/// How the output is wired.
static ZERO_FLOW: Mutex<Cell<Option<ZeroFlow>>> = Mutex::new(Cell::new(None));

/// Remembers how the output is wired.
pub(crate) fn prepare(zero_flow: ZeroFlow) {
    interrupt::free(|free| ZERO_FLOW.borrow(free).set(Some(zero_flow)));
}

/// The end.
pub(crate) fn park() -> ! {
    interrupt::disable();
    pins::open_relay();
    let zero_flow = interrupt::free(|free| ZERO_FLOW.borrow(free).get());
    let zero_flow = zero_flow.unwrap_or_else(|| ZeroFlow::new(&defaults::setup()));
    converters::write_last(zero_flow.code(converters::last_displacement()));
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
