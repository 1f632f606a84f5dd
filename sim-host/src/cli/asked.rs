//! What was asked for and when: the command line, the options left at their defaults, the time. Every page states it.

use clap::parser::ValueSource;
use clap::{ArgMatches, Command};
use std::sync::OnceLock;

/// Options that were not given and have a default, as they would be written.
static DEFAULTS: OnceLock<String> = OnceLock::new();

/// Keeps what the command line left at its defaults.
pub(crate) fn keep(command: &Command, matches: &ArgMatches) {
    if let Some((name, below)) = matches.subcommand() {
        if let Some(command) = command.find_subcommand(name) {
            keep(command, below);
        }
        return;
    }
    let told = command.get_arguments().filter_map(|argument| {
        let id = argument.get_id().as_str();
        // Arguments of a group have no source of their own.
        let known = matches.try_contains_id(id).unwrap_or(false);
        let left = known && matches.value_source(id) == Some(ValueSource::DefaultValue);
        let value: Vec<String> =
            argument.get_default_values().iter().map(|value| value.to_string_lossy().into_owned()).collect();
        let flag = value.iter().all(|value| value == "false");
        (left && !flag).then(|| format!("--{} {}", argument.get_long().unwrap_or(id), value.join(" ")))
    });
    let _ = DEFAULTS.set(told.collect::<Vec<_>>().join(" "));
}

/// The options that were left at their defaults; empty where there are none.
pub(crate) fn defaults() -> &'static str {
    DEFAULTS.get().map_or("", String::as_str)
}

/// The command line as a shell takes it again.
pub(crate) fn line() -> String {
    let words = std::env::args().skip(1).map(|word| quoted(&word));
    std::iter::once("shakedown".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// A word as a shell takes it again.
pub(crate) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_=./,:%+@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// Seconds since 1970.
pub(super) fn seconds() -> u64 {
    std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

/// The time now, UTC, as `2026-11-24T00:38:23Z`.
pub(crate) fn utc() -> String {
    let now = seconds();
    let (days, second) = (now / 86_400, now % 86_400);
    // Days to a date in the Gregorian calendar (Howard Hinnant's algorithm), from 0000-03-01.
    let shifted = days + 719_468;
    let (era, day_of_era) = (shifted / 146_097, shifted % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}Z", second / 3600, second / 60 % 60, second % 60)
}
