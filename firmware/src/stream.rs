//! Where the reference comes from in a run, and how a run that must end early comes to a stand.

use crate::queues::LoopEnd;

/// Share of its speed that a stopping reference keeps in a tick; with a time constant of 50 ms at any rate.
const STOP_TIME: f32 = 0.05;
/// Time constants after which a stop is done.
const STOP_LENGTH: f32 = 6.0;

/// What the stream says at a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Next {
    /// The next point, m.
    Point(f32),
    /// The record is over.
    End,
    /// There should have been a point and there is none.
    Underrun,
}

/// Takes the next point of a streamed reference.
#[inline]
pub fn next(queues: &mut LoopEnd<'_>) -> Next {
    match queues.points.dequeue() {
        Some(point) => point.displacement().map_or(Next::End, Next::Point),
        None => Next::Underrun,
    }
}

/// Forgets every point that waits.
pub fn clear(queues: &mut LoopEnd<'_>) {
    while queues.points.dequeue().is_some() {}
}

/// Brings a reference to a stand: its speed decays with a time constant of 50 ms.
#[derive(Debug, Clone, Copy)]
pub struct Stop {
    reference: f32,
    change: f32,
    kept: f32,
    left: u32,
}

impl Stop {
    /// From `reference`, m, which moved by `change`, m, in the last tick, at `rate` ticks a second.
    pub fn new(reference: f32, change: f32, rate: f32) -> Self {
        let kept = 1.0 - 1.0 / (STOP_TIME * rate).max(1.0);
        Self { reference, change, kept, left: (STOP_TIME * STOP_LENGTH * rate) as u32 }
    }

    /// The next reference, m; none when the stop is done.
    pub fn step(&mut self) -> Option<f32> {
        self.left = self.left.checked_sub(1)?;
        self.change *= self.kept;
        self.reference += self.change;
        Some(self.reference)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_from_full_speed_takes_an_eighth_of_a_second_of_travel_at_most() {
        let (speed, rate) = (0.242, 1000.0);
        let mut stop = Stop::new(0.0, speed / rate, rate);
        let (mut reference, mut last, mut ticks) = (0.0, 0.0, 0);
        while let Some(next) = stop.step() {
            assert!(next >= reference);
            last = next - reference;
            reference = next;
            ticks += 1;
        }
        assert_eq!(ticks, 300);
        assert!((reference - speed * STOP_TIME).abs() < 0.03 * speed * STOP_TIME, "{reference}");
        assert!(last * rate < 0.003 * speed);
    }
}
