//! How deep the stack has been, which the firmware paints at reset.

use rigless::emulator::Host;
use rigless::soc::Width;

/// Where the vector table holds the top of the stack, whose bottom is that of the memory (`memory.x`); and what the firmware
/// paints it with at reset.
const STACK_TOP: u64 = 0x0800_0000;
const MEMORY: u64 = 0x2000_0000;
const PAINT: u64 = 0xCCCC_CCCC;

/// The stack, byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Stack {
    /// Deepest it has been.
    pub deepest: u64,
    /// What there is of it.
    pub size: u64,
}

impl Stack {
    /// How deep the paint is gone.
    pub(super) fn measured(host: &mut dyn Host) -> Self {
        let top = host.read(STACK_TOP, Width::W32).unwrap_or(MEMORY);
        let painted = |&address: &u64| host.read(address, Width::W32).is_ok_and(|word| word == PAINT);
        let untouched = (MEMORY..top).step_by(4).take_while(painted).count() as u64 * 4;
        let size = top.saturating_sub(MEMORY);
        Self { deepest: size - untouched, size }
    }
}
