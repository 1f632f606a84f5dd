//! What of the stated set-up a diagnosis found otherwise: as a table, in lines for a terminal, and values of the model in a sentence.

use super::super::traces;
use crate::diagnose::Diagnosis;
use crate::digits;
use crate::recording::{Doubt, SetUpFinding};
use crate::report::{Item, Section};

/// What of the stated set-up was found otherwise.
pub(super) fn section(diagnosis: &Diagnosis) -> Option<Section> {
    let rows = diagnosis.set_up.iter().map(|found| {
        let size = found.std.unwrap_or(1e-3 * found.found.abs());
        let at = |text: Option<&str>| text.unwrap_or("all").to_owned();
        vec![
            found
                .parameter
                .as_ref()
                .map_or_else(|| found.what.name().to_owned(), |p| format!("{}, {p}", found.what.name())),
            at(found.run.as_deref()),
            at(found.channel),
            found.stated.map_or_else(|| "\u{2013}".into(), digits::stated),
            digits::to(found.found, size),
            found.std.map_or_else(|| "\u{2013}".into(), |std| digits::to(std, std)),
            if found.unit == "1" { String::new() } else { found.unit.clone() },
            if found.corrected { "yes" } else { "no" }.into(),
        ]
    });
    let rows: Vec<Vec<String>> = rows.collect();
    (!rows.is_empty()).then(|| {
        let columns = ["what", "run", "channel", "stated", "found", "std", "unit", "corrected"];
        let text = "These are faults of what was stated, seen in the recordings, or found with the model where no recording shows them; the \
                    diagnosis went on with what was found where it says so.";
        let table = traces::table(&columns, rows, "Stated and found");
        Section { heading: "The set-up".into(), items: vec![Item::Text(text.into()), Item::Table(table)] }
    })
}

/// Values of the model that are not those stated, in a sentence before the answer; nothing where there are none.
pub(super) fn values(diagnosis: &Diagnosis) -> String {
    let found = diagnosis.set_up.iter().filter(|found| found.what == Doubt::ModelValue);
    let said = listed(found);
    if said.is_empty() { said } else { format!("The stated model is not this table's: {said}. ") }
}

/// Values in the place of stated ones that explain the recordings as well, in a sentence.
pub(super) fn instead(diagnosis: &Diagnosis) -> Option<String> {
    let said = listed(diagnosis.stated_values_instead.iter());
    let sentence = format!(
        "Other values of the model explain the recordings as well, with no effect: {said}. Unless the stated ones are known for certain, \
         list them in `fit`, or record a test in which they act otherwise."
    );
    (!said.is_empty()).then_some(sentence)
}

fn listed<'a>(values: impl Iterator<Item = &'a SetUpFinding>) -> String {
    let said = values.map(|found| {
        let unit = if found.unit == "1" { String::new() } else { format!(" {}", found.unit) };
        let stated = found.stated.map_or_else(String::new, |stated| format!(", stated {}", digits::stated(stated)));
        let parameter = found.parameter.as_deref().unwrap_or_default();
        format!("{parameter} is {}{unit}{stated}", digits::with_spread(found.found, found.std))
    });
    said.collect::<Vec<_>>().join("; ")
}

/// One line for each fault of the set-up, of whichever runs and channels.
pub(super) fn lines(diagnosis: &Diagnosis) -> Vec<String> {
    let alike = |a: &SetUpFinding, b: &SetUpFinding| {
        (a.what, &a.parameter, a.channel, a.corrected) == (b.what, &b.parameter, b.channel, b.corrected)
    };
    let mut groups: Vec<Vec<&SetUpFinding>> = Vec::new();
    // Values of the model stand before the answer.
    for found in diagnosis.set_up.iter().filter(|found| found.what != Doubt::ModelValue) {
        match groups.iter_mut().find(|group| group.first().is_some_and(|first| alike(first, found))) {
            Some(group) => group.push(found),
            None => groups.push(vec![found]),
        }
    }
    groups.iter().map(|group| line(group)).collect()
}

/// Findings that differ by run alone.
fn line(group: &[&SetUpFinding]) -> String {
    let (first, more) = match group {
        [] => return String::new(),
        [only] => return only.sentence(),
        [first, more @ ..] => (*first, more.len()),
    };
    let run = first.run.as_deref().unwrap_or("every run");
    let runs = if more == 1 { "run" } else { "runs" };
    format!("{}; the like in {more} other {runs} beside {run}", first.sentence())
}
