//! A motion for a required spectrum within a table's limits, or the frequencies that no motion within them reaches.

use super::judged::{self, Answer};
use super::output::{Outputs, print, print_table};
use super::required::Demanded;
use super::written::Plan;
use super::written::provenance::{self, Fact};
use super::{Failure, present, progress};
use crate::motion::fit::Limits;
use crate::motion::qualify::attain::{Attained, Unreachable, Way, attain_from};
use crate::motion::qualify::{QualifyError, ScoredModel, Standard};
use crate::motion::{Motion, STANDARD_GRAVITY};
use crate::report::{Item, Page, Section, Table as Rows};
use serde_json::json;
use std::path::{Path, PathBuf};

/// What is looked for, and where what is found goes.
pub(crate) struct Sought<'a> {
    /// Which command looks.
    pub(crate) command: &'static str,
    /// The motion begins from this one, whose character it keeps where it can.
    pub(crate) record: Option<Motion>,
    pub(crate) demanded: Demanded,
    pub(crate) limits: Limits,
    pub(crate) seed: u64,
    /// Where the drive goes, and in which form.
    pub(crate) out: Option<(&'a Path, Plan)>,
    /// Where the drive comes from and what it is for.
    pub(crate) facts: Vec<Fact>,
    /// The files read.
    pub(crate) inputs: Vec<PathBuf>,
    pub(crate) outputs: &'a Outputs,
}

impl Sought<'_> {
    /// Looks for the motion, writes it, or says why there is none.
    pub(crate) fn seek(&self) -> Result<(), Failure> {
        let asked = self.demanded.requirement();
        let bar = progress::spinner(format!("looking for a motion for {}", asked.standard.id));
        let found = attain_from(self.record.as_ref(), asked, &self.limits, self.seed);
        bar.finish_and_clear();
        match found.map_err(|e: QualifyError| self.failed(&e.to_string()))? {
            Attained::Motion { motion, way, judged, lost } => self.attained(&motion, way, judged, &lost),
            Attained::Impossible(proof) => self.impossible(&proof),
            Attained::Open { margin, broken, .. } => self.open(margin, &broken),
        }
    }

    fn failed(&self, why: &str) -> Failure {
        Failure::Work(format!("{}: {why}", self.command))
    }

    fn attained(&self, motion: &Motion, way: Way, judged: ScoredModel, lost: &[&str]) -> Result<(), Failure> {
        let Demanded { standard, required, lowest } = self.demanded.clone();
        let mut drive = Vec::new();
        if let Some((path, plan)) = &self.out {
            drive = plan.write(self.command, path, motion, self.facts(way, &judged))?;
        }
        let (x, v) = motion.peaks_between();
        let (acceleration, dt) = (motion.acceleration.clone(), motion.dt);
        let answer = Answer { name: way.name().to_owned(), standard, required, judged, acceleration, dt, lowest };
        let mut page = judged::page(&answer);
        page.lead = format!("{} {}", page.lead, self.kept(way, (v, x), lost));
        if !self.outputs.quiet() {
            print(&format!("{}\n\n", page.lead));
            present::print_section(&judged::rules(&answer));
        }
        let mut json = judged::value(&answer);
        if let Some(object) = json.as_object_mut() {
            object.insert("outcome".into(), "attained".into());
            object.insert("way".into(), way.name().into());
            object.insert("peak_velocity".into(), v.into());
            object.insert("peak_displacement".into(), x.into());
            object.insert("limits".into(), named(&self.limits));
            object.insert("record_breaks".into(), lost.into());
        }
        self.outputs.write_json(json, &self.inputs)?;
        page.provenance.extend(drive.into_iter().map(|(key, value)| (format!("drive: {key}"), value)));
        self.outputs.write_report(&mut page, &self.inputs)
    }

    /// What of the limits a motion takes, and what has become of the record.
    fn kept(&self, way: Way, (v, x): (f64, f64), lost: &[&str]) -> String {
        let stroke = self.limits.stroke.unwrap_or(f64::INFINITY);
        let lost = if lost.is_empty() {
            String::new()
        } else {
            let lost = lost.join(", ");
            format!(
                " Nothing of the record is in it: corrected for the spectrum and within the limits it breaks {lost}."
            )
        };
        let name = way.name();
        format!(
            "Within the table's limits by {name}: {v:.3} of {} m/s, {x:.4} of {stroke} m.{lost}",
            self.limits.velocity
        )
    }

    /// Where the drive comes from and what it keeps.
    fn facts(&self, way: Way, judged: &ScoredModel) -> Vec<Fact> {
        let mut facts = self.facts.clone();
        facts.push(("method".to_owned(), way.name().to_owned()));
        facts.extend(provenance::limits(&self.limits));
        facts.push(("margin".into(), format!("{:.6}", judged.margin)));
        facts
    }

    fn open(&self, margin: f64, broken: &[&str]) -> Result<(), Failure> {
        let text = format!(
            "no motion within the limits was found that satisfies {}, and none is proven not to exist: the best reaches {:.1} % at its \
             worst frequency and breaks {}",
            self.demanded.standard.title,
            100.0 * margin,
            broken.join(", ")
        );
        let json = json!({ "outcome": "open", "margin": margin, "broken": broken, "limits": named(&self.limits) });
        self.outputs.write_json(json, &self.inputs)?;
        Err(self.failed(&text))
    }

    fn impossible(&self, proof: &[Unreachable]) -> Result<(), Failure> {
        let standard = &self.demanded.standard;
        let (table, lead) = (unreachable(proof), beyond(standard, proof));
        if !self.outputs.quiet() {
            print_table(&table);
        }
        let of = |u: &Unreachable| json!({ "frequency_hz": u.frequency, "required": u.required, "bound": u.bound, "limit": u.limit });
        let unreachable = proof.iter().map(of).collect::<Vec<_>>();
        let json = json!({ "outcome": "impossible", "unreachable": unreachable, "limits": named(&self.limits) });
        self.outputs.write_json(json, &self.inputs)?;
        let sections = vec![Section { heading: "Proof".into(), items: vec![Item::Table(table)] }];
        let title = format!("{}: beyond the table", standard.id);
        self.outputs
            .write_report(&mut Page { title, lead: lead.clone(), sections, ..Page::default() }, &self.inputs)?;
        Err(self.failed(&lead))
    }
}

/// The frequencies, each with its bound.
fn unreachable(proof: &[Unreachable]) -> Rows {
    let rows = proof.iter().map(|u| vec![place(u.frequency), g(u.required), g(u.bound), u.limit.into()]);
    Rows {
        caption: "Frequencies that no motion within the limits reaches, however long and of whatever shape".into(),
        columns: ["frequency", "required at least [g]", "bound [g]", "by its limit"].map(String::from).into(),
        rows: rows.collect(),
    }
}

/// An acceleration, in g.
fn g(acceleration: f64) -> String {
    format!("{:.3}", acceleration / STANDARD_GRAVITY)
}

/// A frequency, or none.
fn place(frequency: f64) -> String {
    if frequency.is_finite() { format!("{frequency:.2} Hz") } else { "zero period".into() }
}

/// The worst of them in a sentence.
fn beyond(standard: &Standard, proof: &[Unreachable]) -> String {
    let worst = proof.iter().min_by(|a, b| (a.bound / a.required).total_cmp(&(b.bound / b.required)));
    worst.map_or_else(String::new, |u| {
        format!(
            "No motion within the table's limits satisfies {}: at {} {} g is required and {} g is the most that any reaches.",
            standard.title,
            place(u.frequency),
            g(u.required),
            g(u.bound)
        )
    })
}

fn named(limits: &Limits) -> serde_json::Value {
    limits
        .named()
        .into_iter()
        .map(|(name, value)| (name.to_owned(), json!(value)))
        .collect::<serde_json::Map<_, _>>()
        .into()
}
