//! Instructions of a tick alone, whatever the processor does between two of them.

use rigless::emulator::{Access, AccessKind};

/// What a tick reads first: flags of the converter's DMA, or with outboard converters of the timer.
const FIRST: [u64; 2] = [0x4002_6400, 0x4000_0010];
/// What a tick writes and nothing else does while the ticks go on: the output, on the chip or outboard, the relay, the watchdog's key.
const LAST: [u64; 4] = [0x4000_7408, 0x4000_380C, 0x4002_0418, 0x4000_3000];

/// The dearest tick so far.
#[derive(Debug, Default)]
pub(super) struct TickCost {
    begun: Option<u64>,
    most: u64,
}

impl TickCost {
    /// An access that has settled.
    pub(super) fn settled(&mut self, access: Access) {
        if access.kind == AccessKind::Read && FIRST.contains(&access.address) {
            self.begun = Some(access.instruction_count);
        } else if access.kind == AccessKind::Write && LAST.contains(&access.address) {
            let spent = self.begun.map_or(0, |begun| access.instruction_count - begun);
            self.most = self.most.max(spent);
        }
    }

    /// Instructions of the dearest.
    pub(super) const fn most(&self) -> u64 {
        self.most
    }
}
