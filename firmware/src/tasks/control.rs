//! The tick.

use shakedown_core::link::MAX_BATCH;
use shakedown_firmware::converters::{Converters, INPUTS};
use shakedown_firmware::{Events, Loop, Outcome};

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
        let Ok(inputs) = self.converters.read() else { return self.tick_noticing([0; INPUTS], true) };
        if self.pins.emergency_stop() | self.pins.supply_low() | self.converters.late() {
            return self.tick_noticing(inputs, false);
        }
        let outcome = self.decide.tick(inputs);
        self.act(outcome);
    }

    /// The same when the board has something to say.
    #[cold]
    #[inline(never)]
    fn tick_noticing(&mut self, inputs: [u16; INPUTS], no_sample: bool) {
        let events = Events {
            emergency_stop: self.pins.emergency_stop(),
            supply_low: self.pins.supply_low(),
            overrun: self.converters.take_lateness(),
            no_sample,
        };
        let outcome = self.decide.tick_with(inputs, events);
        self.act(outcome);
    }

    /// What follows from a tick on the board.
    #[inline(always)]
    fn act(&mut self, outcome: Outcome) {
        let _ = self.converters.write(outcome.output);
        self.pins.set_relay(outcome.relay);
        self.watchdog.feed();
        if outcome.new_setup {
            self.take_setup();
        }
        self.publish(outcome.changed);
        self.converters.note_lateness();
    }

    /// What else a setup changes: the rate, and what a failing program leaves on the output.
    #[inline(never)]
    fn take_setup(&mut self) {
        self.ticker.set_rate(self.decide.rate() as u32);
        failure::prepare(self.decide.zero_flow());
    }

    /// Tells the others where the loop stands when that is news, and every so many ticks.
    #[inline]
    fn publish(&mut self, changed: bool) {
        if changed || self.decide.counts().0 % MAX_BATCH as u32 == 0 {
            self.tell();
        }
    }

    /// Tells them, and wakes the desk. The first tick is news, so that the output is out from then on.
    #[inline(never)]
    fn tell(&mut self) {
        let (ticks, dropped) = self.decide.counts();
        standing::publish(self.decide.standing(), ticks, dropped);
        self.converters.go_live();
        line::wake();
    }
}
