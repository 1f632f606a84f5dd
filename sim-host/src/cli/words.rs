//! The words of the command line: negative numbers as values of options, and the parser's refusals in plain words.

use super::Failure;
use super::output::print;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{ArgMatches, Command};
use std::error::Error as _;
use std::ffi::OsString;
use std::io::IsTerminal as _;
use std::process::ExitCode;

/// Reads the process's command line.
pub(crate) fn matches(command: &mut Command) -> Result<ArgMatches, ExitCode> {
    command.try_get_matches_from_mut(joined(std::env::args_os())).map_err(|e| refused(&e))
}

/// The exit status of a command line that was refused, or that asked for help or the version.
pub(crate) fn refused(error: &clap::Error) -> ExitCode {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        let text = error.render();
        print(&if std::io::stdout().is_terminal() { text.ansi().to_string() } else { text.to_string() });
        return super::output::finished().err().map_or(ExitCode::SUCCESS, |failure| failure.report());
    }
    let text = plain(error).unwrap_or_else(|| {
        let text = error.render().to_string();
        let text = text.strip_prefix("error: ").unwrap_or(&text).trim_end();
        if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
            return format!("a command is missing\n\n{text}");
        }
        // The parser takes every unknown option for a value that was meant.
        let lines: Vec<&str> = text.lines().collect();
        let tip = lines.iter().position(|line| line.contains("tip: to pass '-"));
        let kept = lines.iter().enumerate().filter(|(i, _)| tip.is_none_or(|tip| *i != tip && *i != tip + 1));
        kept.map(|(_, line)| *line).collect::<Vec<_>>().join("\n")
    });
    Failure::Input(text).report()
}

/// The words with a value that begins with a minus sign joined to its option, `--trim -1,5` as `--trim=-1,5`: the parser
/// would take it for an option.
fn joined(words: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut all: Vec<OsString> = Vec::new();
    let mut options = true;
    for word in words {
        options &= word != "--";
        match all.last_mut() {
            Some(last) if options && negative(&word) && takes_value(last) => {
                last.push("=");
                last.push(word);
            }
            _ => all.push(word),
        }
    }
    all
}

/// True for `--name` without a value joined to it.
fn takes_value(word: &OsString) -> bool {
    word.to_str().is_some_and(|w| w.len() > 2 && w.starts_with("--") && !w.contains('='))
}

/// True for a minus sign with a number behind it, whatever follows.
fn negative(word: &OsString) -> bool {
    let Some(rest) = word.to_str().and_then(|w| w.strip_prefix('-')) else { return false };
    let lower = rest.to_ascii_lowercase();
    rest.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '.' | ',')) || lower == "inf" || lower == "nan"
}

/// A value that could not be read, in the words of whoever wrote it; none for every other refusal.
fn plain(error: &clap::Error) -> Option<String> {
    if error.kind() != ErrorKind::ValueValidation {
        return None;
    }
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    let option = text(ContextKind::InvalidArg)?;
    let option = option.split(" <").next().unwrap_or(option);
    let value = text(ContextKind::InvalidValue)?;
    let shown: String = value.chars().take(60).collect();
    let reason = error.source()?.to_string();
    Some(format!("{option} {shown}: {}", remedy(value, &reason)))
}

/// What is wrong with a value, and what to write; the parser's own reason where it is in plain words already.
fn remedy(value: &str, reason: &str) -> String {
    let point = value.replacen(',', ".", 1);
    match reason {
        "invalid float literal" | "invalid digit found in string" if value != point && point.parse::<f64>().is_ok() => {
            format!("the decimal sign is a point: write {point}")
        }
        "invalid float literal" if alone(value).is_some() => {
            format!("write the number alone, {}, in the unit that --help names", alone(value).unwrap_or_default())
        }
        "invalid float literal" | "cannot parse float from empty string" => {
            "expected a number, for instance 0.005".to_owned()
        }
        "cannot parse integer from empty string" => "expected a whole number, for instance 4".to_owned(),
        "invalid digit found in string" if value.starts_with('-') => {
            "expected a whole number that is not negative, for instance 4".to_owned()
        }
        "invalid digit found in string" => "expected a whole number in digits, for instance 4".to_owned(),
        "number too large to fit in target type" => {
            format!("expected a whole number of at most {}", u64::MAX)
        }
        _ => reason.split_once(" is not in ").map_or_else(
            || reason.to_owned(),
            |(_, range)| match range.split_once("..") {
                Some((low, high)) if high.trim_start_matches('=').len() > 12 => {
                    format!("expected a whole number of at least {low}")
                }
                Some((low, high)) => format!("expected a whole number from {low} to {}", high.trim_start_matches('=')),
                None => reason.to_owned(),
            },
        ),
    }
}

/// The number of a value that ends in a unit.
fn alone(value: &str) -> Option<&str> {
    let end = value.rfind(|c: char| c.is_ascii_digit() || c == '.').filter(|_| value.is_ascii())? + 1;
    let unit = value.find(|c: char| c.is_ascii_alphabetic() || c == '%')?;
    let number = value[..unit.min(end)].trim_end();
    number.parse::<f64>().is_ok().then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_value_is_joined_to_its_option_and_nothing_else_is() {
        let words = |text: &str| joined(text.split(' ').map(OsString::from)).join(&OsString::from(" "));
        for (given, wanted) in [
            ("run --dt -0.005", "run --dt=-0.005"),
            ("modify a --trim -1,5 --as-is", "modify a --trim=-1,5 --as-is"),
            ("run --scale-to -.1g", "run --scale-to=-.1g"),
            ("run --dt -inf", "run --dt=-inf"),
            ("run --json -", "run --json -"),
            ("run --json - --dt -1", "run --json - --dt=-1"),
            ("run --dt=-1 -2", "run --dt=-1 -2"),
            ("run -- --dt -1", "run -- --dt -1"),
            ("run -h", "run -h"),
        ] {
            assert_eq!(words(given), wanted);
        }
    }

    #[test]
    fn refusals_are_in_plain_words() {
        for (value, reason, wanted) in [
            ("0,005", "invalid float literal", "the decimal sign is a point: write 0.005"),
            ("24.2cm/s", "invalid float literal", "write the number alone, 24.2, in the unit that --help names"),
            ("7 m/s2", "invalid float literal", "write the number alone, 7, in the unit that --help names"),
            ("abc", "invalid float literal", "expected a number, for instance 0.005"),
            ("abc", "invalid digit found in string", "expected a whole number in digits, for instance 4"),
            ("0", "0 is not in 1..18446744073709551615", "expected a whole number of at least 1"),
            ("9", "9 is not in 1..=5", "expected a whole number from 1 to 5"),
            ("x", "no such thing", "no such thing"),
        ] {
            assert_eq!(remedy(value, reason), wanted);
        }
    }
}
