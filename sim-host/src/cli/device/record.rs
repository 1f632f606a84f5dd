//! A test run, and its telemetry saved.

use super::calibration::say_overdue;
use super::{failed, page, proof, setup};
use crate::cli::checked::Checked;
use crate::cli::output::{Outputs, print};
use crate::cli::reference::resampled;
use crate::cli::unseen::say_unseen;
use crate::cli::{Failure, progress};
use crate::device::{Kept, PROOF_TEST, Port, Recorder, RecorderError, Session, TestRunner};
use crate::files::Unfinished;
use serde_json::{Value, json};
use shakedown_core::link::{Setup, Source};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest test that is attended, ms.
const DAY: u128 = 86_400_000;

/// How long is listened before what came goes to the disk.
const SLICE: Duration = Duration::from_millis(200);

/// `device run`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown device --port /dev/ttyACM0 run reference.csv --out run/      the device takes its reference through the link
  shakedown device --port /dev/ttyACM0 run --seconds 60 --out run/       its reference, or in guard mode the existing
                                                                         controller's command, is at its converter

Ctrl-C fades the test out, disarms and saves what was heard; a second one leaves the device as it is, and what was heard in
recording.part.csv.")]
pub(super) struct Run {
    /// The reference, streamed: text with a header line, columns `time` (s) and `reference` (m), as `shakedown run --trace`
    /// writes.
    #[arg(value_name = "FILE", required_unless_present = "seconds")]
    file: Option<PathBuf>,
    /// Runs a test from the analogue input, for so long, s.
    #[arg(long, value_name = "S", conflicts_with_all = ["file", "column"])]
    seconds: Option<f64>,
    /// The column with the reference.
    #[arg(long, value_name = "NAME", default_value = "reference")]
    column: String,
    /// Writes this setup first.
    #[arg(long, value_name = "SETUP.toml")]
    setup: Option<PathBuf>,
    #[command(flatten)]
    checked: Checked,
    /// Folder for `recording.csv` and `experiment.toml`; `recording.part.csv` while they come in.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Does not ask for the day's proof test (`commission --daily`); a rehearsal never does.
    #[arg(long)]
    without_proof_test: bool,
    #[command(flatten)]
    outputs: Outputs,
}

/// What a run plays, what that is counted in, and how many of them there are.
struct Planned {
    drive: TestRunner,
    what: &'static str,
    total: u64,
}

impl Run {
    pub(super) fn run(&self, session: &mut Session<Port>) -> Result<(), Failure> {
        self.checked.fresh(self.file.as_deref())?;
        let setup = match &self.setup {
            Some(file) => setup::read(file)?,
            None => session.setup().map_err(failed)?,
        };
        say_unseen(&setup.control);
        let Planned { mut drive, what, total } = self.planned(&setup)?;
        if !self.without_proof_test && setup.wiring.source != Source::Rehearsal {
            proof::asked(Path::new(PROOF_TEST))?;
            say_overdue(session)?;
        }
        let mut recorder = Recorder::begin(&self.out, &setup, Kept::Run).map_err(unkept)?;
        let bar = progress::bar(total, what);
        let unfinished = Unfinished::begin();
        let mut lost = None;
        let ended = session.drive(&mut drive, |drive, gone| {
            bar.set_position(u64::from(gone));
            // A test that is recorded no more is ended.
            lost = lost.take().or_else(|| recorder.take(&drive.take_rows()).err());
            if lost.is_some() || unfinished.asked_to_end() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        bar.finish_and_clear();
        if let Some(error) = lost {
            return Err(Failure::Work(format!("the test was ended, for its recording could not go on: {error}")));
        }
        recorder.take(&drive.take_rows()).map_err(unkept)?;
        let missing: u32 = drive.telemetry().gaps().iter().map(|gap| gap.records).sum();
        let how = json!({ "points": self.file.is_some().then_some(total), "asked_to_end": unfinished.asked_to_end(),
                          "ended": ended.as_ref().err().map(ToString::to_string), "records": recorder.rows(),
                          "missing": missing, "dropped": drive.telemetry().dropped() });
        self.keep(recorder, how)?;
        ended.map_err(failed)
    }

    /// A run of what the device listens to; a record that it would not play, or a test without one, is refused.
    fn planned(&self, setup: &Setup) -> Result<Planned, Failure> {
        let new = self.setup.is_some().then_some(*setup);
        match (&self.file, self.seconds, setup.wiring.source) {
            (Some(file), _, Source::Streamed | Source::Rehearsal) => {
                let record = resampled(file, &self.column, f64::from(setup.control.rate))?;
                believed(file, &record, setup)?;
                let total = record.len() as u64;
                Ok(Planned { drive: TestRunner::new(new, record), what: "points", total })
            }
            (None, Some(seconds), Source::Analog) => {
                let time =
                    Duration::try_from_secs_f64(seconds).ok().filter(|time| (1..=DAY).contains(&time.as_millis()));
                let wrong = || Failure::Input(format!("--seconds {seconds}: between 0.001 and 86400, please"));
                let total = time.ok_or_else(wrong)?.as_millis() as u64;
                Ok(Planned { drive: TestRunner::attended(new, total), what: "ms", total })
            }
            (Some(file), _, Source::Analog) => Err(Failure::Input(format!(
                "{}: the device takes its reference from its converter and would not play it; set `wiring.source = \"streamed\"` in \
                 its setup, or play the record into the converter and give `--seconds`",
                file.display()
            ))),
            (None, _, Source::Streamed | Source::Rehearsal) => Err(Failure::Input(
                "--seconds: the device takes its reference through the link; give a FILE with one, or set \
                 `wiring.source = \"analog\"` in its setup"
                    .into(),
            )),
            (None, None, Source::Analog) => Err(Failure::Input("--seconds: how long?".into())),
        }
    }

    /// Puts the recording in its place, and says so beside `how` it went.
    fn keep(&self, recorder: Recorder, how: Value) -> Result<(), Failure> {
        let records = recorder.rows();
        let experiment = recorder.end().map_err(unkept)?;
        let recording = experiment.as_ref().map(|path| path.with_file_name("recording.csv"));
        let early = if how["asked_to_end"] == true { " until the end was asked for" } else { "" };
        let place = experiment.map_or_else(|| "nothing is written".into(), |path| format!("in {}", path.display()));
        let missing = how["missing"].clone();
        let ended = how["ended"].as_str().unwrap_or(if early.is_empty() { "as it was to" } else { "early, as asked" });
        let said = [
            ("ended", ended.to_owned()),
            ("records", records.to_string()),
            ("records missing", missing.to_string()),
            ("records dropped by the device", how["dropped"].to_string()),
        ];
        let mut page = page::facts("A test on a device", "What the device recorded of a test.", &said);
        page.sections.push(page::figures(recording.as_deref()));
        self.outputs.write_json(how, self.file.as_slice())?;
        self.outputs.write_report(&mut page, self.file.as_slice())?;
        if !self.outputs.quiet() {
            print(&format!("{records} records{early}, {place}; {missing} missing\n"));
        }
        Ok(())
    }
}

/// Refuses a record that the device would refuse in the middle of its test.
fn believed(file: &Path, record: &[f32], setup: &Setup) -> Result<(), Failure> {
    let (rate, farthest) = (setup.control.rate, setup.control.ranges.reference);
    let Some(k) = record.iter().position(|x| x.is_nan() || x.abs() > farthest) else { return Ok(()) };
    Err(Failure::Input(format!(
        "{}: {} m at {:.3} s is beyond the {farthest} m that the device believes of a reference: widen control.ranges.reference in its \
         setup, or fit the record to the stroke with `modify`",
        file.display(),
        record[k],
        k as f32 / rate
    )))
}

/// What keeps a recording from being kept: a place that the command line named.
fn unkept(error: RecorderError) -> Failure {
    match error {
        RecorderError::Left(_) => Failure::Input(error.to_string()),
        RecorderError::File { .. } => Failure::Work(error.to_string()),
    }
}

/// `device listen`.
#[derive(Debug, clap::Args)]
pub(super) struct Listen {
    /// How long, s.
    #[arg(long, value_name = "S", default_value_t = 5.0)]
    seconds: f64,
    /// Folder for `recording.csv` and `experiment.toml`; `recording.part.csv` while they come in.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

impl Listen {
    pub(super) fn run(&self, session: &mut Session<Port>) -> Result<(), Failure> {
        let time = Duration::try_from_secs_f64(self.seconds).map_err(|e| Failure::Input(format!("--seconds: {e}")))?;
        let setup = session.setup().map_err(failed)?;
        let mut recorder = Recorder::begin(&self.out, &setup, Kept::All).map_err(unkept)?;
        let bar = progress::bar(time.as_millis() as u64, "ms");
        let unfinished = Unfinished::begin();
        let begun = Instant::now();
        while begun.elapsed() < time && !unfinished.asked_to_end() {
            let heard = session.listen(SLICE.min(time.saturating_sub(begun.elapsed()))).map_err(failed)?;
            recorder.take(heard.rows()).map_err(unkept)?;
            bar.set_position(begun.elapsed().as_millis() as u64);
        }
        bar.finish_and_clear();
        let records = recorder.rows();
        let silent = || Failure::Work("no telemetry came: is `telemetry_every` 0 in the setup?".into());
        let path = recorder.end().map_err(unkept)?.ok_or_else(silent)?;
        print(&format!("{records} records, in {}\n", path.display()));
        Ok(())
    }
}
