//! The proposed next test: on the page, and as files (a drive, a scenario that plays it on the twin, the run that takes its recording back).

use super::super::Failure;
use super::super::output::{tell, write_whole};
use super::super::traces;
use crate::diagnose::Examined;
use crate::diagnose::result::NextTest;
use crate::motion::drive::{Drive, DriveUnit, Form, Quantity};
use crate::recording::Experiment;
use crate::report::{Item, Section};
use std::fmt::Write as _;
use std::path::Path;

/// Writes them into a folder; where nothing is proposed, says so and writes nothing.
pub(super) fn write(folder: &Path, experiment: &Experiment, examined: &Examined) -> Result<(), Failure> {
    let planned = examined.diagnosis.next_test.as_ref().and_then(|test| Some((test, test.planned.as_ref()?)));
    let Some((test, planned)) = planned else {
        let why = examined.diagnosis.no_test.as_deref();
        let why = why.unwrap_or("No test is proposed: nothing is open that a run from a reference would settle");
        tell(&format!("{why}; nothing was written"));
        return Ok(());
    };
    std::fs::create_dir_all(folder).map_err(|e| Failure::Input(format!("{}: {e}", folder.display())))?;
    let quantity = Quantity::Displacement;
    let unit = DriveUnit::fixed("mm", quantity).ok_or_else(|| Failure::Work("mm is no unit of a drive".into()))?;
    let facts = vec![("source".to_owned(), format!("next test of {}: {}", experiment.name, test.record))];
    let drive = Drive { quantity, dt: planned.dt, values: planned.reference.clone(), unit, facts };
    drive.write(&folder.join("drive.csv"), Form::Csv).map_err(|e| Failure::Input(e.to_string()))?;
    write_whole(&folder.join("table.toml"), examined.augmented(&experiment.model).to_toml().as_bytes())?;
    write_whole(&folder.join("scenario.toml"), scenario(&test.record, 1.0 / planned.dt).as_bytes())?;
    let mut run = format!("# {}\n# Why: {}.\n", test.record, test.why);
    let _ = writeln!(run, "# Record it with the columns of {} as recording.csv.", experiment.path.display());
    run += "[[runs]]\nfile = \"recording.csv\"\nuse = \"fit\"\n";
    if let Some(controller) = planned.controller() {
        let _ = writeln!(run, "controller = {controller}");
    }
    write_whole(&folder.join("run.toml"), run.as_bytes())
}

fn scenario(record: &str, rate: f64) -> String {
    format!("name = {record:?}\ntable = \"table.toml\"\nrate_hz = {rate}\n\n[record]\nfile = \"drive.csv\"\n")
}

/// The test that would settle what is open.
pub(super) fn section(test: &NextTest) -> Section {
    let mut items = vec![Item::Text(format!("{}; {}.", test.record, test.why))];
    if !test.others.is_empty() {
        let rows =
            test.others.iter().map(|(record, distance)| vec![record.clone(), format!("{distance:.1}")]).collect();
        items.push(Item::Table(traces::table(
            &["test", "predicted distance [standard deviations]"],
            rows,
            "What else would do",
        )));
    }
    Section { heading: "The next test".into(), items }
}
