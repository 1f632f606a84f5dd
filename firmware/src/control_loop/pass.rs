//! The ordinary tick of a guard, in one straight line: nearly every tick is one, and the rate is what it leaves room for.

use shakedown_core::link::Cause;
use shakedown_core::{Channels, Course};

use super::{Codes, Events, Loop, Outcome, Rest};

impl Loop<'_> {
    /// One tick. `input` gives the codes of reference, displacement, acceleration and existing command by number, each the
    /// same however often it is asked, so that none is kept for a call that is not made.
    pub fn tick(&mut self, input: impl Fn(usize) -> u16) -> Outcome {
        match self.pass(&input) {
            Ok(output) => Outcome { output, news: false },
            Err(rest) => self.finish(Codes::of(input), rest),
        }
    }

    /// An ordinary tick of a guard, in which nothing else is due: the output's code, or what is left to do of a tick that is
    /// none, for [`Self::finish`].
    #[inline(always)]
    pub fn pass(&mut self, input: impl Fn(usize) -> u16) -> Result<u16, Rest> {
        let left = self.left.wrapping_sub(1);
        if left == 0 || self.queues.orders.ready() {
            return Err(Rest::All);
        }
        let Some(sample) = self.wires.guarded(input) else { return Err(Rest::All) };
        if !self.controller.passes(&sample) {
            return Err(Rest::All);
        }
        if self.wires.streamed {
            let Some(point) = self.queues.points.dequeue() else { return Err(Rest::Dry) };
            let Some(reference) = point.displacement() else { return Err(Rest::End) };
            self.reference = reference;
        }
        self.left = left;
        match self.controller.pass(&sample) {
            Course::Whole => Ok(self.wires.output.code(self.controller.valve())),
            Course::Other(_) => Err(Rest::Word),
        }
    }

    /// The rest of a tick that was no ordinary one.
    #[inline(never)]
    pub fn finish(&mut self, inputs: Codes, rest: Rest) -> Outcome {
        match rest {
            Rest::All => return self.tick_with(inputs, Events::default()),
            Rest::Word => return self.attend(inputs, Channels::NONE, false),
            Rest::Dry => self.end_of_stream(Some(Cause::Underrun)),
            Rest::End => self.end_of_stream(None),
        };
        let sample = self.sample(inputs.each());
        self.decide(inputs, sample, false)
    }
}
