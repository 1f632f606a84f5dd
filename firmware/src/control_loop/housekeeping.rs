//! What is due now and then: telemetry, news for the board, and when the next of either is.

use shakedown_core::link::Record;
use shakedown_core::{Command, State};

use super::{Codes, ControlLoop, Notifications, Outcome};
use crate::queues::Entry;

impl ControlLoop<'_> {
    /// The rest of a tick in which something is due or may have changed.
    #[inline(never)]
    pub(super) fn housekeeping(&mut self, inputs: Codes, command: &Command, new_setup: bool) -> Outcome {
        let output = match self.probe {
            Some(code) if self.controller.state() == State::Off => self.wires.output.nearest(code),
            _ => self.wires.output.code(command.valve),
        };
        self.forget_broken_off();
        let (ticks, _) = self.counts();
        self.report(ticks.wrapping_sub(1), inputs.each(), command, output);
        let changes = u16::from(self.controller.changes());
        let changed = changes != self.told;
        self.told = changes;
        self.news = Notifications { new_setup, tell: changed || ticks % u32::from(self.round) == 0 };
        self.schedule(ticks);
        Outcome { output, news: true }
    }

    /// Works out which tick is the next to attend to, after `ticks` of them.
    fn schedule(&mut self, ticks: u32) {
        let round = u32::from(self.round);
        self.left = round - ticks % round;
        if self.every > 0 {
            self.left = self.left.min(self.record_at.wrapping_sub(ticks).wrapping_add(1));
        }
        self.due = ticks.wrapping_add(self.left);
    }

    /// Telemetry, every so many ticks.
    fn report(&mut self, tick: u32, inputs: [u16; 4], command: &Command, output: u16) {
        if self.every == 0 || tick != self.record_at {
            return;
        }
        self.record_at = tick.wrapping_add(u32::from(self.every));
        let record = Record {
            reference: self.reference,
            fitted: command.reference,
            inputs,
            output,
            flags: command.status.bits(),
        };
        let entry = Entry { tick, state: command.status.state, record };
        if self.queues.records.enqueue(entry).is_err() {
            self.dropped = self.dropped.wrapping_add(1);
        }
    }
}
