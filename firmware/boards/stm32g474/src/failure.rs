//! The end of a program that has failed: the relay opens, the output goes to what stops the oil, then the failure is logged, and
//! the watchdog resets the processor within 105 ms. The reset is told apart from others, and the device starts tripped.
//!
//! The relay comes first, whatever failed: before any log, which may be what failed, and after a fault before anything that needs
//! a stack, which may be what is gone.

use core::cell::Cell;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::interrupt::{self, Mutex};
use cortex_m_rt::exception;
use shakedown_firmware::output::ZeroFlow;

use crate::{converters::OnChip, pins};

/// How the output is wired. Before that is known the output drives nothing.
static LAST: Mutex<Cell<Option<ZeroFlow>>> = Mutex::new(Cell::new(None));
/// A failure has begun to be logged: one in the log itself is not.
static LOGGED: AtomicBool = AtomicBool::new(false);

/// Remembers how the output is wired.
pub fn prepare(zero_flow: ZeroFlow) {
    interrupt::free(|free| LAST.borrow(free).set(Some(zero_flow)));
}

/// The end, without a word.
pub fn park() -> ! {
    secure();
    wait()
}

/// Opens the relay and puts on the output what stops the oil.
fn secure() {
    pins::open_relay();
    interrupt::disable();
    if let Some(zero_flow) = interrupt::free(|free| LAST.borrow(free).get()) {
        OnChip::put_last(zero_flow);
    }
}

fn end(log: impl FnOnce()) -> ! {
    secure();
    if !LOGGED.load(Ordering::Relaxed) {
        LOGGED.store(true, Ordering::Relaxed);
        log();
    }
    wait()
}

/// For the watchdog.
fn wait() -> ! {
    loop {
        cortex_m::asm::nop();
    }
}

#[panic_handler]
fn panic(_info: &core::panic::PanicInfo<'_>) -> ! {
    end(|| defmt::error!("panic"))
}

/// Every fault comes here, a stack that ran off the end of the memory among them. In registers alone: the relay opens by one store
/// to the set/reset register of port B, and then the stack begins anew, for what was on it is over.
#[unsafe(naked)]
#[unsafe(export_name = "HardFault")]
#[unsafe(link_section = ".HardFault.user")]
unsafe extern "C" fn hard_fault() -> ! {
    core::arch::naked_asm!(
        "movw r0, #0x0418",
        "movt r0, #0x4800",
        "mov.w r1, #0x10000",
        "str r1, [r0]",
        "ldr r0, =_stack_start",
        "msr msp, r0",
        "b {rest}",
        rest = sym after_fault,
    )
}

extern "C" fn after_fault() -> ! {
    end(|| defmt::error!("fault"))
}

/// The crystal has stopped: the processor runs at 16 MHz from here on, a tenth of what a tick needs (RM0440, clock security system).
#[exception]
unsafe fn NonMaskableInt() -> ! {
    end(|| defmt::error!("clock failed"))
}
