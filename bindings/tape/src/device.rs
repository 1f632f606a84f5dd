//! Plays the file `tape` into the file `answers`, by semihosting (Arm's "Semihosting for AArch32 and AArch64", 2.0).
#![allow(
    unsafe_code,
    reason = "the one instruction by which a program asks its debugger, and the stack at another place"
)]

use shakedown_core::host::Player;
use shakedown_tape::LONGEST;

const OPEN: u32 = 0x01;
const WRITE: u32 = 0x05;
const READ: u32 = 0x06;
const EXIT: u32 = 0x18;
/// Modes of `fopen`: "rb" and "wb".
const READING: u32 = 1;
const WRITING: u32 = 5;
/// Reasons of an exit.
const ENDED: u32 = 0x2_0026;
const FAILED: u32 = 0x2_0023;
/// The end of the memory, where there is more room for a stack than the image's memory map gives.
const TOP: u32 = 0x2002_0000;
/// Answers that are written at once, byte.
const BLOCK: usize = 4096;

struct File(u32);

fn ask(what: u32, words: &[u32]) -> u32 {
    // SAFETY: every call here passes as many words as its number asks for, and addresses that outlive it.
    unsafe { cortex_m::asm::semihosting_syscall(what, words.as_ptr() as u32) }
}

impl File {
    fn open(name: &core::ffi::CStr, mode: u32) -> Option<Self> {
        let handle = ask(OPEN, &[name.as_ptr() as u32, mode, name.count_bytes() as u32]);
        (handle != u32::MAX).then_some(Self(handle))
    }

    /// Fills `bytes`; none at the end of the file.
    fn read(&self, bytes: &mut [u8]) -> Option<()> {
        let mut rest = bytes;
        while !rest.is_empty() {
            let left = ask(READ, &[self.0, rest.as_mut_ptr() as u32, rest.len() as u32]) as usize;
            let read = rest.len().checked_sub(left).filter(|&read| read > 0)?;
            rest = rest.get_mut(read..)?;
        }
        Some(())
    }

    fn write(&self, bytes: &[u8]) -> Option<()> {
        (ask(WRITE, &[self.0, bytes.as_ptr() as u32, bytes.len() as u32]) == 0).then_some(())
    }
}

fn exit(well: bool) -> ! {
    // SAFETY: no memory is passed.
    unsafe { cortex_m::asm::semihosting_syscall(EXIT, if well { ENDED } else { FAILED }) };
    loop {
        cortex_m::asm::nop();
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    exit(false)
}

#[cortex_m_rt::entry]
fn main() -> ! {
    // SAFETY: nothing is on the stack that is needed again.
    unsafe { cortex_m::asm::bootstrap(TOP as *const u32, whole as *const u32) }
}

extern "C" fn whole() -> ! {
    exit(play().is_some())
}

/// None: a file is missing, or the tape is damaged.
fn play() -> Option<()> {
    let (tape, answers) = (File::open(c"tape", READING)?, File::open(c"answers", WRITING)?);
    let mut player = Player::new();
    let (mut content, mut block, mut filled) = ([0; LONGEST], [0; BLOCK], 0);
    let mut head = [0; 8];
    while tape.read(&mut head).is_some() {
        let [a, b, c, d, e, f, g, h] = head;
        let content = content.get_mut(..u32::from_le_bytes([e, f, g, h]) as usize)?;
        tape.read(content)?;
        let answer = player.play(u32::from_le_bytes([a, b, c, d]), content).ok()?;
        for word in answer {
            block.get_mut(filled..filled + 4)?.copy_from_slice(&word.to_le_bytes());
            filled += 4;
        }
        if filled == BLOCK {
            answers.write(&block)?;
            filled = 0;
        }
    }
    answers.write(block.get(..filled)?)
}
