//! The two settings slots: the last two pages of 2 KiB, in the second bank, which is erased while the program runs from the first.

use shakedown_firmware::OpenRelay;
use shakedown_firmware::parts;
use shakedown_firmware::store::{SLOT, Slots};
use stm32g4::stm32g474::FLASH;

use crate::{ticker, watchdog};

/// Pages of the second bank, and where they lie.
const PAGE: [u32; 2] = [126, 127];
const ADDRESS: [usize; 2] = [0x0807_F000, 0x0807_F800];
const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];
/// `FLASH_CR`: program; erase a page, of the second bank; start; locked. `FLASH_SR`: busy, and what can go wrong.
const PROGRAM: u32 = 1;
const ERASE: u32 = 1 << 1 | 1 << 11;
const START: u32 = 1 << 16;
const LOCKED: u32 = 1 << 31;
const BUSY: u32 = 1 << 16;
const ERRORS: u32 = 0xC3FA;
/// `FLASH_OPTR`: two banks.
const TWO_BANKS: u32 = 1 << 22;
/// `FLASH_ECCR`: two wrong bits were read, cleared by a one; in the second bank.
const TWO_WRONG: u32 = 1 << 31;
const SECOND_BANK: u32 = 1 << 21;
/// Looks at an erase of 25 ms at most, or at a program of a double word.
const LOOKS: u32 = 4_000_000;
/// Bytes that are programmed at once, and once between two erases.
const WORD: usize = 8;
/// Of a slot's first ones, which wait for the mark that comes last.
const MARK: usize = 4;

/// Why the flash refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, defmt::Format)]
pub enum Error {
    /// There is no such slot, or no such place in it.
    Place,
    /// The option bytes make one bank of two, whose pages are others.
    OneBank,
    /// It stayed busy.
    Busy,
    /// These flags of `FLASH_SR`.
    Failed(u32),
}

/// The flash.
pub struct Flash {
    registers: FLASH,
    /// What shares its double word with the mark.
    waiting: [u8; WORD - MARK],
}

impl Flash {
    /// The flash, locked.
    pub(crate) const fn new(registers: FLASH) -> Self {
        Self { registers, waiting: [0xFF; WORD - MARK] }
    }

    fn settled(&self) -> Result<(), Error> {
        if !(0..LOOKS).any(|_| self.registers.sr().read().bits() & BUSY == 0) {
            return Err(Error::Busy);
        }
        let failed = self.registers.sr().read().bits() & ERRORS;
        if failed == 0 { Ok(()) } else { Err(Error::Failed(failed)) }
    }

    /// Unlocks, has `work` done, locks.
    fn unlocked(&self, work: impl FnOnce(&Self) -> Result<(), Error>) -> Result<(), Error> {
        if self.registers.optr().read().bits() & TWO_BANKS == 0 {
            return Err(Error::OneBank);
        }
        for key in KEYS {
            self.registers.keyr().write(|w| unsafe { w.bits(key) });
        }
        // Flags of earlier are cleared by ones.
        self.registers.sr().write(|w| unsafe { w.bits(ERRORS) });
        let done = work(self);
        self.registers.cr().write(|w| unsafe { w.bits(LOCKED) });
        done
    }

    fn program_words(&self, address: usize, bytes: &[u8]) -> Result<(), Error> {
        self.registers.cr().write(|w| unsafe { w.bits(PROGRAM) });
        for (place, chunk) in bytes.chunks(WORD).enumerate() {
            let mut word = [0xFF; WORD];
            word.iter_mut().zip(chunk).for_each(|(to, from)| *to = *from);
            let [a, b, c, d, e, f, g, h] = word;
            let to = (address + place * WORD) as *mut u32;
            // SAFETY: inside a slot's page, which nothing else writes, in the order that the flash wants: low, then high half.
            unsafe {
                to.write_volatile(u32::from_le_bytes([a, b, c, d]));
                cortex_m::asm::isb();
                to.add(1).write_volatile(u32::from_le_bytes([e, f, g, h]));
            }
            self.settled()?;
        }
        Ok(())
    }
}

/// Whether what interrupts is a word of the settings with two wrong bits, as power that fails while it is programmed leaves one (RM0440,
/// error code correction): then the slot's check sum refuses what was read, and the program goes on. In the second bank there is nothing but settings.
pub(crate) fn was_a_torn_setting() -> bool {
    // SAFETY: the write clears one flag, and nobody else reads the register.
    let flash = unsafe { FLASH::steal() };
    let found = flash.eccr().read().bits();
    let torn = found & TWO_WRONG != 0 && found & SECOND_BANK != 0;
    if torn {
        flash.eccr().write(|w| unsafe { w.bits(TWO_WRONG) });
    }
    torn
}

impl parts::Flash for Flash {
    fn write<T>(&mut self, open: &OpenRelay, work: impl FnOnce(&mut Self) -> T) -> T {
        ticker::without_ticks(open, || watchdog::patiently(open, || work(self)))
    }
}

impl Slots for Flash {
    type Error = Error;

    fn read(&self, slot: usize, bytes: &mut [u8; SLOT]) {
        let Some(&from) = ADDRESS.get(slot) else { return };
        for (place, byte) in bytes.iter_mut().enumerate() {
            // SAFETY: inside a page of the flash, which is always there to be read.
            *byte = unsafe { ((from + place) as *const u8).read_volatile() };
        }
    }

    fn erase(&mut self, slot: usize) -> Result<(), Error> {
        let page = PAGE.get(slot).copied().ok_or(Error::Place)?;
        self.waiting = [0xFF; WORD - MARK];
        self.unlocked(|flash| {
            flash.settled()?;
            flash.registers.cr().write(|w| unsafe { w.bits(ERASE | page << 3) });
            flash.registers.cr().write(|w| unsafe { w.bits(ERASE | page << 3 | START) });
            flash.settled()
        })
    }

    /// The content first, from behind the mark on, then the mark: the double word that holds both waits for the mark.
    fn program(&mut self, slot: usize, offset: usize, bytes: &[u8]) -> Result<(), Error> {
        let address = ADDRESS.get(slot).copied().ok_or(Error::Place)?;
        match (offset, bytes.split_first_chunk::<MARK>()) {
            (MARK, Some((first, rest))) if MARK + bytes.len() <= SLOT => {
                self.waiting = *first;
                self.unlocked(|flash| flash.program_words(address + WORD, rest))
            }
            (0, Some((mark, []))) => {
                let [a, b, c, d] = *mark;
                let [e, f, g, h] = self.waiting;
                self.unlocked(|flash| flash.program_words(address, &[a, b, c, d, e, f, g, h]))
            }
            _ => Err(Error::Place),
        }
    }
}
