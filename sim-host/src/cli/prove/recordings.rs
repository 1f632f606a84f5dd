//! Real recordings as a second page: what the stated model holds, what was found missing, how much better it predicts.

use super::super::diagnose::failure;
use super::super::diagnose::page::{lead, parameters};
use super::super::output::{Outputs, print_table};
use super::super::traces;
use super::super::{Failure, progress};
use super::stretches::{self, Stretch};
use crate::diagnose::{Diagnosis, Options, diagnose};
use crate::digits;
use crate::recording::Experiment;
use crate::report::{Item, Page, Section, Table};
use serde_json::json;
use std::path::PathBuf;

/// One experiment, its diagnosis, and those of its parts.
struct Examined {
    experiment: Experiment,
    diagnosis: Diagnosis,
    stretches: Vec<Stretch>,
}

/// Diagnoses each experiment, and stretches of this length of it (s) where one is asked for, and shows them side by side.
pub(super) fn run(files: &[PathBuf], length: Option<f64>, outputs: &Outputs) -> Result<(), Failure> {
    if let Some(length) = length {
        super::within("--stretches", length, 2.0, 1e4, "s")?;
    }
    let bar = progress::bar(files.len() as u64, "recordings");
    let mut all = Vec::new();
    for file in files {
        let experiment = Experiment::load(file).map_err(|e| Failure::Input(e.to_string()))?;
        let diagnosis = diagnose(&experiment, &Options::default()).map_err(failure)?.diagnosis;
        let stretches = length.map_or(Ok(Vec::new()), |length| stretches::of(&experiment, &diagnosis, length))?;
        all.push(Examined { experiment, diagnosis, stretches });
        bar.inc(1);
    }
    bar.finish_and_clear();
    let inputs: Vec<PathBuf> = all.iter().flat_map(|one| one.experiment.inputs.clone()).collect();
    let of = |one: &Examined| json!({ "experiment": one.experiment.name, "diagnosis": one.diagnosis, "stretches": one.stretches });
    let value = json!({ "schema": "shakedown.recordings/1", "recordings": all.iter().map(of).collect::<Vec<_>>() });
    outputs.write_json(value, &inputs)?;
    outputs.write_report(&mut page(&all), &inputs)?;
    if !outputs.quiet() {
        tables(&all).iter().for_each(print_table);
    }
    Ok(())
}

/// Every table: what was found and how it fits, then the same by stretches where there are any.
fn tables(all: &[Examined]) -> Vec<Table> {
    let stretches: Vec<Stretch> = all.iter().flat_map(|one| one.stretches.clone()).collect();
    let mut tables = vec![found(all), fits(all)];
    if !stretches.is_empty() {
        tables.extend([stretches::table(&stretches), stretches::counts(&stretches)]);
    }
    tables
}

fn page(all: &[Examined]) -> Page {
    let said = |one: &Examined| {
        let mut items = vec![Item::Text(lead(&one.diagnosis))];
        items.extend(one.diagnosis.effects.iter().filter_map(parameters).map(Item::Table));
        if !one.diagnosis.findings.is_empty() {
            items.push(Item::Table(traces::findings(&one.diagnosis.findings)));
        }
        Section { heading: one.experiment.name.clone(), items }
    };
    let mut sections =
        vec![Section { heading: "Side by side".into(), items: tables(all).into_iter().map(Item::Table).collect() }];
    sections.extend(all.iter().map(said));
    Page {
        title: "Proof on real recordings".into(),
        lead: "Each recording was given a model that leaves out what is known to be there.".into(),
        sections,
        ..Page::default()
    }
}

/// What was stated and what was found.
fn found(all: &[Examined]) -> Table {
    let row = |one: &Examined| {
        let stated = one.experiment.model.effects.iter().map(|e| e.id.as_str());
        let kind = one.experiment.model.baseline.kind();
        let stated: Vec<&str> = std::iter::once(kind).chain(stated).collect();
        let named: Vec<&str> = one.diagnosis.effects.iter().map(|e| e.id).collect();
        let part = one.diagnosis.part_explained.as_ref();
        let part = part.map_or(String::new(), |p| format!(" ({}: {:.1} %)", p.ids.join(", "), 100.0 * p.share));
        vec![
            one.experiment.name.clone(),
            stated.join(", "),
            format!("{}{part}", named.join(", ")),
            format!("{}", one.diagnosis.findings.len()),
            format!("{:.1}", one.diagnosis.seconds),
        ]
    };
    Table {
        columns: ["Recording", "Stated", "Found missing", "Findings [1]", "Time [s]"].map(Into::into).to_vec(),
        rows: all.iter().map(row).collect(),
        ..Table::default()
    }
}

/// Fit on the hold-out runs, each channel that judges.
fn fits(all: &[Examined]) -> Table {
    let rows = all.iter().flat_map(|one| {
        let (before, after) = (&one.diagnosis.judged.before, &one.diagnosis.judged.after);
        after.r2.iter().map(|(&channel, &r2)| {
            vec![
                one.experiment.name.clone(),
                channel.to_owned(),
                digits::r2(before.r2.get(channel).copied().unwrap_or(f64::NAN)),
                digits::r2(r2),
                format!("{:.2}", 100.0 * before.nrmse.get(channel).copied().unwrap_or(f64::NAN)),
                format!("{:.2}", 100.0 * after.nrmse.get(channel).copied().unwrap_or(f64::NAN)),
            ]
        })
    });
    Table {
        columns: [
            "Recording",
            "Channel held out",
            "R2 before [1]",
            "R2 after [1]",
            "Error before [%]",
            "Error after [%]",
        ]
        .map(Into::into)
        .to_vec(),
        rows: rows.collect(),
        ..Table::default()
    }
}
