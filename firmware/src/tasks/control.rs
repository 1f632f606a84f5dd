//! The tick.

use shakedown_firmware::converters::{Converters, INPUTS};
use shakedown_firmware::{Codes, Events, Loop, News, Outcome};

use crate::board::{converters::OnChip, failure, line, pins::Pins, standing, ticker::Ticker, watchdog::Watchdog};

/// What the tick owns.
pub(crate) struct Control {
    /// What decides.
    pub(crate) decide: &'static mut Loop<'static>,
    /// Inputs and output.
    pub(crate) converters: OnChip,
    /// Relay, emergency stop, supply.
    pub(crate) pins: Pins,
    /// The timer.
    pub(crate) ticker: Ticker,
    /// Fed once a tick.
    pub(crate) watchdog: Watchdog,
}

impl Control {
    /// One tick: codes in, the loop's decision, a code out.
    #[inline]
    pub(crate) fn tick(&mut self) {
        if self.converters.failed() {
            return self.tick_noticing(true);
        }
        if self.pins.emergency_stop() | self.pins.supply_low() {
            return self.tick_noticing(false);
        }
        let outcome = self.decide.tick(&self.converters.codes());
        self.act(outcome);
    }

    /// The same when the board has something to say.
    #[cold]
    #[inline(never)]
    fn tick_noticing(&mut self, no_sample: bool) {
        let inputs = if no_sample { [0; INPUTS] } else { self.converters.codes() };
        let events = Events {
            emergency_stop: self.pins.emergency_stop(),
            supply_low: self.pins.supply_low(),
            no_sample,
        };
        let outcome = self.decide.tick_with(Codes::of(&inputs), events);
        self.act(outcome);
    }

    /// What follows from a tick on the board.
    #[inline(always)]
    fn act(&mut self, outcome: Outcome) {
        let _ = self.converters.write(outcome.output);
        self.watchdog.feed();
        if let Some(news) = outcome.news {
            self.attend(news);
        }
        if self.converters.late() {
            self.decide.overrun();
        }
    }

    /// What follows now and then. The first tick is news, so that the output is out from then on.
    #[inline(never)]
    fn attend(&mut self, news: News) {
        self.pins.set_relay(news.relay);
        if news.new_setup {
            self.take_setup();
        }
        if news.tell {
            let (ticks, dropped) = self.decide.counts();
            standing::publish(self.decide.standing(), ticks, dropped);
            self.converters.go_live();
            line::wake();
        }
    }

    /// What else a setup changes: the rate, and what a failing program leaves on the output.
    fn take_setup(&mut self) {
        self.ticker.set_rate(self.decide.rate() as u32);
        failure::prepare(self.decide.zero_flow());
    }
}
