//! The next drive from what a real table made of the last one: learning run by run, with no model of the table.

use super::super::compare;
use super::super::places::file_name;
use super::super::written::Plan;
use super::super::{Failure, present};
use super::{Args, RUN, limited, page, written};
use crate::closed_loop::learning::stale::Staleness;
use crate::closed_loop::learning::{Learning, Limits, Made, Peaks, next, scored};
use crate::motion::Motion;
use crate::motion::drive::Drive;
use crate::motion::metrics::{Comparison, Played};
use crate::motion::resample::linear;
use crate::report::{Item, Page, Section, Table};
use serde_json::json;
use std::path::{Path, PathBuf};

/// A run of a real table, and what is to follow from it.
pub(super) struct Next<'a> {
    pub(super) args: &'a Args,
    pub(super) recording: &'a Path,
    pub(super) from: &'a Path,
    pub(super) drive: &'a Drive,
    pub(super) wanted: &'a Motion,
    pub(super) limits: &'a Limits,
    pub(super) how: &'a Learning,
}

/// Share of the drive that a recording holds at least.
const COVERED: f64 = 0.99;

impl Next<'_> {
    /// Finds the drive in the recording, corrects it, and writes it unless its peaks are predicted to pass a limit.
    pub(super) fn run(
        &self,
        plan: Option<&Plan>,
        mut facts: Vec<(String, String)>,
        checked: Option<&Staleness>,
        inputs: &[PathBuf],
    ) -> Result<(), Failure> {
        let found =
            compare::of_drive(self.from, &self.drive.motion(), self.recording, self.args.displacement.as_deref())?;
        if found.covered < COVERED {
            return Err(Failure::Input(format!(
                "{}: holds {:.0} % of {}: record the whole of it",
                self.recording.display(),
                100.0 * found.covered,
                self.from.display()
            )));
        }
        let seen = self.seen(&found);
        let score = scored(&seen, self.wanted).map_err(|e| Failure::Work(format!("learn: {e}")))?;
        let run = self.drive.fact(RUN).and_then(|run| run.parse().ok()).unwrap_or(1_usize).max(1);
        let mut drive = self.drive.values.clone();
        drive.resize(self.wanted.len(), drive.last().copied().unwrap_or(0.0));
        let delay = if found.reference_error.is_some() { score.e_a.delay } else { 0.0 };
        let made = Made { drive: &drive, seen: &seen, delay, run };
        let (corrected, expected) = next(&made, self.wanted, self.limits, self.how).map_err(|refusal| {
            Failure::Work(format!(
                "learn: {refusal}: nothing was written; give the record more room, by a smaller --velocity or --stroke"
            ))
        })?;
        if let (Some(path), Some(plan)) = (&self.args.out, plan) {
            limited(&mut facts, self.limits);
            facts.push(("method".into(), format!("learnt from run {run} as it was recorded")));
            facts.push((RUN.into(), (run + 1).to_string()));
            facts.push(("recording".into(), file_name(self.recording)));
            facts.push(("e_a_before".into(), format!("{:.6}", score.e_a.ratio)));
            written(path, plan, corrected, self.wanted.dt, facts)?;
        }
        self.show(run, &score, &expected, checked, inputs)
    }

    /// The table's displacement at the control rate, from the drive's beginning on, m.
    fn seen(&self, found: &Played) -> Vec<f64> {
        let (x, dt) = (&found.achieved.displacement, found.achieved.dt);
        let first = found.samples.start as f64 * dt - found.start;
        (0..self.wanted.len()).map(|k| linear(x, (k as f64 * self.wanted.dt - first) / dt)).collect()
    }

    fn show(
        &self,
        run: usize,
        score: &Comparison,
        expected: &Peaks,
        checked: Option<&Staleness>,
        inputs: &[PathBuf],
    ) -> Result<(), Failure> {
        let limits = self.limits;
        let row = |name: &str, found: f64, limit: f64| vec![name.to_owned(), format!("{found:.3}"), format!("{limit}")];
        let table = Table {
            caption: format!("Run {} as it is predicted, within the band learned", run + 1),
            columns: ["peak", "predicted", "limit"].map(String::from).into(),
            rows: vec![
                row("displacement [m]", expected.displacement, limits.displacement),
                row("velocity [m/s]", expected.velocity, limits.velocity),
                row("acceleration [m/s2]", expected.acceleration, limits.acceleration),
            ],
        };
        let lead = format!(
            "Run {run} on the table came within E_a {:.3} and E_d {:.4} of the motion wanted; run {} is predicted to keep the limits.",
            score.e_a.ratio,
            score.e_d.ratio,
            run + 1
        );
        let checks =
            "Record the check motion (`--check`) between runs: a specimen that has changed makes the drive stale.";
        let section =
            Section { heading: "The next run".into(), items: vec![Item::Note(lead.clone()), Item::Table(table)] };
        if !self.args.outputs.quiet() {
            present::print_section(&section);
        }
        let json = json!({ "run": run, "e_a": score.e_a.ratio, "e_d": score.e_d.ratio, "delay_s": score.e_a.delay,
                           "next": page::peaks(expected), "checked": checked.map(page::checked) });
        self.args.outputs.write_json(json, inputs)?;
        let title = format!("{} after {}", file_name(self.from), file_name(self.recording));
        let advice = if checked.is_none() { vec![checks.to_owned()] } else { Vec::new() };
        self.args
            .outputs
            .write_report(&mut Page { title, lead, advice, sections: vec![section], ..Page::default() }, inputs)
    }
}
