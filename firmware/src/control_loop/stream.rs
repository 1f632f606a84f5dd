//! The streamed reference: taken point by point while a test runs and while it fades out. Where no more comes it brakes, for a
//! reference that stops dead asks the table for an acceleration that no table has.

use shakedown_core::link::StopCause;
use shakedown_core::{OperatorRequest, Settings, State};

use super::ControlLoop;
use crate::queues::Point;

/// Where the stream stands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stream {
    /// By how much the reference moved in the last tick, m.
    step: f32,
    /// Whether points are still taken.
    flows: bool,
    /// Whether the points that are left are of a record that was broken off.
    broken_off: bool,
}

impl Stream {
    /// Before a test.
    pub(super) const RESTING: Self = Self { step: 0.0, flows: true, broken_off: false };
}

/// How a reference comes to rest of which no more comes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Braking {
    /// What it loses of its step in a tick, m: the envelope's stopping deceleration, so that it goes no farther than is planned for a
    /// table that stops.
    brake: f32,
    /// Largest step that it goes on with, m: that of a table at its velocity limit.
    fastest: f32,
    /// Farthest from the middle that a reference is believed, m.
    farthest: f32,
}

impl Braking {
    /// Under `settings`; without a guard it stops dead.
    pub(super) fn of(settings: &Settings) -> Self {
        let dt = 1.0 / settings.rate;
        let deceleration = settings.guard.map_or(f32::INFINITY, |guard| guard.envelope.stopping_deceleration);
        Self {
            brake: deceleration * dt * dt,
            fastest: settings.velocity_limit * dt,
            farthest: settings.ranges.reference,
        }
    }

    /// The next of a `reference` (m) that moved by `step` (m) in the last tick.
    fn next(&self, reference: f32, step: &mut f32) -> f32 {
        let kept = step.clamp(-self.fastest, self.fastest);
        *step = kept - kept.clamp(-self.brake, self.brake);
        (reference + *step).clamp(-self.farthest, self.farthest)
    }
}

impl ControlLoop<'_> {
    /// The next point of a streamed reference, m.
    #[inline]
    pub(super) fn next_point(&mut self) -> f32 {
        if !matches!(self.controller.state(), State::Running | State::Hold | State::RampDown) {
            return self.reference;
        }
        if self.stream.flows {
            match self.queues.points.dequeue().map(Point::displacement) {
                Some(Some(point)) => {
                    self.stream.step = point - self.reference;
                    return point;
                }
                Some(None) => self.end_of_stream(None),
                None => self.end_of_stream(Some(StopCause::Underrun)),
            }
        }
        self.braking.next(self.reference, &mut self.stream.step)
    }

    /// No more points: fades the test out, and says why where it was not to end. A test that is faded out already has its cause.
    #[inline(never)]
    fn end_of_stream(&mut self, cause: Option<StopCause>) {
        self.stream.flows = false;
        self.stream.broken_off |= cause.is_some();
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
            OperatorRequest::Start => self.stream = Stream::RESTING,
            OperatorRequest::Stop => self.stream.broken_off = true,
            _ => {}
        }
    }

    /// Lets go of what is left of a record that was broken off, in the tick in which its test has come to a stand: whatever comes later is
    /// of the next.
    pub(super) fn forget_broken_off(&mut self) {
        if self.stream.broken_off && self.controller.state() == State::Ready {
            self.drop_points();
        }
    }

    fn drop_points(&mut self) {
        while self.queues.points.dequeue().is_some() {}
        self.stream.broken_off = false;
    }
}

#[cfg(test)]
mod tests;
