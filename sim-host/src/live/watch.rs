//! The thread that watches: the bench's samples into frames, orders to the bench.

use std::time::{Duration, Instant};

use serde::Serialize;

use super::bench::{Bench, BenchError, Order, Status};
use super::frame::Frames;
use super::hub::Hub;

/// Between two frames.
const FRAME: Duration = Duration::from_millis(50);
/// Longest wait for a bench that is to be ended.
const PATIENCE: Duration = Duration::from_secs(30);

/// What was watched.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Samples received.
    pub samples: u64,
    /// Records missing between them.
    pub missing: u64,
    /// Records that the device had no room for.
    pub dropped: u64,
    /// Frames garbled on the line.
    pub garbled: u64,
    /// How long, s.
    pub seconds: f64,
    /// What happened last.
    pub message: String,
}

/// Watches until `over` says so; then whatever is under way is stopped first, and waited for.
pub fn watch(bench: &mut impl Bench, hub: &Hub, mut over: impl FnMut(&Status) -> bool) -> Result<Summary, BenchError> {
    let mut frames = Frames::new(bench.facts().rate);
    let begun = Instant::now();
    let mut due = begun;
    let mut ending: Option<Instant> = None;
    loop {
        frames.take(&bench.advance()?);
        while let Some(asked) = hub.asked() {
            let _ = asked.reply.send(bench.order(asked.order));
        }
        if Instant::now() >= due {
            due = Instant::now() + FRAME;
            hub.publish(frames.next(&bench.status()));
        }
        if ending.is_none() && over(&bench.status()) {
            ending = Some(Instant::now());
            let _ = bench.order(Order::Stop);
        }
        if ending.is_some_and(|since| bench.is_idle() || since.elapsed() > PATIENCE) {
            hub.publish(frames.next(&bench.status()));
            return Ok(summary(&bench.status(), begun.elapsed()));
        }
    }
}

fn summary(status: &Status, time: Duration) -> Summary {
    Summary {
        samples: status.samples,
        missing: status.missing,
        dropped: status.dropped,
        garbled: status.garbled,
        seconds: (time.as_secs_f64() * 10.0).round() / 10.0,
        message: status.message.clone(),
    }
}
