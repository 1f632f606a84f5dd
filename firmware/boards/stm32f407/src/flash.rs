//! The two settings slots: sectors 10 and 11.

use shakedown_firmware::OpenRelay;
use shakedown_firmware::parts;
use shakedown_firmware::store::{SLOT, Slots};
use stm32f4xx_hal::flash::{Error, FlashExt, LockedFlash};
use stm32f4xx_hal::pac;

use crate::{ticker, watchdog};

const SECTOR: [u8; 2] = [10, 11];
const OFFSET: [usize; 2] = [0x000C_0000, 0x000E_0000];

/// Cycles between two looks at an erase that takes a second.
const WAIT: u32 = 10_000;

/// The flash.
pub struct Flash(pub(crate) LockedFlash);

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
        let Some(&sector) = SECTOR.get(slot) else { return Err(Error::Operation) };
        let _unlocked = self.0.unlocked();
        // SAFETY: this owns the flash, and while it is unlocked nobody else reads or writes its registers.
        let flash = unsafe { &*pac::FLASH::ptr() };
        // Word by word, which the board's 3.3 V allow, takes half the time of the driver's byte by byte (RM0090, 3.6.2).
        // SAFETY: a sector that the part has.
        flash.cr().modify(|_, w| unsafe { w.psize().psize32().snb().bits(sector).ser().set_bit() });
        flash.cr().modify(|_, w| w.strt().set_bit());
        while flash.sr().read().bsy().bit() {
            cortex_m::asm::delay(WAIT);
        }
        flash.cr().modify(|_, w| w.ser().clear_bit());
        if flash.sr().read().wrperr().bit() { Err(Error::WriteProtection) } else { Ok(()) }
    }

    fn program(&mut self, slot: usize, offset: usize, bytes: &[u8]) -> Result<(), Error> {
        match OFFSET.get(slot) {
            Some(base) => self.0.unlocked().program(base + offset, bytes.iter()),
            None => Err(Error::Operation),
        }
    }
}
