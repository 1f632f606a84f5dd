//! What is written of a fit: the drive's provenance, which holds everything that it follows from.

use super::super::Failure;
use super::super::asked;
use super::super::output::sha256;
use super::super::written::Plan;
use super::Args;
use shakedown::motion::Record;
use shakedown::motion::fit::answer::Answer;
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
    plan.write("modify", path, &answer.modified.motion, provenance(args, record, answer, inputs)?)
}

/// Where a drive comes from and what it is.
fn provenance(
    args: &Args,
    record: &Record,
    answer: &Answer,
    inputs: &[PathBuf],
) -> Result<Vec<(String, String)>, Failure> {
    let mut facts: Vec<(String, String)> = Vec::new();
    let mut put = |key: &str, value: String| facts.push((key.to_owned(), value));
    if let Some(path) = inputs.first() {
        put("source", path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned()));
        put("source_sha256", sha256(path)?);
    } else {
        put("source", format!("generated {}", record.name));
        put("seed", args.seed.unwrap_or(1).to_string());
    }
    if !record.component.is_empty() {
        put("component", record.component.clone());
    }
    put("conditioning", answer.conditioning.clone());
    put("method", answer.method_name());
    for (name, limit) in answer.limits.named() {
        if let Some(limit) = limit {
            put(&format!("limit_{name}"), format!("{limit}"));
        }
    }
    let (_, _, a) = answer.modified.motion.peaks();
    let (x, v) = answer.modified.motion.peaks_between();
    put("peak_displacement_m", format!("{x:.6}"));
    put("peak_velocity_m_per_s", format!("{v:.6}"));
    put("peak_acceleration_m_per_s2", format!("{a:.6}"));
    put("e_a", format!("{:.6}", answer.compared.fitted.e_a.ratio));
    put("command_line", asked::line());
    put("version", env!("CARGO_PKG_VERSION").into());
    put("written", asked::utc());
    Ok(facts)
}
