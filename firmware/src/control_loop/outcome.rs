//! What a tick is told by the board, and what it leaves for the board to do.

/// The codes of a tick's inputs, two a word: what is passed on where they are not needed at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Codes(u32, u32);

impl Codes {
    /// These.
    #[inline(always)]
    pub const fn of(inputs: &[u16; 4]) -> Self {
        let &[a, b, c, d] = inputs;
        Self(a as u32 | (b as u32) << 16, c as u32 | (d as u32) << 16)
    }

    /// Each by itself.
    pub const fn each(self) -> [u16; 4] {
        [self.0 as u16, (self.0 >> 16) as u16, self.1 as u16, (self.1 >> 16) as u16]
    }
}

/// What the board noticed since the last tick; the default is nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Events {
    /// The emergency-stop circuit is open.
    pub emergency_stop: bool,
    /// The supply is below its threshold.
    pub supply_low: bool,
    /// There is no sample: the inputs are those of an earlier tick.
    pub no_sample: bool,
}

/// What a tick leaves for the board to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Outcome {
    /// Output code.
    pub output: u16,
    /// What else there is to do. None in an ordinary tick of a test: the relay is closed, as it was, and everything else is as it
    /// was told.
    pub news: Option<News>,
}

impl Outcome {
    /// Whether the relay of the hydraulic block is closed.
    pub fn relay(self) -> bool {
        self.news.is_none_or(|news| news.relay)
    }
}

/// What there is to do beside the output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct News {
    /// Whether the relay of the hydraulic block is closed.
    pub relay: bool,
    /// There is a new setup.
    pub new_setup: bool,
    /// The others are to be told: the standing is another than in the last tick, or they have not heard for a while.
    pub tell: bool,
}
