//! Progress in a terminal.

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

/// Shows what is being done; its share of the whole jumps too much to be worth a terminal's line.
pub(crate) fn at(spinner: &ProgressBar, what: &str, _share: f64) {
    spinner.set_message(what.to_owned());
}

fn styled(bar: &ProgressBar, template: &str) {
    // A template that does not parse costs the bar its looks, never the work.
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
}
