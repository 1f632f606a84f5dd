//! What ends a program of this chip: a panic, a fault, a clock that stops. The relay opens before anything that needs a stack, which
//! after a fault may be what is gone; the rest of the end is any board's.

use cortex_m_rt::exception;
use shakedown_firmware::failure;

use crate::{flash, pins};

/// The end, without a word.
pub fn park() -> ! {
    failure::end(pins::open_relay, || {})
}

#[panic_handler]
fn panic(_info: &core::panic::PanicInfo<'_>) -> ! {
    failure::end(pins::open_relay, || defmt::error!("panic"))
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
    failure::end(pins::open_relay, || defmt::error!("fault"))
}

/// Power failed while settings were programmed, and what it left of them is read at the start: that is no failure. Or the crystal has stopped:
/// the processor runs at 16 MHz from here on, a tenth of what a tick needs (RM0440, clock security system).
#[exception]
unsafe fn NonMaskableInt() {
    if flash::was_a_torn_setting() {
        return;
    }
    failure::end(pins::open_relay, || defmt::error!("clock failed"))
}
