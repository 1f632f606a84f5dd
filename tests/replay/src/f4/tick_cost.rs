//! Instructions of a tick alone, whatever the processor does between two of them.

use rigless::emulator::{Access, AccessKind};

/// Flags of the converter's DMA, which a tick looks at first.
const DMA2_LISR: u64 = 0x4002_6400;
/// What a tick writes and nothing else does while the ticks go on: the output, the relay, the watchdog's key.
const LAST: [u64; 3] = [0x4000_7408, 0x4002_0418, 0x4000_3000];

/// The dearest tick so far.
#[derive(Debug, Default)]
pub(super) struct TickCost {
    begun: Option<u64>,
    most: u64,
}

impl TickCost {
    /// An access that has settled.
    pub(super) fn settled(&mut self, access: Access) {
        if access.kind == AccessKind::Read && access.address == DMA2_LISR {
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
