//! A run in an operator's hands: armed, started, held and ended by a person and not by the record alone.

use super::step::Step;
use super::{Play, TestRunner};

/// What an operator decides during a run; a run that nobody operates starts when it can and never holds.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Operator {
    /// Someone operates it.
    pub(super) present: bool,
    /// The start was asked for.
    pub(super) start: bool,
    /// A hold was asked for.
    pub(super) hold: bool,
}

impl TestRunner {
    /// Ends whatever test the device is in, one that another host began included: stops it, waits for the stand, disarms.
    pub fn closing() -> Self {
        let operator = Operator { present: true, ..Operator::default() };
        Self { step: Step::Stop, ending: true, operator, ..Self::playing(Play::Streamed(Vec::new())) }
    }

    /// The same run in an operator's hands: armed and filled it waits for [`Self::begin`], and [`Self::hold`] fades it out with
    /// the table held and the relay closed, until [`Self::end`].
    #[must_use]
    pub fn operated(mut self) -> Self {
        self.operator.present = true;
        self
    }

    /// The operator starts the test.
    pub const fn begin(&mut self) {
        if self.waits() {
            self.operator.start = true;
            self.asked = None;
        }
    }

    /// The operator has the test faded out and the table held.
    pub const fn hold(&mut self) {
        self.operator.hold = true;
    }

    /// Whether it is armed and filled, and waits for the operator's start.
    pub const fn waits(&self) -> bool {
        self.operator.present && !self.operator.start && matches!(self.step, Step::Start)
    }

    /// Whether the test is over and the table held until the operator ends it.
    pub const fn holds(&self) -> bool {
        matches!(self.step, Step::Held)
    }

    /// Whether the test runs.
    pub const fn is_running(&self) -> bool {
        matches!(self.step, Step::Start | Step::Stream | Step::Attend(_)) && !self.waits() && !self.operator.hold
            || matches!(self.step, Step::Stand) && !self.operator.hold && !self.ending
    }

    /// Whether the device was asked to arm, and not yet to disarm.
    pub const fn is_armed(&self) -> bool {
        use Step::{Attend, Fill, Held, Stand, Start, Stop, Stream};
        matches!(self.step, Fill | Start | Stream | Attend(_) | Stop | Stand | Held)
    }
}
