//! What a tick is told by the board, and what it leaves for the board to do.

/// What the board noticed since the last tick; the default is nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Events {
    /// The emergency-stop circuit is open.
    pub emergency_stop: bool,
    /// The supply is below its threshold.
    pub supply_low: bool,
    /// The last tick was not done when this one began.
    pub overrun: bool,
    /// There is no sample: the inputs are those of an earlier tick.
    pub no_sample: bool,
}

/// What a tick leaves for the board to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Output code.
    pub output: u16,
    /// Whether the relay of the hydraulic block is closed.
    pub relay: bool,
    /// There is a new setup.
    pub new_setup: bool,
    /// The standing is another than in the last tick.
    pub changed: bool,
}
