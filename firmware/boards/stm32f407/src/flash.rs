//! The two settings slots: sectors 10 and 11.

use shakedown_firmware::OpenRelay;
use shakedown_firmware::parts;
use shakedown_firmware::store::{SLOT, Slots};
use stm32f4xx_hal::flash::{FlashExt, LockedFlash};
use stm32f4xx_hal::pac::{self, flash::RegisterBlock};

use crate::{ticker, watchdog};

const SECTOR: [u8; 2] = [10, 11];
const OFFSET: [usize; 2] = [0x000C_0000, 0x000E_0000];

/// Cycles between two looks at an erase that takes a second.
const WAIT: u32 = 10_000;

/// `FLASH_SR`: what can go wrong. Such a flag stays until a one is written to it (RM0090, 3.9.5), and makes whatever comes next look
/// failed too.
const ERRORS: u32 = 0b1111_0010;

/// Why the flash refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, defmt::Format)]
pub enum Error {
    /// There is no such slot.
    Place,
    /// These flags of `FLASH_SR`.
    Failed(u32),
}

/// The flash.
pub struct Flash(pub(crate) LockedFlash);

/// What went wrong since the flags were cleared.
fn failed(flash: &RegisterBlock) -> Result<(), Error> {
    let flags = flash.sr().read().bits() & ERRORS;
    if flags == 0 { Ok(()) } else { Err(Error::Failed(flags)) }
}

/// Forgets what was read before an erase, which the cache of the data keeps (RM0090, 3.6.3). It takes that only while it is off.
fn forget(flash: &RegisterBlock) {
    flash.acr().modify(|_, w| w.dcen().clear_bit());
    flash.acr().modify(|_, w| w.dcrst().set_bit());
    flash.acr().modify(|_, w| w.dcrst().clear_bit());
    flash.acr().modify(|_, w| w.dcen().set_bit());
}

impl parts::Flash for Flash {
    fn write<T>(&mut self, open: &OpenRelay, work: impl FnOnce(&mut Self) -> T) -> T {
        ticker::without_ticks(open, || watchdog::patiently(open, || work(self)))
    }
}

impl Slots for Flash {
    type Error = Error;

    fn read(&self, slot: usize, bytes: &mut [u8; SLOT]) {
        let from = OFFSET.get(slot).and_then(|&offset| self.0.read().get(offset..offset + SLOT));
        if let Some(from) = from {
            bytes.copy_from_slice(from);
        }
    }

    fn erase(&mut self, slot: usize) -> Result<(), Error> {
        let Some(&sector) = SECTOR.get(slot) else { return Err(Error::Place) };
        let _unlocked = self.0.unlocked();
        // SAFETY: this owns the flash, and while it is unlocked nobody else reads or writes its registers.
        let flash = unsafe { &*pac::FLASH::ptr() };
        // SAFETY: ones clear the flags that are set, whatever else they are.
        flash.sr().write(|w| unsafe { w.bits(ERRORS) });
        // Word by word, which the board's 3.3 V allow, takes half the time of the driver's byte by byte (RM0090, 3.6.2).
        // SAFETY: a sector that the part has.
        flash.cr().modify(|_, w| unsafe { w.psize().psize32().snb().bits(sector).ser().set_bit().pg().clear_bit() });
        flash.cr().modify(|_, w| w.strt().set_bit());
        while flash.sr().read().bsy().bit() {
            cortex_m::asm::delay(WAIT);
        }
        flash.cr().modify(|_, w| w.ser().clear_bit());
        forget(flash);
        failed(flash)
    }

    fn program(&mut self, slot: usize, offset: usize, bytes: &[u8]) -> Result<(), Error> {
        match OFFSET.get(slot) {
            // SAFETY: the driver has done with the registers.
            Some(base) => self
                .0
                .unlocked()
                .program(base + offset, bytes.iter())
                .or_else(|_| failed(unsafe { &*pac::FLASH::ptr() })),
            None => Err(Error::Place),
        }
    }
}
