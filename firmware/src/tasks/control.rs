//! The tick.

use shakedown_firmware::converters::Converters;
use shakedown_firmware::{Codes, ControlLoop, Events, Outcome};

use crate::board::{
    converters, converters::OnChip, failure, line, pins::Pins, standing, ticker::Ticker, watchdog::Watchdog,
};

/// What the tick owns.
pub(crate) struct Control {
    /// What decides.
    pub(crate) decide: &'static mut ControlLoop<'static>,
    /// Inputs and output.
    pub(crate) converters: OnChip,
    /// Relay, emergency stop, supply.
    pub(crate) pins: Pins,
    /// The timer.
    pub(crate) ticker: Ticker,
    /// Fed where something follows a tick, which is at least every sixteenth, and the link has been served.
    pub(crate) watchdog: Watchdog,
}

impl Control {
    /// One tick: codes in, the loop's decision, a code out. What happens now and then is a call away.
    #[inline]
    pub(crate) fn tick(&mut self) {
        let failed = self.converters.failed();
        if failed | self.pins.emergency_stop() | self.pins.supply_low() {
            return self.tick_noticing(failed);
        }
        let outcome = self.decide.tick_with(Codes::of(converters::sampled), Events::default());
        self.housekeeping(outcome);
    }

    /// A tick whose sample the converter lost: it is set up again, and the loop is told.
    #[cold]
    pub(crate) fn tick_without_sample(&mut self) {
        self.tick_noticing(true);
    }

    /// One tick when the board has something to say.
    #[cold]
    #[inline(never)]
    fn tick_noticing(&mut self, no_sample: bool) {
        let events =
            Events { emergency_stop: self.pins.emergency_stop(), supply_low: self.pins.supply_low(), no_sample };
        if no_sample {
            self.converters.arm();
        }
        let inputs = Codes::of(|input| if no_sample { 0 } else { converters::sampled(input) });
        let outcome = self.decide.tick_with(inputs, events);
        self.housekeeping(outcome);
    }

    /// The code goes out.
    #[inline(always)]
    fn put(&mut self, output: u16) {
        let _ = self.converters.write(output);
        if OnChip::late() {
            self.decide.overrun();
        }
    }

    /// The same, and what follows now and then. The first tick is news, so that the output is out from then on.
    fn housekeeping(&mut self, outcome: Outcome) {
        self.put(outcome.output);
        if outcome.news {
            self.pins.set_relay(self.decide.relay());
            self.watchdog.feed();
            let news = self.decide.news();
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
    }

    /// What else a setup changes: the rate, and what a failing program leaves on the output.
    fn take_setup(&mut self) {
        self.ticker.set_rate(self.decide.rate() as u32);
        failure::prepare(self.decide.zero_flow());
    }
}
