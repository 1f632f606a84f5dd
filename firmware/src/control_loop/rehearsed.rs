//! A tick of a rehearsal: a simulated table takes the place of the converters, and its motion leaves by the output.

use shakedown_core::Relay;

use super::{Codes, ControlLoop, Outcome};

impl ControlLoop<'_> {
    /// The codes that converters at the simulated table read.
    #[inline(never)]
    pub(super) fn rehearsed_codes(&self) -> Codes {
        let codes = self.rehearsal.codes(&self.wires.inputs(), self.reference);
        Codes::of(|input| codes.get(input).copied().unwrap_or(0))
    }

    /// Moves the simulated table by what the tick decided, with oil where the relay would be closed. What goes out is where it
    /// is, in the output's scale, to look at on an oscilloscope.
    #[inline(never)]
    pub(super) fn rehearse(&mut self, outcome: Outcome) -> Outcome {
        let oil = self.controller.relay() == Relay::Closed;
        self.rehearsal.advance(self.wires.output.to_si(outcome.output), oil);
        Outcome { output: self.wires.output.code(self.rehearsal.table().displacement()), ..outcome }
    }
}
