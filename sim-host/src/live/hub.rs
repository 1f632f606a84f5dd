//! Between the thread that watches and the server: the last frames one way, orders the other.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};

use tokio::sync::{oneshot, watch};

use super::bench::{Answer, Facts, Order};

/// Frames kept for a page that opens or reconnects: the twenty seconds that it shows.
const KEPT: usize = 400;

/// An order and where its outcome goes.
#[derive(Debug)]
pub(super) struct Asked {
    pub(super) order: Order,
    pub(super) reply: oneshot::Sender<Result<Answer, String>>,
}

#[derive(Debug, Default)]
struct Kept {
    frames: VecDeque<(u64, Arc<str>)>,
    last: u64,
}

/// What both sides share.
#[derive(Debug)]
pub struct Hub {
    facts: Facts,
    kept: Mutex<Kept>,
    newest: watch::Sender<u64>,
    asking: mpsc::Sender<Asked>,
    asked: Mutex<mpsc::Receiver<Asked>>,
}

impl Hub {
    /// A hub without a frame, for a bench of these facts.
    pub fn new(facts: Facts) -> Arc<Self> {
        let (asking, asked) = mpsc::channel();
        Arc::new(Self {
            facts,
            kept: Mutex::default(),
            newest: watch::Sender::new(0),
            asking,
            asked: Mutex::new(asked),
        })
    }

    pub(super) fn facts(&self) -> &Facts {
        &self.facts
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        // Every change of it is whole before anything can panic.
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Shows a frame to whoever watches.
    pub(super) fn publish(&self, frame: String) {
        let mut kept = self.kept();
        kept.last += 1;
        let number = kept.last;
        if kept.frames.len() == KEPT {
            kept.frames.pop_front();
        }
        kept.frames.push_back((number, frame.into()));
        drop(kept);
        self.newest.send_replace(number);
    }

    /// The frames after `number` that are still kept.
    pub(super) fn after(&self, number: u64) -> Vec<(u64, Arc<str>)> {
        self.kept().frames.iter().filter(|(n, _)| *n > number).cloned().collect()
    }

    /// Hears of new frames.
    pub(super) fn listener(&self) -> watch::Receiver<u64> {
        self.newest.subscribe()
    }

    /// Hands an order over.
    pub(super) fn ask(&self, order: Order) -> oneshot::Receiver<Result<Answer, String>> {
        let (reply, outcome) = oneshot::channel();
        // Where nobody watches any more the reply is dropped, and the asker hears of that.
        let _ = self.asking.send(Asked { order, reply });
        outcome
    }

    /// The next order.
    pub(super) fn asked(&self) -> Option<Asked> {
        self.asked.lock().unwrap_or_else(PoisonError::into_inner).try_recv().ok()
    }
}
