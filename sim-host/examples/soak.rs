//! A day in the loop: `cargo run --release -p shakedown --example soak [HOURS [FOLDER]]`.
//!
//! The core drives the paper's plant at 1 kHz through one record after another, each armed, started, now and then held, and
//! stopped; every twentieth tick goes as telemetry, in the link's own frames, through the host's end of the link to a recording
//! in FOLDER, as `shakedown device run` keeps it. The memory of the process is read after every simulated hour and must not grow after the first.
#![allow(clippy::print_stdout, reason = "what an example has to say")]

use shakedown::blocks::device::{Kept, LinkClient, Recorder, RecorderError, Telemetry};
use shakedown::blocks::faults::Motions;
use shakedown::blocks::plant::Plant as _;
use shakedown::blocks::plant::paper::{FixedStep, Paper};
use shakedown::blocks::plant::sensors::{SensorModel, Sensors};
use shakedown_core::link::{Batch, MAX_BATCH, MAX_FRAME, Record, Report, Scale, Setup, Source, Wiring, encode};
use shakedown_core::settings::{Detection, Gains, GuardSettings};
use shakedown_core::{Controller, Modification, OperatorRequest, Sample, Settings, State};
use std::error::Error;
use std::path::{Path, PathBuf};

const RATE: f64 = 1000.0;
/// Plant steps a tick.
const STEPS: usize = 4;
const EVERY: u16 = 20;
/// Largest growth after the first hour, KiB: what an allocator may keep.
const MOST: i64 = 512;

/// Resident memory of this process, KiB; zero where the system does not say.
fn resident() -> i64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|rest| rest.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}

/// Converters of which a code is a thousandth of everything.
fn wiring() -> Wiring {
    let scale = Scale { zero: 2048.0, per_code: 1e-3 };
    Wiring {
        source: Source::Streamed,
        reference: scale,
        displacement: scale,
        acceleration: scale,
        external: scale,
        output: scale,
        full_scale: 4095,
        rails_are_faults: true,
    }
}

struct Day {
    controller: Controller,
    plant: FixedStep,
    sensors: Sensors,
    velocity: f64,
    command: f64,
    tick: u64,
    batch: Batch,
    talker: LinkClient,
    telemetry: Telemetry,
    recorder: Recorder,
    tests: u64,
    trips: u64,
}

impl Day {
    fn new(folder: &Path) -> Result<Self, Box<dyn Error>> {
        let settings = Settings {
            displacement: Gains::new(8.0, 0.6),
            modification: Modification::Causal,
            anti_windup: true,
            saturation: Some(Detection::default()),
            guard: Some(GuardSettings::default()),
            ..Settings::default()
        };
        let setup = Setup { telemetry_every: EVERY, lease_ms: 0, wiring: wiring(), control: settings };
        Ok(Self {
            controller: Controller::new(&settings)?,
            plant: FixedStep::new(Paper::default(), 1.0 / (RATE * STEPS as f64), 0.0)?,
            sensors: Sensors::new(SensorModel::laboratory(1)),
            velocity: 0.0,
            command: 0.0,
            tick: 0,
            batch: Batch { first: 0, every: EVERY, state: State::Off, dropped: 0, records: heapless::Vec::new() },
            talker: LinkClient::new(),
            telemetry: Telemetry::default(),
            recorder: Recorder::begin(folder, &setup, Kept::All)?,
            tests: 0,
            trips: 0,
        })
    }

    fn tick(&mut self, reference: f64) -> Result<(), RecorderError> {
        let time = self.tick as f64 / RATE;
        let v = self.plant.velocity(self.command);
        let x = self.sensors.displacement(time, self.plant.displacement());
        let a = self.sensors.acceleration(time, (v - self.velocity) * RATE);
        self.velocity = v;
        let command = self.controller.step(&Sample::new(reference as f32, x as f32, a as f32));
        self.command = f64::from(command.valve);
        self.plant.advance(self.command, STEPS);
        if self.tick.is_multiple_of(u64::from(EVERY)) {
            let inputs = [reference, x, a, self.command].map(|value| (2048.0 + 1e3 * value) as u16);
            let flags = command.status.bits();
            let record =
                Record { reference: reference as f32, fitted: command.reference, inputs, output: inputs[3], flags };
            self.report(record)?;
        }
        self.tick += 1;
        Ok(())
    }

    /// Telemetry as the device sends it, taken in and recorded by the host's end.
    fn report(&mut self, record: Record) -> Result<(), RecorderError> {
        if self.batch.records.is_empty() {
            self.batch.first = self.tick as u32;
            self.batch.state = self.controller.state();
        }
        let _ = self.batch.records.push(record);
        if self.batch.records.len() < MAX_BATCH {
            return Ok(());
        }
        let mut wire = [0; MAX_FRAME];
        let length = encode(&Report::Telemetry(self.batch.clone()), &mut wire).unwrap_or(0);
        self.batch.records.clear();
        self.talker.hear(wire[..length].iter().copied());
        while let Some(report) = self.talker.report() {
            if let Report::Telemetry(batch) = report {
                self.telemetry.take(&batch);
            }
        }
        self.recorder.take(&self.telemetry.take_rows())
    }

    /// One test along `record` (m), brought within the table's room.
    fn test(&mut self, record: &[f64]) -> Result<(), RecorderError> {
        let peak = record.iter().fold(1e-6_f64, |most, x| most.max(x.abs()));
        let scale = (0.08 / peak).min(1.0);
        if self.controller.state() == State::Tripped {
            self.trips += 1;
            let _ = self.controller.request(OperatorRequest::Reset);
        }
        for request in [OperatorRequest::Arm, OperatorRequest::Start] {
            let _ = self.controller.request(request);
        }
        let held = self.tests.is_multiple_of(7).then_some(record.len() / 2);
        for (k, &x) in record.iter().enumerate() {
            if held.is_some_and(|at| k == at || k == at + 3000) {
                let _ = self.controller.request(if self.controller.state() == State::Hold {
                    OperatorRequest::Resume
                } else {
                    OperatorRequest::Hold
                });
            }
            self.tick(scale * x)?;
        }
        let _ = self.controller.request(OperatorRequest::Stop);
        let rest = scale * record.last().copied().unwrap_or(0.0);
        for _ in 0..3000 {
            self.tick(rest)?;
        }
        let _ = self.controller.request(OperatorRequest::Off);
        self.tests += 1;
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let hours: u64 = words.next().map_or(Ok(24), |word| word.parse())?;
    let folder = words.next().map_or_else(std::env::temp_dir, PathBuf::from);
    let motions = Motions::new(None)?;
    let folder = tempfile::tempdir_in(&folder)?;
    let mut day = Day::new(folder.path())?;
    let mut marks = Vec::new();
    println!("{:>5} {:>8} {:>7} {:>12} {:>8} {:>13}", "hour", "tests", "trips", "records", "missing", "memory [KiB]");
    while (marks.len() as u64) < hours {
        let record = &motions.all[day.tests as usize % motions.all.len()];
        day.test(&record.displacement)?;
        while day.tick as f64 / (3600.0 * RATE) >= (marks.len() + 1) as f64 {
            marks.push(resident());
            println!(
                "{:>5} {:>8} {:>7} {:>12} {:>8} {:>13}",
                marks.len(),
                day.tests,
                day.trips,
                day.recorder.rows(),
                day.telemetry.gaps().len(),
                marks[marks.len() - 1]
            );
        }
    }
    let records = day.recorder.rows();
    let path = day.recorder.end()?.map(|experiment| experiment.with_file_name("recording.csv"));
    let bytes = path.map_or(Ok(0), |path| std::fs::metadata(path).map(|file| file.len()))?;
    println!("{records} records in a recording of {bytes} byte");
    let (first, last) = (marks[0], marks[marks.len() - 1]);
    println!("growth from the first hour to the last: {} KiB, at most {MOST}", last - first);
    if last - first > MOST { Err("the memory grows".into()) } else { Ok(()) }
}
