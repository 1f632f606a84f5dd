//! The lease: a host that says nothing for longer than [`Setup::lease_ms`](shakedown_core::link::Setup) has a test no more.

use shakedown_core::State;

use super::{LinkServer, LoopStatus};
use crate::queues::LoopCommand;

impl LinkServer<'_> {
    /// Tells the loop of a host that is silent while the device is armed: a test is faded out, and after as long again the device is disarmed.
    pub(super) fn keep_lease(&mut self, seen: LoopStatus) {
        let now = self.milliseconds(seen.ticks);
        let armed = matches!(seen.standing.state, State::Ready | State::Running | State::Hold);
        // The count of ticks begins anew after 2^32 of them.
        if !armed || now < self.heard || self.setup.lease_ms == 0 {
            self.heard = now.min(self.heard);
        } else if now - self.heard > u32::from(self.setup.lease_ms)
            && self.queues.orders.enqueue(LoopCommand::HostSilent).is_ok()
        {
            self.heard = now;
        }
    }
}
