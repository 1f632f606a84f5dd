//! `shakedown device`: a connected device's setup, runs, telemetry and commissioning.

mod asking;
mod calibration;
mod commission;
mod page;
mod proof;
mod record;
mod setup;

use super::output::{Outputs, print};
use super::{Failure, described};
use crate::device::{PROOF_TEST, Port, Session, SessionError};
use clap::Subcommand;
use serde_json::json;
use shakedown_core::link::{HostRequest, Report, Source};
use std::path::{Path, PathBuf};

/// Talks to a device over its serial line: setup, a record, telemetry, commissioning.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown device list
  shakedown device --port /dev/ttyACM0 status
  shakedown device --port /dev/ttyACM0 get --out setup.toml
  shakedown device --port /dev/ttyACM0 set setup.toml --save
  shakedown device --port /dev/ttyACM0 run reference.csv --out run/
  shakedown device --port /dev/ttyACM0 run --seconds 60 --out run/
  shakedown diagnose run/experiment.toml
  shakedown device --port /dev/ttyACM0 commission --out commissioning.toml
  shakedown device --port /dev/ttyACM0 commission --daily
  shakedown device --port /dev/ttyACM0 commission --calibrate")]
pub(crate) struct Args {
    /// The serial port [default: the one that table.toml of this folder states].
    #[arg(long, value_name = "PORT", global = true)]
    port: Option<PathBuf>,
    /// Bits a second.
    #[arg(long, value_name = "BAUD", default_value_t = 1_000_000, global = true)]
    baud: u32,
    #[command(subcommand)]
    action: Action,
}

/// What is wanted of the device.
#[derive(Debug, Subcommand)]
enum Action {
    /// Serial ports that a device may be on.
    List(Outputs),
    /// Shows device identity and health.
    Status(Outputs),
    /// Reads its setup, as TOML.
    Get(setup::Get),
    /// Writes a setup, whole or not at all.
    Set(setup::Set),
    /// Runs a test, streamed or from the analogue input; its telemetry is a recording that `diagnose` reads.
    Run(record::Run),
    /// Saves telemetry without a run.
    Listen(record::Listen),
    /// Fades a running test out and holds the table.
    Stop,
    /// Trips: the safe ramp, then the relay opens.
    Trip,
    /// Walks through the first steps of the commissioning guide and records what was measured.
    Commission(commission::Commission),
}

/// Does what is asked.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if let Action::List(outputs) = &args.action {
        return list(outputs);
    }
    let path = match &args.port {
        Some(port) => port.clone(),
        None => described::found(None)?.table.port.ok_or_else(|| {
            Failure::Input(
                "--port PORT: which port is the device on? `shakedown device list` shows what there is".into(),
            )
        })?,
    };
    let open = Port::open(&path, args.baud);
    let port = open.map_err(|e| {
        Failure::Input(format!("{}: {e}; `shakedown device list` shows the ports there are", path.display()))
    })?;
    let mut session = Session::new(port);
    match &args.action {
        // Answered above: it takes no port.
        Action::List(outputs) => list(outputs),
        Action::Status(outputs) => status(&mut session, outputs),
        Action::Get(get) => get.run(&mut session),
        Action::Set(set) => set.run(&mut session),
        Action::Run(run) => run.run(&mut session),
        Action::Listen(listen) => listen.run(&mut session),
        Action::Stop => session.order(&HostRequest::Stop).map_err(failed),
        Action::Trip => session.order(&HostRequest::Trip).map_err(failed),
        Action::Commission(walk) if walk.calibrate => calibration::walk(&mut session, Path::new(calibration::FILE)),
        Action::Commission(walk) if walk.daily => proof::walk(&mut session, Path::new(PROOF_TEST)),
        Action::Commission(walk) => walk.run(&mut session),
    }
}

/// The serial ports that there are, by the names that stay the same where the system gives them.
fn ports() -> Vec<PathBuf> {
    let of = |folder: &str, keep: &dyn Fn(&str) -> bool| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.filter(|e| keep(&e.file_name().to_string_lossy())).map(|e| e.path()).collect()
    };
    let serial = |name: &str| ["ttyACM", "ttyUSB", "cu.usb"].iter().any(|start| name.starts_with(start));
    let mut ports = [of("/dev/serial/by-id", &|_| true), of("/dev", &serial)].concat();
    ports.sort();
    ports
}

fn list(outputs: &Outputs) -> Result<(), Failure> {
    let ports = ports();
    outputs.write_json(json!({ "ports": ports }), &[])?;
    let rows: Vec<(&str, String)> = ports.iter().map(|port| ("port", port.display().to_string())).collect();
    outputs.write_report(&mut page::facts("Serial ports", "Ports that a device may be on.", &rows), &[])?;
    if !outputs.quiet() {
        let lines: Vec<String> = ports.iter().map(|port| format!("{}\n", port.display())).collect();
        let none = "no serial port is there: is the device plugged in, and may this user read /dev/ttyACM*?\n";
        print(&if lines.is_empty() { none.to_owned() } else { lines.concat() });
    }
    Ok(())
}

/// A conversation's end as the command's.
fn failed(error: SessionError) -> Failure {
    Failure::Work(error.to_string())
}

/// What a rehearsal's status says.
const REHEARSES: &str = "a simulated table; the relay stays open, and nothing that is wired to the device moves";

fn status(session: &mut Session<Port>, outputs: &Outputs) -> Result<(), Failure> {
    let identity = session
        .ask(&HostRequest::Identify, |report| if let Report::Identity(who) = report { Some(*who) } else { None });
    let identity = identity.map_err(failed)?;
    let vitals = session.vitals().map_err(failed)?;
    let rehearsal = session.setup().map_err(failed)?.wiring.source == Source::Rehearsal;
    let [major, minor, patch] = identity.firmware;
    let firmware = format!("{major}.{minor}.{patch}");
    let cause = vitals.cause.map(|cause| format!("{cause:?}"));
    let value = json!({
        "firmware": firmware, "state": vitals.state, "cause": cause, "ticks": vitals.ticks, "dropped": vitals.dropped,
        "garbled": vitals.garbled, "stored": vitals.stored, "buffered": vitals.buffered,
        "highest_rate_hz": identity.highest_rate, "clock": identity.clock, "rehearsal": rehearsal,
    });
    outputs.write_json(value, &[])?;
    let stored = if vitals.stored { "as stored in flash" } else { "not stored: a reset loses it" };
    let said = [
        ("firmware", firmware.clone()),
        ("state", format!("{:?}", vitals.state)),
        ("last cause", cause.clone().unwrap_or_else(|| "none".into())),
        ("ticks since its reset", vitals.ticks.to_string()),
        ("records of telemetry dropped", vitals.dropped.to_string()),
        ("frames garbled", vitals.garbled.to_string()),
        ("setup", stored.to_owned()),
        ("highest control rate [Hz]", identity.highest_rate.to_string()),
        ("clock", format!("{:?}", identity.clock)),
        ("what moves", if rehearsal { REHEARSES.to_owned() } else { "what is wired to it".to_owned() }),
    ];
    outputs.write_report(&mut page::facts("Device", "Device identity and health.", &said), &[])?;
    if !outputs.quiet() {
        if rehearsal {
            print(&format!("REHEARSAL: {REHEARSES}\n"));
        }
        print(&format!(
            "firmware {firmware}, {:?}{}\n{} ticks since its reset; {} records of telemetry dropped, {} frames garbled\nsetup: {}\n",
            vitals.state,
            cause.map_or(String::new(), |cause| format!(", last cause: {cause}")),
            vitals.ticks,
            vitals.dropped,
            vitals.garbled,
            stored,
        ));
    }
    Ok(())
}
