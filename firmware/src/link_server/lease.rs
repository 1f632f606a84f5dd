//! The lease: a host that says nothing for longer than [`Setup::lease_ms`](shakedown_core::link::Setup) has a test no more.

use shakedown_core::State;

use super::{LinkServer, LoopStatus};
use crate::queues::LoopCommand;

/// Ticks in units of 16, modulo 2^16: two bytes that count 131 s at 8 kHz, twice the longest lease, across the end of the ticks' own count.
pub(super) const fn in_sixteens(ticks: u32) -> u16 {
    (ticks / 16) as u16
}

impl LinkServer<'_> {
    /// Tells the loop of a host that is silent while the device is armed: a test is faded out, and after as long again the device is disarmed.
    pub(super) fn keep_lease(&mut self, seen: LoopStatus) {
        let lease = u32::from(self.setup.lease_ms);
        let armed = matches!(seen.standing.state, State::Ready | State::Running | State::Hold);
        let now = in_sixteens(seen.ticks);
        let silent = self.milliseconds(16 * u32::from(now.wrapping_sub(self.heard)));
        if armed && lease > 0 && silent > lease && self.queues.orders.enqueue(LoopCommand::HostSilent).is_ok() {
            self.heard = now;
        }
    }
}
