//! A device's setup in TOML: refused with a message, or taken; what is taken survives the device's flash and the link.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shakedown_core::link::{Assembler, HostRequest, MAX_FRAME, Setup, encode};
use shakedown_firmware::store::{InMemory, load, save};

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let setup = match toml::from_str::<Setup>(text) {
        Ok(setup) => setup,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    if let Err(error) = setup.validate() {
        return assert!(!error.to_string().is_empty());
    }
    let mut flash = InMemory::erased();
    save(&mut flash, &setup).expect("a setup that holds is saved");
    assert_eq!(load(&flash).map(|found| found.setup), Some(setup));
    let (mut wire, mut device) = ([0; MAX_FRAME], Assembler::new());
    let length = encode(&HostRequest::WriteSetup(setup), &mut wire).expect("and fits a frame");
    let heard = wire[..length].iter().find_map(|&byte| device.push::<HostRequest>(byte));
    assert!(matches!(heard, Some(Ok(HostRequest::WriteSetup(heard))) if heard == setup), "{setup:?}");
});
