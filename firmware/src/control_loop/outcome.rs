//! What a tick is told by the board, and what it leaves for the board to do.

/// The codes of a tick's inputs, two a word: what is passed on where they are not needed at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Codes(u32, u32);

impl Codes {
    /// These.
    #[inline(always)]
    pub fn of(input: impl Fn(usize) -> u16) -> Self {
        let word = |low, high| u32::from(input(low)) | u32::from(input(high)) << 16;
        Self(word(0, 1), word(2, 3))
    }

    /// From such words: the first two in the first, either's first in the low half.
    #[inline(always)]
    pub const fn of_words([first, second]: [u32; 2]) -> Self {
        Self(first, second)
    }

    /// Each by itself.
    pub const fn each(self) -> [u16; 4] {
        [self.0 as u16, (self.0 >> 16) as u16, self.1 as u16, (self.1 >> 16) as u16]
    }
}

impl From<[u16; 4]> for Codes {
    fn from([reference, displacement, acceleration, external]: [u16; 4]) -> Self {
        let word = |low: u16, high: u16| u32::from(low) | u32::from(high) << 16;
        Self(word(reference, displacement), word(acceleration, external))
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
    /// Whether there is more, which the loop says: its news, and its relay. Not in an ordinary tick of a test, where the relay is
    /// closed as it was.
    pub news: bool,
}

/// What there is to do beside output and relay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Notifications {
    /// There is a new setup.
    pub new_setup: bool,
    /// The others are to be told: the standing is another than in the last tick, or they have not heard for a while.
    pub tell: bool,
}
