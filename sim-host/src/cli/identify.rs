//! `shakedown identify`: fits a model to recordings, with error bars, and judges it on the runs held back.

use super::output::{Outputs, print, print_table, write_whole};
use super::{Failure, progress};
use serde_json::json;
use shakedown::identify::data::Run;
use shakedown::identify::fit::{Effort, Fit};
use shakedown::identify::judge::{Score, score};
use shakedown::identify::prepare::prepare;
use shakedown::identify::quantity::{Quantity, quantities, stated_with};
use shakedown::recording::Experiment;
use shakedown::recording::check::{check, is_bad_data};
use shakedown::report::{Axis, Item, Page, Plot, Section, Series, Style, Table};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Fits the parameters an experiment lists in `fit`, with intervals, and judges the model on runs held back.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown identify experiment.toml
  shakedown identify experiment.toml --out table.toml --report fit.html")]
pub(crate) struct Args {
    /// The experiment: model, channels, runs (`shakedown init` writes one).
    #[arg(value_name = "EXPERIMENT.toml")]
    experiment: PathBuf,
    /// Writes the fitted model, for `run` and `diagnose`.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    outputs: Outputs,
}

/// Fits, judges and shows.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let input = |e: &dyn std::fmt::Display| Failure::Input(e.to_string());
    let work = |e: &dyn std::fmt::Display| Failure::Work(e.to_string());
    let experiment = Experiment::load(&args.experiment).map_err(|e| input(&e))?;
    let findings = check(&experiment);
    if is_bad_data(&findings) {
        let list: Vec<String> =
            findings.iter().map(|f| format!("{}, {}: {}; {}", f.run, f.channel, f.problem, f.remedy)).collect();
        return Err(Failure::Input(format!("{}: {}", args.experiment.display(), list.join("\n"))));
    }
    let prepared = prepare(&experiment).map_err(|e| input(&e))?;
    let spinner = progress::spinner("fitting".into());
    let mut fit = Fit::begin(prepared.model.clone(), &prepared.fit).map_err(|e| work(&e))?;
    fit.improve(&prepared.fit, Effort::FULL).map_err(|e| work(&e))?;
    let judging: &[Run] = if prepared.holdout.is_empty() { &prepared.fit } else { &prepared.holdout };
    let standing = score(&fit.model, judging).map_err(|e| work(&e))?;
    spinner.finish_and_clear();
    let found: BTreeMap<String, Quantity> = quantities(&fit).into_iter().filter(|(_, q)| q.std.is_some()).collect();
    let nrmse: BTreeMap<&str, f64> = standing.nrmse.iter().map(|(c, value)| (c.name(), *value)).collect();
    let r2: BTreeMap<&str, f64> = nrmse.iter().map(|(&c, value)| (c, 1.0 - value * value)).collect();
    let value = json!({
        "parameters": found,
        "fit": { "chi2": fit.chi2(), "converged": fit.converged(), "evaluations": fit.evaluations },
        "holdout": { "chi2": standing.chi2, "nrmse": nrmse, "r2": r2 },
        "findings": findings,
    });
    args.outputs.write_json(value, &experiment.inputs)?;
    let table = table(&found);
    let mut page = page(&experiment.name, &fit, &standing, judging, table.clone());
    args.outputs.write_report(&mut page, &experiment.inputs)?;
    if let Some(path) = &args.out {
        write_whole(path, stated_with(&experiment.model, &fit).to_toml().as_bytes())?;
    }
    if !args.outputs.quiet() {
        print_table(&table);
        print(&format!("\n{}\n", page.lead));
    }
    Ok(())
}

fn table(found: &BTreeMap<String, Quantity>) -> Table {
    let rows = found.iter().map(|(name, q)| {
        let number = |x: Option<f64>| x.map_or("not determined".into(), |x| format!("{x:.5}"));
        vec![name.clone(), format!("{:.5}", q.value), number(q.std), number(q.low), number(q.high), q.unit.to_owned()]
    });
    Table {
        columns: ["parameter", "value", "std", "90 % from", "90 % to", "unit"].map(String::from).into(),
        rows: rows.collect(),
        caption: "Fitted parameters".into(),
    }
}

fn page(name: &str, fit: &Fit, standing: &Score, runs: &[Run], table: Table) -> Page {
    let mut items = Vec::new();
    for (run, predicted) in runs.iter().zip(&standing.predicted) {
        let time: Vec<f64> = (0..run.len()).map(|k| run.from + k as f64 * run.dt).collect();
        for (measured, model) in run.measured.iter().zip(&predicted.channels) {
            if model.iter().all(|v| v.is_nan()) {
                continue;
            }
            let series = |name: &str, y: Vec<f64>, style| Series { name: name.into(), x: time.clone(), y, style };
            let left = measured.values.iter().zip(model).map(|(y, m)| y - m).collect();
            let channel = measured.channel.name().replace('_', " ");
            items.push(Item::Plot(Plot {
                title: format!("{}: {channel}", run.name),
                x: Axis { label: "time [s]".into(), ..Axis::default() },
                y: Axis { label: format!("{channel} [{}]", measured.channel.unit()), ..Axis::default() },
                series: vec![
                    series("measured", measured.values.clone(), Style::Line),
                    series("model", model.clone(), Style::Dashed),
                    series("measured less model", left, Style::Faint),
                ],
                group: Some(run.name.clone()),
                ..Plot::default()
            }));
        }
    }
    let lead = format!(
        "chi2 {:.4} on the runs fitted, {:.4} on the runs that judge; the noise floor is 1.",
        fit.chi2(),
        standing.chi2
    );
    let sections = vec![
        Section { heading: "Parameters".into(), items: vec![Item::Table(table)] },
        Section { heading: "The runs that judge".into(), items },
    ];
    Page { title: format!("Identification: {name}"), lead, sections, ..Page::default() }
}
