//! The proposal as a commented experiment.

use super::columns::{Choice, Facts, unused};
use super::control::Loop;
use crate::files::layout::Stated;
use crate::recording::channel::Channel;
use crate::recording::inner_loop::{Closure, InnerLoop, Term};
use std::fmt::Write as _;
use std::path::Path;

/// What the user must settle.
pub(super) fn open_questions(choices: &[Choice], control: Option<&Loop>, unusable: &[String]) -> Vec<String> {
    let has = |channel: Channel| choices.iter().any(|c| c.channel == channel);
    let mut open: Vec<String> = choices
        .iter()
        .filter(|c| c.doubtful)
        .map(|c| format!("confirm the column and the unit of {}", c.channel))
        .collect();
    open.extend_from_slice(unusable);
    if !has(Channel::Time) {
        open.push("no column rises evenly: give the sampling step in [channels] time".to_owned());
    }
    if !has(Channel::Displacement) && !has(Channel::Acceleration) {
        open.push("no column could be named as a measured motion: give displacement or acceleration".to_owned());
    }
    if control.is_none() && has(Channel::Reference) {
        open.push(
            "no plain controller reproduces the command: state the loop that ran in [[runs]] controller".to_owned(),
        );
    }
    if !is_balance(choices, control) {
        open.push(
            "replace the model's parameters by your table's; those in `fit` are estimated from the data".to_owned(),
        );
    }
    open
}

/// The whole text.
pub(super) fn experiment(
    folder: &Path,
    files: &[String],
    left_out: &[(String, String)],
    facts: &[Facts],
    choices: &[Choice],
    control: Option<&Loop>,
    open: &[String],
) -> String {
    let name = folder.canonicalize().ok().and_then(|p| p.file_name().map(|n| n.to_string_lossy().into_owned()));
    let mut text = String::from(
        "# Proposed by `shakedown init` from the recordings beside it. Every proposal gives its evidence.\n",
    );
    if !open.is_empty() {
        text.push_str("#\n# Settle before you believe any result:\n");
    }
    for question in open {
        let _ = writeln!(text, "#   - {question}");
    }
    let _ = writeln!(text, "\nname = {:?}\n", name.unwrap_or_else(|| "experiment".to_owned()));
    model(&mut text, facts, choices, control);
    channels(&mut text, facts, choices);
    runs(&mut text, files, left_out, choices, control);
    text
}

/// The servo model's parameters, commented out or not.
const SERVO: [&str; 6] = [
    "kind = \"servo\"             # or \"rigid-mass\" (Eq. 1), where the command is a force",
    "b1 = 0.69                  # 1/s per m of command",
    "b0 = 138.0                 # 1/s2 per m of command",
    "a1 = 57.65                 # 1/s",
    "# velocity_limit = 0.242   # m/s; without it the model has no limit",
    "fit = [\"b1\", \"b0\", \"a1\"]",
];
const NOT_YOURS: &str =
    "# Starting values of the paper's table (Eq. 7), NOT yours; `fit` estimates them from the data.";

/// Whether a force balance is proposed. A loop that is not known cannot be simulated, and without it a command's smallest error
/// drifts away: where there is a pressure, the measured motion has to explain it.
fn is_balance(choices: &[Choice], control: Option<&Loop>) -> bool {
    let has = |channel: Channel| choices.iter().any(|c| c.channel == channel && c.unit.is_some());
    let balanced = has(Channel::PressureDifference) && has(Channel::Displacement);
    !is_driven(choices) || (control.is_none() && balanced)
}

/// Whether something that drives the table was recorded.
fn is_driven(choices: &[Choice]) -> bool {
    choices.iter().any(|c| matches!(c.channel, Channel::Reference | Channel::Command))
}

fn model(text: &mut String, facts: &[Facts], choices: &[Choice], control: Option<&Loop>) {
    text.push_str("[model]\n");
    if !is_balance(choices, control) {
        let [kind, values @ ..] = SERVO;
        let lines = [&[kind, NOT_YOURS], &values[..]].concat();
        let _ = writeln!(text, "{}\n", lines.join("\n"));
        return;
    }
    let driven = is_driven(choices);
    let why = if driven { "the loop is not known" } else { "neither reference nor command" };
    let _ = writeln!(
        text,
        "kind = \"force-balance\"     # {why}: the pressure is explained by the motion\n\
         viscous = 0.0              # 1/s\n\
         bandwidth_hz = {:.1}        # both sides low-passed, zero phase\n\
         fit = [\"viscous\"]",
        bandwidth(facts, choices)
    );
    if driven {
        let servo = SERVO.join("\n#   ");
        let _ = writeln!(text, "# Once the loop is stated in [[runs]], the servo model explains more:\n#   {servo}");
    }
    text.push('\n');
}

/// Frequency (Hz) to which a pressure is explained: a fifth of the sampling rate, and no more than a table's oil lets through.
fn bandwidth(facts: &[Facts], choices: &[Choice]) -> f64 {
    let time = choices.iter().find(|c| c.channel == Channel::Time);
    let step = time.and_then(|c| Some(facts[c.column].step? * c.unit?.factor));
    step.map_or(MOST_EXPLAINED, |step| (0.2 / step).clamp(1.0, MOST_EXPLAINED))
}

/// Highest frequency (Hz) that a rigid table with its load is asked to explain.
const MOST_EXPLAINED: f64 = 40.0;

fn channels(text: &mut String, facts: &[Facts], choices: &[Choice]) {
    text.push_str("[channels]\n");
    for choice in choices {
        let mark = if choice.doubtful { "# CONFIRM: " } else { "# " };
        let _ = writeln!(text, "{mark}{}", choice.evidence.join("; "));
        let column = toml_string(&facts[choice.column].heading.name);
        let _ = match choice.unit {
            Some(unit) => writeln!(text, "{} = {{ column = {column}, unit = {:?} }}", choice.channel, unit.symbol),
            None => writeln!(
                text,
                "# {} = {{ column = {column}, unit = \"?\" }}   # the unit could not be told",
                choice.channel
            ),
        };
    }
    if !choices.iter().any(|c| c.channel == Channel::Time) {
        text.push_str("# No column rises evenly. Give the sampling step:\n# time = { step = 0.001, unit = \"s\" }\n");
    }
    let unused: Vec<&Facts> = unused(facts, choices).collect();
    if !unused.is_empty() {
        text.push_str("# Columns that are not used:\n");
    }
    for fact in unused {
        let _ = writeln!(text, "#   {} ({:.5} to {:.5})", fact.heading.text, fact.range.0, fact.range.1);
    }
    text.push('\n');
}

fn runs(
    text: &mut String,
    files: &[String],
    left_out: &[(String, String)],
    choices: &[Choice],
    control: Option<&Loop>,
) {
    text.push_str("# No run says `use`, so some are held out to judge by: the last quarter of several runs, the last third of one.\n");
    for file in files {
        let _ = writeln!(text, "[[runs]]\nfile = {}", toml_string(file));
        match control {
            Some(law) => {
                let percent = 100.0 * law.error;
                let _ = writeln!(
                    text,
                    "controller = {}   # reproduces the command of the first run within {percent:.2} %",
                    law.text
                );
            }
            None if choices.iter().any(|c| c.channel == Channel::Command) => {
                text.push_str("# no controller is stated: the recorded command drives the model\n");
            }
            None => text.push_str("# controller = { kp = ?, ki = ? }   # state the loop that ran\n"),
        }
        text.push('\n');
    }
    for (name, reason) in left_out {
        let reason = reason.replace('\n', " ");
        let _ = writeln!(text, "# left out: {name}: {reason}");
    }
}

/// The inner loop that was identified, as a comment; what a hard-wired one asks of the experiment.
pub(super) fn inner_loop(text: &mut String, found: &InnerLoop) {
    let _ = writeln!(text, "# inner loop found in the first run: {}", found.describe());
    let (k, lag) = (found.gain(Term::Error), found.lag);
    if found.closure == Closure::Hardwired && lag > 0.0 {
        let a1 = 1.0 / lag;
        let _ = writeln!(
            text,
            "#   closed in hardware: name the command's column as `reference` (one metre is {:.5} of it), write controller = {{ kp = 1.0 }},\n\
             #   and begin the model at b1 = 0.0, b0 = {:.4}, a1 = {a1:.4}",
            found.scale,
            k * a1
        );
    }
}

/// A string as TOML writes it.
fn toml_string(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// What the texts' layout was stated to be, which reading them again takes, and what was found of it.
pub(super) fn layout(text: &mut String, stated: &Stated, notes: &[String]) {
    for note in notes {
        let _ = writeln!(text, "# found in the first file: {note}");
    }
    if stated.is_empty() {
        return;
    }
    text.push_str("\n[text]                     # as stated when this was proposed\n");
    if let Some(lines) = stated.skip_lines {
        let _ = writeln!(text, "skip_lines = {lines}");
    }
    if let Some(delimiter) = stated.delimiter {
        let _ = writeln!(text, "delimiter = \"{}\"", delimiter.name());
    }
    if let Some(decimal) = stated.decimal {
        let _ = writeln!(text, "decimal = \"{}\"", decimal.name());
    }
    if let Some(units) = &stated.units {
        let quoted: Vec<String> = units.iter().map(|unit| toml_string(unit)).collect();
        let _ = writeln!(text, "units = [{}]", quoted.join(", "));
    }
}
