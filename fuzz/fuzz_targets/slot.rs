//! The two slots of the settings in flash: any content is no setup or a whole one that holds, and what is saved over it is
//! what is loaded next. An odd first byte puts marks and check sums right, so that the content behind them is reached.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shakedown_core::link::checksum;
use shakedown_firmware::store::{InMemory, SLOT, load, save};

/// Mark, length and check sum as a whole write would have left them around `length` bytes of content.
fn seal(slot: &mut [u8; SLOT], length: usize) {
    let length = length.min(SLOT - 16);
    let sequence = u32::from_le_bytes([slot[8], slot[9], slot[10], slot[11]]);
    let check = checksum(&slot[12..12 + length]) ^ sequence;
    slot[..4].copy_from_slice(b"shkd");
    slot[4..8].copy_from_slice(&(length as u32).to_le_bytes());
    slot[12 + length..16 + length].copy_from_slice(&check.to_le_bytes());
}

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, content)) = bytes.split_first() else { return };
    let mut flash = InMemory::erased();
    let half = content.len().div_ceil(2).min(SLOT);
    for (slot, part) in flash.0.iter_mut().zip(content.chunks(half.max(1))) {
        slot[..part.len()].copy_from_slice(part);
        if choice & 1 != 0 {
            seal(slot, part.len().saturating_sub(12));
        }
    }
    let Some(found) = load(&flash) else { return };
    assert!(found.setup.validate().is_ok());
    save(&mut flash, &found.setup).expect("a setup that was loaded can be saved");
    assert_eq!(load(&flash).map(|again| again.setup), Some(found.setup));
});
