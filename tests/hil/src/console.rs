//! The host's console and the program's end, by semihosting (Arm's "Semihosting for AArch32 and AArch64"), and what is kept over a
//! reset: how many tests failed, and how far the cycle counter came.

use core::fmt::Write as _;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU32, Ordering};

use heapless::String;

const WRITE0: u32 = 0x04;
const EXIT_EXTENDED: u32 = 0x20;
const ENDED: u32 = 0x2_0026;
/// Says that what is kept is ours.
const MARK: u32 = 0x5348_4B44;

/// The tests that end in a reset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fatal {
    /// The watchdog is not fed.
    Starved,
    /// The program panics.
    Panicked,
    /// The clock fails.
    Unclocked,
}

/// Mark, failures so far, cycles.
#[unsafe(link_section = ".uninit.kept")]
static KEPT: MaybeUninit<[AtomicU32; 3]> = MaybeUninit::uninit();

fn kept() -> &'static [AtomicU32; 3] {
    // SAFETY: every bit pattern is a number, and the linker gave it memory of its own.
    unsafe { KEPT.assume_init_ref() }
}

/// Tests that failed.
#[derive(Debug, Default)]
pub(crate) struct Report {
    failed: u32,
}

impl Report {
    /// Where a test has begun before the last reset that ends in one: which, the report so far, and the cycles from there to the reset
    /// as far as they were kept.
    pub(crate) fn resumed() -> Option<(Fatal, Self, u32)> {
        let [mark, failed, cycles] = kept();
        let fatal = match mark.swap(0, Ordering::Relaxed).wrapping_sub(MARK) {
            0 => Fatal::Starved,
            1 => Fatal::Panicked,
            2 => Fatal::Unclocked,
            _ => return None,
        };
        Some((fatal, Self { failed: failed.load(Ordering::Relaxed) }, cycles.load(Ordering::Relaxed)))
    }

    /// Keeps the report over the reset to come.
    pub(crate) fn keep(&self, fatal: Fatal) {
        let [mark, failed, _] = kept();
        failed.store(self.failed, Ordering::Relaxed);
        mark.store(MARK + fatal as u32, Ordering::Relaxed);
    }

    /// Keeps how far the cycle counter is.
    pub(crate) fn keep_cycles(cycles: u32) {
        kept()[2].store(cycles, Ordering::Relaxed);
    }

    /// A measurement with the bounds that it must keep.
    pub(crate) fn bounded(&mut self, what: &str, value: f32, unit: &str, from: f32, to: f32) {
        let holds = value >= from && value <= to;
        self.failed += u32::from(!holds);
        let mut line: String<160> = String::new();
        let word = if holds { "ok" } else { "FAILED" };
        let _ = writeln!(line, "test {what} ... {word}: {value:.3} {unit}, {from} to {to}");
        say(line);
    }

    /// Something that only a person can judge.
    pub(crate) fn noted(what: &str, value: u32) {
        let mut line: String<160> = String::new();
        let _ = writeln!(line, "note {what}: {value:#x}");
        say(line);
    }

    /// The end; its status is 1 where a test failed.
    pub(crate) fn end(&self) -> ! {
        let mut line: String<160> = String::new();
        let _ = writeln!(line, "test result: {} failed", self.failed);
        say(line);
        let words = [ENDED, u32::from(self.failed > 0)];
        loop {
            // SAFETY: the operation reads two words.
            unsafe { cortex_m::asm::semihosting_syscall(EXIT_EXTENDED, words.as_ptr() as u32) };
        }
    }
}

fn say(mut line: String<160>) {
    if line.push('\0').is_err() {
        line.clear();
        let _ = line.push_str("a line too long\n\0");
    }
    // SAFETY: the operation reads up to the zero that ends the line.
    unsafe { cortex_m::asm::semihosting_syscall(WRITE0, line.as_ptr() as u32) };
}
