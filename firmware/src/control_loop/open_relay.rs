//! Proof of an open relay: what a program needs in hand before it may stop the ticks or change what the codes mean.

/// The relay of the hydraulic block is open, and stays so for as long as this exists.
///
/// The loop alone makes one, at a tick that finds the relay open as the tick before left it. It cannot be copied. While one is
/// lent the loop carries out no order, so nothing closes the relay before the proof is back; a holder that never returns it
/// leaves a device that does not arm.
#[derive(Debug, PartialEq, Eq)]
pub struct OpenRelay(());

impl OpenRelay {
    /// For the loop, which has just looked.
    pub(super) const fn seen() -> Self {
        Self(())
    }
}
