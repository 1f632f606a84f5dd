//! Frames in and out.

use std::collections::VecDeque;

use shakedown_core::link::{Assembler, HostRequest, LinkError, MAX_FRAME, Report, encode};

/// Counts of what came over the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LinkCounters {
    /// Whole frames.
    pub frames: u64,
    /// Frames lost to a wrong check sum or length.
    pub garbled: u64,
    /// The version of a frame that was whole but not of this version.
    pub other_version: Option<u8>,
}

/// One end of a line: turns requests into bytes and bytes into reports.
#[derive(Debug, Default)]
pub struct LinkClient {
    assembler: Assembler,
    reports: VecDeque<Report>,
    outgoing: VecDeque<u8>,
    heard: LinkCounters,
}

impl LinkClient {
    /// A line on which nothing was said. The first byte out is a zero, which ends whatever the device heard before.
    pub fn new() -> Self {
        Self { outgoing: VecDeque::from([0]), ..Self::default() }
    }

    /// Takes bytes off the line.
    pub fn hear(&mut self, bytes: impl IntoIterator<Item = u8>) {
        for byte in bytes {
            match self.assembler.push::<Report>(byte) {
                Some(Ok(report)) => {
                    self.heard.frames += 1;
                    self.reports.push_back(report);
                }
                Some(Err(LinkError::Version { theirs })) => self.heard.other_version = Some(theirs),
                Some(Err(_)) => self.heard.garbled += 1,
                None => {}
            }
        }
    }

    /// The next report, in the order heard.
    pub fn report(&mut self) -> Option<Report> {
        self.reports.pop_front()
    }

    /// Puts a request on the line.
    pub fn say(&mut self, request: &HostRequest) {
        let mut frame = [0; MAX_FRAME];
        // Every request fits: the core's tests encode the fullest.
        let length = encode(request, &mut frame).unwrap_or(0);
        self.outgoing.extend(&frame[..length]);
    }

    /// Bytes for the line, which the caller takes.
    pub fn outgoing(&mut self) -> &mut VecDeque<u8> {
        &mut self.outgoing
    }

    /// What was heard so far.
    pub const fn heard(&self) -> LinkCounters {
        self.heard
    }
}
