//! Instructions of a tick alone, whatever the processor does between two of them.

use rigless::emulator::{Access, AccessKind};

/// What a tick reads first: flags of the converter's DMA, or with outboard converters of the timer.
const FIRST: [u64; 2] = [0x4002_6400, 0x4000_0010];
/// What a tick writes and nothing else does while the ticks go on: the output, on the chip or outboard, the relay, the watchdog's key.
const LAST: [u64; 4] = [0x4000_7408, 0x4000_380C, 0x4002_0418, 0x4000_3000];

/// The dearest tick so far, and the dearest that began with the relay closed.
#[derive(Debug, Default)]
pub(super) struct TickCost {
    /// Instructions until it began, and whether the relay was closed then.
    begun: Option<(u64, bool)>,
    most: u64,
    most_closed: u64,
}

impl TickCost {
    /// An access that has settled, with the relay closed or not.
    pub(super) fn settled(&mut self, access: Access, closed: bool) {
        if access.kind == AccessKind::Read && FIRST.contains(&access.address) {
            self.begun = Some((access.instruction_count, closed));
        } else if access.kind == AccessKind::Write && LAST.contains(&access.address) {
            let (begun, closed) = self.begun.unwrap_or((access.instruction_count, false));
            let spent = access.instruction_count - begun;
            self.most = self.most.max(spent);
            self.most_closed = self.most_closed.max(if closed { spent } else { 0 });
        }
    }

    /// Instructions of the dearest, and of the dearest with the relay closed.
    pub(super) const fn most(&self) -> (u64, u64) {
        (self.most, self.most_closed)
    }
}
