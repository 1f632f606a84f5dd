//! Progress as lines on standard error that the page in a browser reads: `progress 0.42 trying pairs`, the share of the whole
//! first, `-` where it is not known.

use super::super::output::tell;
use std::borrow::Cow;
use std::sync::atomic::{AtomicU64, Ordering};

/// A bar over `total` steps, or a spinner where that is zero.
#[derive(Debug)]
pub(crate) struct Bar {
    what: &'static str,
    total: u64,
    done: AtomicU64,
}

/// A bar over `total` steps of `what` (a plural noun: `runs`, `cases`).
pub(crate) fn bar(total: u64, what: &'static str) -> Bar {
    Bar { what, total, done: AtomicU64::new(0) }
}

/// A spinner for work whose length is not known: `reading Kobe`.
pub(crate) fn spinner(what: String) -> Bar {
    let spinner = bar(0, "");
    spinner.set_message(what);
    spinner
}

/// Says what is being done, and its share of the whole.
pub(crate) fn at(_spinner: &Bar, what: &str, share: f64) {
    tell(&format!("progress {share:.2} {what}"));
}

impl Bar {
    /// `steps` more are done.
    pub(crate) fn inc(&self, steps: u64) {
        let done = self.done.fetch_add(steps, Ordering::Relaxed) + steps;
        if self.total > 0 {
            at(self, self.what, done as f64 / self.total as f64);
        }
    }

    /// Says what is being done.
    #[allow(clippy::unused_self, reason = "the method of the terminal's spinner")]
    pub(crate) fn set_message(&self, what: impl Into<Cow<'static, str>>) {
        tell(&format!("progress - {}", what.into()));
    }

    /// Nothing is left on a page that has to be cleared.
    #[allow(clippy::unused_self, reason = "the method of the terminal's spinner")]
    pub(crate) fn finish_and_clear(&self) {}
}
