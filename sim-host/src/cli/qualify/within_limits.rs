//! A motion for a required spectrum within a table's limits, or the frequencies that no motion within them reaches.

use super::super::described::Found;
use super::super::failure::within;
use super::super::output::{print, print_table, sha256};
use super::super::written::{Shape, provenance};
use super::super::{described, present};
use super::{Answer, Args, page, value};
use crate::cli::Failure;
use serde_json::json;
use shakedown::motion::fit::Limits;
use shakedown::motion::qualify::attain::{Attained, Unreachable, attain_from};
use shakedown::motion::qualify::{Judged, QualifyError, Required, Standard};
use shakedown::motion::{Motion, STANDARD_GRAVITY};
use shakedown::report::{Item, Page, Section, Table as Rows};
use std::path::PathBuf;

/// The table's limits, as options.
#[derive(Debug, Clone, Default, clap::Args)]
#[group(skip)]
pub(super) struct Kept {
    /// The motion keeps this speed, m/s [default: the table's].
    #[arg(long, value_name = "M/S", requires = "synthesise")]
    velocity: Option<f64>,
    /// The motion keeps this displacement to either side, m [default: the table's, else 0.12].
    #[arg(long, value_name = "M", requires = "synthesise")]
    stroke: Option<f64>,
    /// The motion keeps this acceleration, m/s2.
    #[arg(long, value_name = "M/S2", requires = "synthesise")]
    acceleration: Option<f64>,
    /// Load at which the flow stalls, as table acceleration, m/s2: the motion keeps v^2 / V^2 + |a| / stall below 1.
    #[arg(long, value_name = "M/S2", requires = "synthesise")]
    stall: Option<f64>,
    /// The table's file, which states what the options do not.
    #[arg(long, value_name = "TABLE.toml", requires = "synthesise")]
    table: Option<PathBuf>,
    /// The motion begins from this record, whose character it keeps where it can.
    #[arg(long, value_name = "FILE", requires = "synthesise")]
    from: Option<PathBuf>,
    #[command(flatten)]
    pub(super) shape: Shape,
}

impl Kept {
    /// True where the motion is to keep limits.
    pub(super) fn asked(&self) -> bool {
        let numbers = [self.velocity, self.stroke, self.acceleration, self.stall];
        self.table.is_some() || self.from.is_some() || numbers.iter().any(Option::is_some)
    }

    fn limits(&self) -> Result<(Limits, Found), Failure> {
        let described = described::found(self.table.as_deref())?;
        let twin = crate::cli::table(described.path.as_deref())?;
        let velocity = self.velocity.unwrap_or_else(|| twin.velocity_limit());
        let stroke = self.stroke.or(described.table.stroke).unwrap_or(described::STROKE);
        within("--velocity", velocity, 1e-3, 20.0, "m/s")?;
        within("--stroke", stroke, 1e-4, 5.0, "m")?;
        within("--acceleration", self.acceleration.unwrap_or(1.0), 1e-2, 1e3, "m/s2")?;
        within("--stall", self.stall.unwrap_or(1.0), 1e-1, 1e5, "m/s2")?;
        let limits = Limits {
            acceleration: self.acceleration.or(described.table.acceleration),
            jerk: described.table.jerk,
            stall: self.stall.or_else(|| twin.stall()),
            ..Limits::table(velocity, stroke)
        };
        Ok((limits, described))
    }
}

/// Looks for the motion, writes it, or says why there is none.
pub(super) fn run(args: &Args, standard: Standard, required: Required, lowest: f64) -> Result<(), Failure> {
    let (limits, described) = args.within.limits()?;
    let inputs: Vec<PathBuf> = described.path.iter().chain(&args.within.from).chain(&args.rrs).cloned().collect();
    let plan = args.synthesise.as_deref().map(|path| {
        let mut shape = args.within.shape.clone();
        shape.described(path, &described.table);
        shape.plan("--synthesise", path, limits.stroke.unwrap_or(described::STROKE))
    });
    let plan = plan.transpose()?;
    let record = args.within.from.as_ref().map(|path| args.read(path)).transpose()?.map(|record| record.motion());
    let bar = crate::cli::progress::spinner(format!("looking for a motion for {}", standard.id));
    let found = attain_from(record.as_ref(), &standard, &required, lowest, &limits, args.seed.unwrap_or(1));
    bar.finish_and_clear();
    match found.map_err(|e: QualifyError| Failure::Work(format!("qualify: {e}")))? {
        Attained::Motion { motion, way, judged } => {
            let way = way.name();
            if let (Some(path), Some(plan)) = (&args.synthesise, &plan) {
                plan.write("qualify", path, &motion, facts(args, &standard, way, &judged, &limits)?)?;
            }
            attained(args, &motion, way, judged, (standard, required, lowest), &limits, &inputs)
        }
        Attained::Impossible(proof) => impossible(args, &standard, &proof, &limits, &inputs),
        Attained::Open { margin, broken, .. } => {
            let text = format!(
                "no motion within the limits was found that satisfies {}, and none is proven not to exist: the best reaches {:.1} % at its \
                 worst frequency and breaks {}",
                standard.title,
                100.0 * margin,
                broken.join(", ")
            );
            let json = json!({ "outcome": "open", "margin": margin, "broken": broken, "limits": named(&limits) });
            args.outputs.write_json(json, &inputs)?;
            Err(Failure::Work(format!("qualify: {text}")))
        }
    }
}

fn named(limits: &Limits) -> serde_json::Value {
    limits
        .named()
        .into_iter()
        .map(|(name, value)| (name.to_owned(), json!(value)))
        .collect::<serde_json::Map<_, _>>()
        .into()
}

/// Where the drive comes from and what it keeps.
fn facts(
    args: &Args,
    standard: &Standard,
    way: &str,
    judged: &Judged,
    limits: &Limits,
) -> Result<Vec<(String, String)>, Failure> {
    let made = format!("generated for {}", standard.title);
    let mut facts = provenance::source(args.within.from.as_deref(), made, args.seed)?;
    let mut put = |key: &str, value: String| facts.push((key.to_owned(), value));
    if let Some(path) = &args.rrs {
        put("required_spectrum_sha256", sha256(path)?);
    }
    put("method", way.to_owned());
    provenance::limits(limits).for_each(|(key, value)| put(&key, value));
    put("margin", format!("{:.6}", judged.margin));
    Ok(facts)
}

fn attained(
    args: &Args,
    motion: &Motion,
    way: &str,
    judged: Judged,
    (standard, required, lowest): (Standard, Required, f64),
    limits: &Limits,
    inputs: &[PathBuf],
) -> Result<(), Failure> {
    let (x, v) = motion.peaks_between();
    let name = way.to_owned();
    let answer =
        Answer { name, standard, required, judged, acceleration: motion.acceleration.clone(), dt: motion.dt, lowest };
    let mut page = page::page(&answer);
    let kept = format!(
        "Within the table's limits by {way}: {v:.3} of {} m/s, {x:.4} of {} m.",
        limits.velocity,
        limits.stroke.unwrap_or(f64::INFINITY)
    );
    page.lead = format!("{} {kept}", page.lead);
    if !args.outputs.quiet() {
        print(&format!("{}\n\n", page.lead));
        present::print_section(&page::rules(&answer));
    }
    let mut json = value(&answer);
    if let Some(object) = json.as_object_mut() {
        object.insert("outcome".into(), "attained".into());
        object.insert("way".into(), way.into());
        object.insert("peak_velocity".into(), v.into());
        object.insert("peak_displacement".into(), x.into());
        object.insert("limits".into(), named(limits));
    }
    args.outputs.write_json(json, inputs)?;
    args.outputs.write_report(&mut page, inputs)
}

fn impossible(
    args: &Args,
    standard: &Standard,
    proof: &[Unreachable],
    limits: &Limits,
    inputs: &[PathBuf],
) -> Result<(), Failure> {
    let g = |a: f64| format!("{:.3}", a / STANDARD_GRAVITY);
    let rows = proof.iter().map(|u| {
        let frequency = if u.frequency.is_finite() { format!("{:.2}", u.frequency) } else { "zero period".into() };
        vec![frequency, g(u.required), g(u.bound), u.limit.into()]
    });
    let table = Rows {
        caption: "Frequencies that no motion within the limits reaches, however long and of whatever shape".into(),
        columns: ["frequency [Hz]", "required at least [g]", "bound [g]", "by its limit"].map(String::from).into(),
        rows: rows.collect(),
    };
    let worst = proof.iter().min_by(|a, b| (a.bound / a.required).total_cmp(&(b.bound / b.required)));
    let lead = worst.map_or_else(String::new, |u| {
        format!(
            "No motion within the table's limits satisfies {}: at {:.2} Hz {} g is required and {} g is the most that any reaches.",
            standard.title,
            u.frequency,
            g(u.required),
            g(u.bound)
        )
    });
    if !args.outputs.quiet() {
        print_table(&table);
    }
    let of = |u: &Unreachable| json!({ "frequency_hz": u.frequency, "required": u.required, "bound": u.bound, "limit": u.limit });
    let json = json!({ "outcome": "impossible", "unreachable": proof.iter().map(of).collect::<Vec<_>>(), "limits": named(limits) });
    args.outputs.write_json(json, inputs)?;
    let sections = vec![Section { heading: "Proof".into(), items: vec![Item::Table(table)] }];
    let title = format!("{}: beyond the table", standard.id);
    args.outputs.write_report(&mut Page { title, lead: lead.clone(), sections, ..Page::default() }, inputs)?;
    Err(Failure::Work(format!("qualify: {lead}")))
}
