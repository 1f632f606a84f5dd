//! The option bytes that this board relies on (RM0440, 5.7.8, 5.7.14 and 5.7.15).

use shakedown_core::link::OptionPurpose::{Banks, BrownOut, ReadProtection, Watchdog, WriteProtection};
use shakedown_firmware::options::{Field, Options, option};

/// Fields of `FLASH_OPTR`. Brown-out level 3 holds the chip in reset below 2.5 V: it runs from 1.71 V on, and the supply's monitor
/// trips at 2.8 V, so that the safe ramp has its time.
const FIELDS: [Field; 4] = [
    Field { purpose: BrownOut, name: "BOR_LEV", bits: (8, 3), wanted: 3 },
    Field { purpose: Watchdog, name: "IWDG_SW", bits: (16, 1), wanted: 0 },
    Field { purpose: ReadProtection, name: "RDP", bits: (0, 8), wanted: 0xAA },
    Field { purpose: Banks, name: "DBANK", bits: (22, 1), wanted: 1 },
];
/// The end of each protected area of the second bank.
const ENDS: [&str; 2] = ["WRP2A_END", "WRP2B_END"];
/// Where they lie in the flash's registers, byte.
#[cfg(target_os = "none")]
const AREAS: [usize; 2] = [0x4C, 0x50];
/// The settings slots are this page and the one behind it.
const SLOTS: u32 = 126;
const PAGE: u32 = 0x7F;

/// As the registers say.
#[cfg(target_os = "none")]
pub fn read() -> Options {
    let flash = stm32g4::stm32g474::FLASH::ptr();
    // SAFETY: the registers are read only, and the areas lie where the manual says; the register names have none for them.
    let (register, areas) =
        unsafe { ((*flash).optr().read().bits(), AREAS.map(|at| flash.cast::<u32>().add(at / 4).read_volatile())) };
    of(register, areas)
}

/// What `FLASH_OPTR` and the protected areas of the second bank say. An area goes from its start, bits 0 to 6, to its end, bits 16 to
/// 22; one that ends before it starts is none.
pub fn of(register: u32, areas: [u32; 2]) -> Options {
    let protected = areas.iter().zip(ENDS).map(|(area, name)| {
        let (start, end) = (area & PAGE, area >> 16 & PAGE);
        let covers = start <= end && end >= SLOTS;
        option(WriteProtection, name, end, if covers { SLOTS - 1 } else { end })
    });
    FIELDS.iter().map(|field| field.read(register)).chain(protected).collect()
}
