//! Progress on standard error for anything over a second; nothing where nobody watches.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// A bar over `total` steps of `what` (a plural noun: `runs`, `cases`), with the time left.
pub(crate) fn bar(total: u64, what: &'static str) -> ProgressBar {
    let bar = ProgressBar::new(total);
    styled(&bar, "{prefix} {wide_bar} {pos}/{len}, {eta} left");
    bar.set_prefix(what);
    bar
}

/// A spinner for work whose length is not known: `reading Kobe`.
pub(crate) fn spinner(what: String) -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    styled(&bar, "{spinner} {msg} ({elapsed})");
    bar.set_message(what);
    bar
}

fn styled(bar: &ProgressBar, template: &str) {
    // A template that does not parse costs the bar its looks, never the work.
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
}
