//! A tick on any board: codes in, the loop's decision, a code out, and what follows now and then.
//!
//! What a port to another board supplies is a [`Board`] with its [`Converters`]; the rest of a tick is here, and the same on all.

use crate::control_loop::{Codes, ControlLoop, Events, Outcome};
use crate::converters::Converters;
use crate::output::ZeroFlow;
use crate::queues::TestStatus;

/// What a tick asks of a board. Everything takes bounded time, allocates nothing and waits for nothing.
pub trait Board {
    /// Its converters.
    type Pair: Converters;

    /// Its converters.
    fn pair(&mut self) -> &mut Self::Pair;

    /// Whether the emergency-stop circuit is open.
    fn emergency_stop(&self) -> bool;

    /// Whether the supply is below its threshold.
    fn supply_low(&self) -> bool;

    /// Closes or opens the relay of the hydraulic block.
    fn set_relay(&mut self, closed: bool);

    /// Whether the next tick has come already; asked at the end of a tick.
    fn late(&self) -> bool;

    /// The ticks go on; a board whose link does too feeds its watchdog.
    fn feed_watchdog(&mut self);

    /// A setup is in force: ticks at `rate` (Hz) from the next one on, and `zero_flow` on the output where the program fails.
    fn take_setup(&mut self, rate: u32, zero_flow: ZeroFlow);

    /// Publishes state and cause of the test, ticks so far and records dropped for the link server, and wakes it; the output is live from the
    /// first of these on.
    fn tell(&mut self, standing: TestStatus, ticks: u32, dropped: u32);
}

/// What the tick owns.
#[allow(missing_debug_implementations, reason = "the queues have none")]
pub struct Control<'l, 'q, B> {
    /// What decides.
    decide: &'l mut ControlLoop<'q>,
    board: B,
    /// The last code did not reach the output.
    unwritten: bool,
}

impl<'l, 'q, B: Board> Control<'l, 'q, B> {
    /// Ticks of `decide` on `board`.
    pub const fn new(decide: &'l mut ControlLoop<'q>, board: B) -> Self {
        Self { decide, board, unwritten: false }
    }

    /// The board.
    pub const fn board(&self) -> &B {
        &self.board
    }

    /// One tick. What happens now and then is a call away.
    #[inline]
    pub fn tick(&mut self) {
        let read = self.board.pair().read();
        match read {
            Ok(codes) if !(self.unwritten | self.board.emergency_stop() | self.board.supply_low()) => {
                let outcome = self.decide.tick_with(codes, Events::default());
                self.attend(outcome);
            }
            read => self.tick_noticing(read.ok()),
        }
    }

    /// A tick whose sample the converter lost: it is set up again, and the loop is notified.
    #[cold]
    pub fn tick_without_sample(&mut self) {
        self.tick_noticing(None);
    }

    /// One tick when the board has something to say. A code that did not reach the output counts as a sample that did not come.
    #[cold]
    #[inline(never)]
    fn tick_noticing(&mut self, codes: Option<Codes>) {
        let no_sample = codes.is_none() || self.unwritten;
        let events =
            Events { emergency_stop: self.board.emergency_stop(), supply_low: self.board.supply_low(), no_sample };
        if no_sample {
            self.board.pair().recover();
        }
        let outcome = self.decide.tick_with(codes.unwrap_or_else(|| Codes::of(|_| 0)), events);
        self.attend(outcome);
    }

    /// The code goes out, and what follows now and then. The first tick is news, so that the output is out from then on.
    #[inline(always)]
    fn attend(&mut self, outcome: Outcome) {
        self.unwritten = self.board.pair().write(outcome.output).is_err();
        if self.board.late() {
            self.decide.overrun();
        }
        if outcome.news {
            self.see_to_news();
        }
    }

    /// What follows now and then.
    #[inline(never)]
    fn see_to_news(&mut self) {
        self.board.set_relay(self.decide.relay());
        self.board.feed_watchdog();
        let news = self.decide.news();
        if news.new_setup {
            self.board.take_setup(self.decide.rate() as u32, self.decide.zero_flow());
        }
        if news.tell {
            let (ticks, dropped) = self.decide.counts();
            self.board.tell(self.decide.standing(), ticks, dropped);
        }
    }
}

#[cfg(test)]
mod tests;
