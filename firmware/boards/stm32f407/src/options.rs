//! The option bytes that this board relies on (RM0090, 3.9.10).

use shakedown_core::link::OptionPurpose::{BrownOut, ReadProtection, Watchdog, WriteProtection};
use shakedown_firmware::options::{Field, Options};

/// Fields of `FLASH_OPTCR`. The brown-out levels count down: 0 is level 3, which holds the chip in reset below 2.83 V, and the flash
/// is read at 168 MHz with five wait states from 2.7 V on; 3 is off. The settings slots are sectors 10 and 11, where a 1 is writable.
const FIELDS: [Field; 5] = [
    Field { purpose: BrownOut, name: "BOR_LEV", bits: (2, 2), wanted: 0 },
    Field { purpose: Watchdog, name: "WDG_SW", bits: (5, 1), wanted: 0 },
    Field { purpose: ReadProtection, name: "RDP", bits: (8, 8), wanted: 0xAA },
    Field { purpose: WriteProtection, name: "nWRP10", bits: (26, 1), wanted: 1 },
    Field { purpose: WriteProtection, name: "nWRP11", bits: (27, 1), wanted: 1 },
];

/// As the register says.
#[cfg(target_os = "none")]
pub fn read() -> Options {
    // SAFETY: the register is read only.
    of(unsafe { stm32f4xx_hal::pac::FLASH::steal() }.optcr().read().bits())
}

/// What `FLASH_OPTCR` says.
pub fn of(register: u32) -> Options {
    FIELDS.iter().map(|field| field.read(register)).collect()
}
