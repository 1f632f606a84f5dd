//! The two settings slots: sectors 10 and 11.

use shakedown_firmware::store::{SLOT, Slots};
use stm32f4xx_hal::flash::{Error, FlashExt, LockedFlash};

use super::{ticker, watchdog};

const SECTOR: [u8; 2] = [10, 11];
const OFFSET: [usize; 2] = [0x000C_0000, 0x000E_0000];

/// The flash.
pub(crate) struct Flash(pub(crate) LockedFlash);

impl Flash {
    /// Lets `work` write. The ticks stop meanwhile, for a second or two: only with the relay open.
    pub(crate) fn write<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        ticker::without_ticks(|| watchdog::patiently(|| work(self)))
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
        match SECTOR.get(slot) {
            Some(&sector) => self.0.unlocked().erase(sector),
            None => Err(Error::Operation),
        }
    }

    fn program(&mut self, slot: usize, offset: usize, bytes: &[u8]) -> Result<(), Error> {
        match OFFSET.get(slot) {
            Some(base) => self.0.unlocked().program(base + offset, bytes.iter()),
            None => Err(Error::Operation),
        }
    }
}
