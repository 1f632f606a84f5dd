//! The tick.

use shakedown_core::link::MAX_BATCH;
use shakedown_firmware::converters::Converters;
use shakedown_firmware::{Events, Loop};

use crate::board::{converters::OnChip, failure, line, pins::Pins, standing, ticker::Ticker, watchdog::Watchdog};

/// What the tick owns.
pub(crate) struct Control {
    /// What decides.
    pub(crate) decide: Loop<'static>,
    /// Inputs and output.
    pub(crate) converters: OnChip,
    /// Relay, emergency stop, supply.
    pub(crate) pins: Pins,
    /// The timer.
    pub(crate) ticker: Ticker,
    /// Fed once a tick.
    pub(crate) watchdog: Watchdog,
    /// The codes of the last good conversion.
    pub(crate) inputs: [u16; 4],
    /// Ticks since the desk was last woken.
    pub(crate) quiet: u16,
}

impl Control {
    /// One tick: codes in, the loop's decision, a code out.
    #[inline]
    pub(crate) fn tick(&mut self) {
        let read = self.converters.read();
        let events = Events {
            emergency_stop: self.pins.emergency_stop(),
            supply_low: self.pins.supply_low(),
            overrun: self.converters.late(),
            converter: read.is_err(),
        };
        self.inputs = read.unwrap_or(self.inputs);
        let outcome = self.decide.tick(self.inputs, events);
        let _ = self.converters.write(outcome.output);
        self.pins.set_relay(outcome.relay);
        self.watchdog.feed();
        failure::remember(outcome.safe);
        if let Some(rate) = outcome.rate {
            self.ticker.set_rate(rate);
        }
        self.publish();
        self.converters.note_lateness();
    }

    /// Tells the others, and wakes the desk when there is something for it.
    #[inline]
    fn publish(&mut self) {
        let (now, ticks, dropped) = self.decide.standing();
        self.quiet += 1;
        if standing::publish(now, ticks, dropped) || self.quiet >= MAX_BATCH as u16 {
            self.quiet = 0;
            line::wake();
        }
    }
}
