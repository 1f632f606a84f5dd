//! Files of the host, by semihosting (Arm's "Semihosting for AArch32 and AArch64", 2.0).
#![allow(unsafe_code, reason = "the one instruction by which a program asks its debugger")]

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

/// One end of a pipe.
pub(crate) struct Pipe(u32);

fn ask(what: u32, words: &[u32]) -> u32 {
    // SAFETY: every call here passes as many words as its number asks for, and addresses that outlive it.
    unsafe { cortex_m::asm::semihosting_syscall(what, words.as_ptr() as u32) }
}

impl Pipe {
    /// Opens the file of this name to read.
    pub(crate) fn reading(name: &str) -> Option<Self> {
        Self::open(name, READING)
    }

    /// Opens it to write.
    pub(crate) fn writing(name: &str) -> Option<Self> {
        Self::open(name, WRITING)
    }

    fn open(name: &str, mode: u32) -> Option<Self> {
        let mut ended = [0u8; 16];
        ended.get_mut(..name.len())?.copy_from_slice(name.as_bytes());
        let handle = ask(OPEN, &[ended.as_ptr() as u32, mode, name.len() as u32]);
        (handle != u32::MAX).then_some(Self(handle))
    }

    /// Fills `bytes`; none at the end of the file.
    pub(crate) fn read(&self, bytes: &mut [u8]) -> Option<()> {
        let mut rest = bytes;
        while !rest.is_empty() {
            let left = ask(READ, &[self.0, rest.as_mut_ptr() as u32, rest.len() as u32]) as usize;
            let read = rest.len().checked_sub(left).filter(|&read| read > 0)?;
            rest = rest.get_mut(read..)?;
        }
        Some(())
    }

    /// Writes all of `bytes`.
    pub(crate) fn write(&self, bytes: &[u8]) -> Option<()> {
        (ask(WRITE, &[self.0, bytes.as_ptr() as u32, bytes.len() as u32]) == 0).then_some(())
    }
}

/// The end of the program, and of the emulator.
pub(crate) fn exit(well: bool) -> ! {
    // SAFETY: no memory is passed.
    unsafe { cortex_m::asm::semihosting_syscall(EXIT, if well { ENDED } else { FAILED }) };
    loop {
        cortex_m::asm::nop();
    }
}
