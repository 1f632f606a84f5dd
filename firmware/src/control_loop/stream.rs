//! The streamed reference: taken point by point while a test runs and while it fades out. Where no more comes it brakes, for a
//! reference that stops dead asks the table for an acceleration that no table has.

use shakedown_core::link::StopCause;
use shakedown_core::{OperatorRequest, State};

use super::ControlLoop;
use crate::queues::Point;

impl ControlLoop<'_> {
    /// The next point of a streamed reference, m.
    #[inline]
    pub(super) fn next_point(&mut self) -> f32 {
        if !matches!(self.controller.state(), State::Running | State::Hold | State::RampDown) {
            return self.reference;
        }
        if self.flows {
            match self.queues.points.dequeue().map(Point::displacement) {
                Some(Some(point)) => {
                    self.step = point - self.reference;
                    return point;
                }
                Some(None) => self.end_of_stream(None),
                None => self.end_of_stream(Some(StopCause::Underrun)),
            }
        }
        self.step = self.controller.coast(self.reference, self.step, 1.0 / self.rate);
        self.reference + self.step
    }

    /// No more points: fades the test out, and says why where it was not to end. A test that is faded out already has its cause.
    #[inline(never)]
    fn end_of_stream(&mut self, cause: Option<StopCause>) {
        self.flows = false;
        self.broken_off |= cause.is_some();
        if self.controller.state() != State::RampDown {
            self.attribute_trip(cause);
            let _ = self.controller.request(OperatorRequest::Stop);
        }
    }

    /// What a `request` that was carried out makes of the stream: a new test begins with what was sent since it was armed, and of one that
    /// is stopped the points go on while it fades.
    pub(super) fn stream_for(&mut self, request: OperatorRequest) {
        match request {
            OperatorRequest::Arm => self.drop_points(),
            OperatorRequest::Start => (self.step, self.flows, self.broken_off) = (0.0, true, false),
            OperatorRequest::Stop => self.broken_off = true,
            // The last of a reference that tripped the test may be what the gate does not believe.
            OperatorRequest::Reset if self.wires.streamed => self.reference = 0.0,
            _ => {}
        }
    }

    /// Lets go of what is left of a record that was broken off, in the tick in which its test has come to a stand: whatever comes later is
    /// of the next.
    pub(super) fn forget_broken_off(&mut self) {
        if self.broken_off && self.controller.state() == State::Ready {
            self.drop_points();
        }
    }

    fn drop_points(&mut self) {
        while self.queues.points.dequeue().is_some() {}
        self.broken_off = false;
    }
}

#[cfg(test)]
mod tests;
