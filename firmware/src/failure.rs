//! The end of a program that has failed, on any board: the relay opens, the output goes to what stops the oil, then the failure is
//! logged, and the watchdog resets the processor. The reset is told apart from others, and the device starts tripped.
//!
//! Interrupts end first, for a tick would close the relay again. The relay comes next, whatever failed: before any log, which may be
//! what failed. How it is opened is the board's to say, and so is which interrupts end here.

use core::cell::Cell;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::interrupt::{self, Mutex};

use crate::output::ZeroFlow;

/// What puts on the output the code at which no oil flows.
type PutLast = fn(ZeroFlow);

/// How the output is wired, and how it is written. Before that is known the output drives nothing.
static LAST: Mutex<Cell<Option<(ZeroFlow, PutLast)>>> = Mutex::new(Cell::new(None));
/// A failure has begun to be logged: one in the log itself is not.
static LOGGED: AtomicBool = AtomicBool::new(false);

/// Remembers how the output is wired, and how it is written.
pub fn prepare(zero_flow: ZeroFlow, put_last: PutLast) {
    interrupt::free(|free| LAST.borrow(free).set(Some((zero_flow, put_last))));
}

/// The end: stops the ticks, opens the relay, puts on the output what stops the oil, and logs.
pub fn end(open_relay: fn(), log: impl FnOnce()) -> ! {
    // A tick between the two would close the relay again.
    interrupt::disable();
    open_relay();
    if let Some((zero_flow, put_last)) = interrupt::free(|free| LAST.borrow(free).get()) {
        put_last(zero_flow);
    }
    if !LOGGED.load(Ordering::Relaxed) {
        LOGGED.store(true, Ordering::Relaxed);
        log();
    }
    // For the watchdog.
    loop {
        cortex_m::asm::nop();
    }
}
