//! A record streamed, and telemetry saved.

use super::{failed, setup};
use crate::cli::output::{Outputs, print, write_whole};
use crate::cli::{Failure, progress};
use serde_json::json;
use shakedown::device::{Drive, Port, Row, Session, Telemetry, csv, experiment};
use shakedown::recording::file;
use shakedown_core::link::Setup;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// `device run`.
#[derive(Debug, clap::Args)]
pub(super) struct Run {
    /// The reference: text with a header line, columns `time` (s) and `reference` (m), as `shakedown run --trace` writes.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The column with the reference.
    #[arg(long, value_name = "NAME", default_value = "reference")]
    column: String,
    /// Writes this setup first.
    #[arg(long, value_name = "SETUP.toml")]
    setup: Option<PathBuf>,
    /// Folder for `recording.csv` and `experiment.toml`.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    outputs: Outputs,
}

impl Run {
    pub(super) fn run(&self, session: &mut Session<Port>) -> Result<(), Failure> {
        let new = self.setup.as_deref().map(setup::read).transpose()?;
        let setup = new.map_or_else(|| session.setup().map_err(failed), Ok)?;
        let record = resampled(&self.file, &self.column, f64::from(setup.control.rate))?;
        let points = record.len() as u64;
        let bar = progress::bar(points, "points");
        let mut drive = Drive::new(new, record);
        let ended = session.drive(&mut drive, |sent| bar.set_position(u64::from(sent)));
        bar.finish_and_clear();
        let telemetry = drive.telemetry();
        let rows: Vec<Row> = telemetry.run().copied().collect();
        save(&self.out, &rows, telemetry.rows(), &setup)?;
        let missing: u32 = telemetry.gaps().iter().map(|gap| gap.records).sum();
        let value = json!({ "points": points, "records": rows.len(), "missing": missing,
                            "dropped": telemetry.dropped(), "ended": ended.as_ref().err().map(ToString::to_string) });
        self.outputs.write_json(value, std::slice::from_ref(&self.file))?;
        if !self.outputs.quiet() {
            print(&format!(
                "{} records of {points} ticks in {}; {missing} missing\n",
                rows.len(),
                self.out.join("experiment.toml").display()
            ));
        }
        ended.map_err(failed)
    }
}

/// `device listen`.
#[derive(Debug, clap::Args)]
pub(super) struct Listen {
    /// How long, s.
    #[arg(long, value_name = "S", default_value_t = 5.0)]
    seconds: f64,
    /// Folder for `recording.csv` and `experiment.toml`.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

impl Listen {
    pub(super) fn run(&self, session: &mut Session<Port>) -> Result<(), Failure> {
        let time = Duration::try_from_secs_f64(self.seconds).map_err(|e| Failure::Input(format!("--seconds: {e}")))?;
        let setup = session.setup().map_err(failed)?;
        let telemetry: Telemetry = session.listen(time).map_err(failed)?;
        save(&self.out, telemetry.rows(), telemetry.rows(), &setup)
    }
}

/// Saves `rows` as a recording, with the noise that `all` that was sent shows.
fn save(folder: &Path, rows: &[Row], all: &[Row], setup: &Setup) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|e| Failure::Work(format!("{}: {e}", folder.display())))?;
    write_whole(&folder.join("recording.csv"), csv(rows, setup, setup.telemetry_every).as_bytes())?;
    let name = folder.file_name().map_or_else(|| "device".into(), |name| name.to_string_lossy().into_owned());
    write_whole(&folder.join("experiment.toml"), experiment(&name, "recording.csv", setup, all).as_bytes())
}

/// The reference at the device's rate, m, by straight lines between its samples.
pub(super) fn resampled(path: &Path, column: &str, rate: f64) -> Result<Vec<f32>, Failure> {
    let table = file::read(path, &["time", column]).map_err(|e| Failure::Input(e.to_string()))?;
    let [time, reference] = table.columns.as_slice() else {
        return Err(Failure::Input(format!("{}: no columns `time` and `{column}`", path.display())));
    };
    let rising = time.windows(2).all(|pair| pair[0] < pair[1]);
    let (Some(&first), Some(&last)) = (time.first(), time.last()) else {
        return Err(Failure::Input(format!("{}: no samples", path.display())));
    };
    if !rising || !reference.iter().all(|x| x.is_finite()) {
        let why = "its time must rise from sample to sample, and its reference be numbers";
        return Err(Failure::Input(format!("{}: {why}", path.display())));
    }
    let ticks = ((last - first) * rate).round() as usize + 1;
    let mut at = 0;
    let points = (0..ticks).map(|tick| {
        let t = (first + tick as f64 / rate).min(last);
        while at + 2 < time.len() && time[at + 1] <= t {
            at += 1;
        }
        let Some((&after, &to)) = time.get(at + 1).zip(reference.get(at + 1)) else { return reference[at] as f32 };
        let share = (t - time[at]) / (after - time[at]);
        (reference[at] + share * (to - reference[at])) as f32
    });
    Ok(points.collect())
}
