//! Studies beside a campaign: how far the truth is from the library's own equations, and constants judged on kinds that they
//! were not fitted on.

use super::super::output::{Outputs, print_table};
use super::super::shard::Shard;
use super::super::{Failure, progress};
use super::engine::Engine;
use super::{Deal, failure, joined};
use crate::prove::campaign::{join, run};
use crate::prove::laboratory::{calibrate, independence};
use crate::prove::{Answer, Examinee};
use crate::report::Table;
use serde::Serialize;
use serde_json::{Value, json};
use std::path::Path;

/// An examinee that says nothing, so that a case costs the library's best fit alone.
struct Silent(Engine);

impl Examinee for Silent {
    fn diagnose(&self, _experiment: &Path) -> Result<Answer, String> {
        Ok(Answer { diagnosis: json!({"verdict": "consistent"}), seconds: 0.0 })
    }

    fn identify(&self, experiment: &Path) -> Option<Result<Value, String>> {
        self.0.identify(experiment)
    }

    fn version(&self) -> String {
        format!("{}, not asked", self.0.version())
    }
}

/// Fits the library's own equation to each form of a single gross effect without noise.
pub(super) fn forms(deal: &Deal, out: Option<&Path>, outputs: &Outputs) -> Result<(), Failure> {
    let scratch = tempfile::tempdir().map_err(|e| Failure::Work(format!("no temporary folder: {e}")))?;
    let folder = out.unwrap_or(scratch.path());
    let examinee = Silent(Engine::new(None)?);
    let only = Deal { stratum: vec!["single, gross".into()], ..deal.clone() };
    let plan = only.plan(Shard { number: 1, of: 1 }, examinee.version())?;
    let bar = progress::bar(plan.numbers().len() as u64, "cases");
    run(&plan, folder, &examinee, &|n| bar.inc(n)).map_err(failure)?;
    bar.finish_and_clear();
    let (plan, records) = join(folder, false).map_err(failure)?;
    let found = independence::independence(&plan, &records);
    show("shakedown.independence/1", &found, &independence::table(&found), outputs)
}

/// Fits the constants on stored evidence, and judges them on the kinds left out.
pub(super) fn constants(folder: &Path, outputs: &Outputs) -> Result<(), Failure> {
    let (_, records) = joined(folder, true)?;
    let calibrated = calibrate::calibrate(&records);
    if calibrated.stated.is_none() {
        return Err(Failure::Input(format!("{}: no case there states a probability", folder.display())));
    }
    show("shakedown.calibration/1", &calibrated, &calibrate::table(&calibrated), outputs)
}

fn show(schema: &str, value: &impl Serialize, table: &Table, outputs: &Outputs) -> Result<(), Failure> {
    let mut value = serde_json::to_value(value).map_err(|e| Failure::Work(e.to_string()))?;
    if let Some(object) = value.as_object_mut() {
        object.insert("schema".into(), schema.into());
    }
    outputs.write_json(value, &[])?;
    if !outputs.quiet() {
        print_table(table);
    }
    Ok(())
}
