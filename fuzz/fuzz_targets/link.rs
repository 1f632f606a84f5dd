//! The serial link: any bytes leave both ends in step, and a frame that is read writes back to the same frame.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shakedown_core::link::{Assembler, HostRequest, MAX_FRAME, Report, encode};

fuzz_target!(|bytes: &[u8]| {
    let (mut device, mut host) = (Assembler::new(), Assembler::new());
    for &byte in bytes {
        if let Some(Ok(request)) = device.push::<HostRequest>(byte) {
            let mut buffer = [0; MAX_FRAME];
            let length = encode(&request, &mut buffer).expect("what was read can be written");
            let mut again = Assembler::new();
            let read = buffer[..length].iter().find_map(|&byte| again.push::<HostRequest>(byte));
            assert_eq!(format!("{read:?}"), format!("{:?}", Some(Ok::<_, ()>(request))));
        }
        let _ = host.push::<Report>(byte);
    }
});
