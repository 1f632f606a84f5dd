//! The far end of the serial line.

use std::sync::{Arc, Mutex, PoisonError};

use rigless::chip::Timeline;
use rigless::chip::uart::Peer;
use rigless::snapshot::Store;
use rigless::time::VirtualNanos;

use crate::Line;

/// Bytes between the world and the port's model.
#[derive(Debug)]
pub(super) struct Wire(pub(super) Arc<Mutex<Line>>);

impl Store for Wire {}

impl Peer for Wire {
    fn receive(&mut self, word: u16, _: &mut Timeline<'_, '_>) {
        let mut line = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        line.from_device.push_back(word as u8);
    }

    fn transmit(&mut self, _: VirtualNanos) -> Option<u16> {
        let mut line = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        line.to_device.pop_front().map(u16::from)
    }
}
