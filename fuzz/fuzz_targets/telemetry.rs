//! What a host makes of a device's reports: frames whose check sums are right and whose content is anything. Telemetry is
//! put together with its gaps named and written as a recording that the reader takes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use serde::ser::{Serialize, SerializeTuple as _, Serializer};
use shakedown::blocks::device::{LinkClient, Sheet, Telemetry};
use shakedown_core::link::{MAX_FRAME, Report, encode};
use shakedown_firmware::defaults;

/// Bytes that stand in a frame as they are.
struct Content<'a>(&'a [u8]);

impl Serialize for Content<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|byte| tuple.serialize_element(byte))?;
        tuple.end()
    }
}

fuzz_target!(|bytes: &[u8]| {
    let (mut talker, mut telemetry) = (LinkClient::new(), Telemetry::default());
    let mut rest = bytes;
    while let Some((&length, after)) = rest.split_first() {
        let (content, after) = after.split_at(usize::from(length).min(after.len()));
        rest = after;
        let mut wire = [0; MAX_FRAME];
        let written = encode(&Content(content), &mut wire).expect("a frame of 255 bytes fits");
        talker.hear(wire[..written].iter().copied());
    }
    while let Some(report) = talker.report() {
        if let Report::Telemetry(batch) = report {
            telemetry.take(&batch);
        }
    }
    let mut sheet = Sheet::begin(Vec::new(), &defaults::setup()).expect("memory takes what is written");
    for row in telemetry.rows() {
        sheet.write(row).expect("memory takes what is written");
    }
    let text = sheet.end().expect("memory takes what is written");
    // A device decides how far apart its ticks are, and not how much is written for it.
    assert!(text.len() < 400 + 400 * 10_001 * telemetry.rows().len());
});
