//! `shakedown-replay`: the firmware image on an emulated processor, in the loop with the paper's table. `shakedown replay` calls it.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use shakedown::blocks::device::Progress;
use shakedown::blocks::files::write_whole;
use shakedown::blocks::report::{Axis, Item, Page, Plot, Section, Series, Style, Table};
use shakedown::recording::file;
use shakedown_core::Mode;
use shakedown_firmware::defaults;
use shakedown_replay::bench::near_field;
use shakedown_replay::seen::Seen;
use shakedown_replay::{Ran, run};

/// Runs a firmware image on an emulated STM32F4, in the loop with the paper's table, and shows what both did.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// The image, as it is flashed.
    #[arg(long, value_name = "FILE")]
    elf: PathBuf,
    /// Where the device sits in the command path.
    #[arg(long, value_enum, default_value = "controller")]
    mode: Place,
    /// The reference: text with columns `time` (s, 1 kHz) and `reference` (m); without it a generated near-field record.
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Writes the result as JSON; `-` is standard output.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Writes one HTML page that opens with no network.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Place {
    Guard,
    Modifier,
    Controller,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match replay(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err((status, message)) => {
            eprintln!("error: {message}");
            ExitCode::from(status)
        }
    }
}

type Failed = (u8, String);

fn replay(arguments: &Arguments) -> Result<(), Failed> {
    let record = match &arguments.record {
        None => near_field(20),
        Some(path) => {
            let table = file::read(path, &["time", "reference"]).map_err(|e| (2, e.to_string()))?;
            table.columns.get(1).map(|column| column.iter().map(|&x| x as f32).collect()).unwrap_or_default()
        }
    };
    let mut setup = defaults::setup();
    setup.control.mode = match arguments.mode {
        Place::Guard => Mode::Guard,
        Place::Modifier => Mode::Modifier,
        Place::Controller => Mode::Controller,
    };
    let ran = run(&arguments.elf, Seen::new(setup, record)).map_err(|e| (2, e.to_string()))?;
    let (table, json) = summary(&ran);
    if let Some(path) = &arguments.report {
        page(&ran, table.clone()).write(path).map_err(|e| (1, format!("{}: {e}", path.display())))?;
    }
    let text = serde_json::to_string_pretty(&json).map_err(|e| (1, e.to_string()))? + "\n";
    match &arguments.json {
        Some(path) if path.as_os_str() == "-" => print(&text),
        Some(path) => write_whole(path, text.as_bytes()).map_err(|e| (1, format!("{}: {e}", path.display())))?,
        None => print(&shakedown::blocks::report::terminal::table(&table, None)),
    }
    match &ran.world.progress {
        Progress::Done => Ok(()),
        Progress::Failed(error) => Err((1, error.to_string())),
        Progress::Going(points) => Err((1, format!("the run did not end; {points} points were sent"))),
    }
}

fn print(text: &str) {
    use std::io::Write as _;
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
}

/// What the run came to.
fn summary(ran: &Ran<Seen>) -> (Table, serde_json::Value) {
    let telemetry = ran.world.drive.telemetry();
    let mut costs: Vec<u64> = ran.world.instructions.windows(2).map(|pair| pair[1] - pair[0]).collect();
    costs.sort_unstable();
    let median = costs.get(costs.len() / 2).copied().unwrap_or(0);
    let missing: u32 = telemetry.gaps().iter().map(|gap| gap.records).sum();
    let facts = [
        ("ticks", ran.world.codes.len() as u64),
        ("ticks of the test", telemetry.run().count() as u64),
        ("instructions a tick, median", median),
        ("deepest stack, byte", ran.stack.deepest),
        ("records of telemetry missing", u64::from(missing)),
        ("resets", ran.resets.len() as u64),
    ];
    let rows = facts.iter().map(|(name, value)| vec![(*name).to_owned(), value.to_string()]).collect();
    let columns = vec![String::new(), "image".to_owned()];
    let json = serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"), "ticks": facts[0].1, "test_ticks": facts[1].1, "instructions_a_tick": median,
        "stack_bytes": ran.stack.deepest, "missing_records": missing, "resets": ran.resets.len(),
        "ended": format!("{:?}", ran.world.progress),
    });
    (Table { columns, rows, caption: "The image in the loop".into() }, json)
}

fn page(ran: &Ran<Seen>, table: Table) -> Page {
    let wiring = defaults::setup().wiring;
    let rows: Vec<_> = ran.world.drive.telemetry().rows().to_vec();
    let time: Vec<f64> = rows.iter().map(|row| f64::from(row.tick) / 1000.0).collect();
    let series = |name: &str, style, y: Vec<f64>| Series { name: name.into(), x: time.clone(), y, style };
    let plot = |title: &str, label: &str, series| {
        Item::Plot(Plot {
            title: title.into(),
            x: Axis { label: "time [s]".into(), ..Axis::default() },
            y: Axis { label: label.into(), ..Axis::default() },
            series,
            group: Some("run".into()),
            ..Plot::default()
        })
    };
    let displacement =
        rows.iter().map(|row| 1e3 * f64::from(wiring.displacement.to_si(row.record.inputs[1]))).collect();
    let reference = rows.iter().map(|row| 1e3 * f64::from(row.record.reference)).collect();
    let fitted = rows.iter().map(|row| 1e3 * f64::from(row.record.fitted)).collect();
    let output = rows.iter().map(|row| f64::from(row.record.output)).collect();
    let items = vec![
        Item::Table(table),
        plot(
            "Displacement",
            "displacement [mm]",
            vec![
                series("reference", Style::Dashed, reference),
                series("after modification", Style::Faint, fitted),
                series("table", Style::Line, displacement),
            ],
        ),
        plot("Output", "code", vec![series("output", Style::Line, output)]),
    ];
    let lead = "The very image that is flashed, on an emulated processor; the plant closes the loop at its converters.";
    let sections = vec![Section { heading: "Run".into(), items }];
    Page { title: "Firmware in the loop".into(), lead: lead.into(), sections, ..Page::default() }
}
