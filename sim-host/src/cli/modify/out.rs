//! What is written of a fit: the drive's provenance, which holds everything that it follows from.

use super::super::Failure;
use super::super::written::{Plan, provenance};
use super::Args;
use crate::motion::Record;
use crate::motion::fit::answer::Answer;
use std::path::PathBuf;

impl Args {
    /// What is to be written, judged before the work; none where nothing is.
    pub(super) fn plan(&self) -> Result<Option<Plan>, Failure> {
        match &self.out {
            Some(path) => self.shape.plan("--out", path, self.stroke()).map(Some),
            None => self.shape.only_with("--out").map(|()| None),
        }
    }
}

/// Writes the drive; gives what the page and the JSON say of it.
pub(super) fn write(
    args: &Args,
    plan: &Plan,
    record: &Record,
    answer: &Answer,
    inputs: &[PathBuf],
) -> Result<Vec<(String, String)>, Failure> {
    let Some(path) = &args.out else { return Ok(Vec::new()) };
    plan.write("modify", path, &answer.modified.motion, facts(args, record, answer, inputs)?)
}

/// Where a drive comes from and what it is.
fn facts(args: &Args, record: &Record, answer: &Answer, inputs: &[PathBuf]) -> Result<Vec<(String, String)>, Failure> {
    let made = format!("generated {}", record.name);
    let mut facts = provenance::source(inputs.first().map(PathBuf::as_path), made, args.seed)?;
    let mut put = |key: &str, value: String| facts.push((key.to_owned(), value));
    if !record.component.is_empty() {
        put("component", record.component.clone());
    }
    put("conditioning", answer.conditioning.clone());
    put("method", answer.method_name());
    provenance::limits(&answer.limits).for_each(|(key, value)| put(&key, value));
    let (_, _, a) = answer.modified.motion.peaks();
    let (x, v) = answer.modified.motion.peaks_between();
    put("peak_displacement_m", format!("{x:.6}"));
    put("peak_velocity_m_per_s", format!("{v:.6}"));
    put("peak_acceleration_m_per_s2", format!("{a:.6}"));
    put("e_a", format!("{:.6}", answer.compared.fitted.e_a.ratio));
    Ok(facts)
}
