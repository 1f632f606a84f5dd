//! `shakedown design`: gains for the tracking law from a model and its uncertainty, margins first.

mod loops;

use super::failure::{self, within};
use super::output::{Outputs, print, write_whole};
use super::places::place;
use super::{Failure, present, progress};
use crate::closed_loop::design::{Demand, Design, DesignError, Spread, Table, answer, design};
use crate::closed_loop::margin::{BAND, Margins};
use crate::recording::model::Model;
use crate::report::{self, Item, Page, Section};
use std::path::{Path, PathBuf};

/// Gains for the tracking law from a model and its uncertainty: margins in every corner first, refusal where none are safe.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown design table.toml --out settings.toml       table.toml: what `identify --out` writes
  shakedown design table.toml --spread 0.2 --gain-margin 8 --report design.html

A parameter that the model states an interval for is as uncertain as that; every other one by
--spread, each way. The less a model leaves open, the less of the sensors' noise the law lets through.
settings.toml is what `shakedown run` (settings = ...) and the device take.")]
pub(crate) struct Args {
    /// The model: `[model]` of kind servo, with its effects.
    #[arg(value_name = "MODEL.toml")]
    model: PathBuf,
    /// Writes the settings.
    #[arg(long, value_name = "FILE", value_parser = place())]
    out: Option<PathBuf>,
    /// Relative uncertainty, each way, of gain, pole, mass and supply where the model states no interval.
    #[arg(long, value_name = "SHARE", default_value_t = 0.3)]
    spread: f64,
    /// Gain margin to keep in every corner, dB.
    #[arg(long, value_name = "DB", default_value_t = 6.0)]
    gain_margin: f64,
    /// Phase margin to keep in every corner, degrees.
    #[arg(long, value_name = "DEGREES", default_value_t = 30.0)]
    phase_margin: f64,
    /// Control rate, Hz.
    #[arg(long, value_name = "HZ", default_value_t = 1000.0)]
    rate: f64,
    #[command(flatten)]
    outputs: Outputs,
}

/// Designs, states the margins, writes the settings.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let refuse = |e: &dyn std::fmt::Display| Failure::Input(format!("{}: {e}", args.model.display()));
    for (option, value, low, high, unit) in [
        ("--spread", args.spread, 0.0, 0.95, ""),
        ("--gain-margin", args.gain_margin, 0.0, 40.0, "dB"),
        ("--phase-margin", args.phase_margin, 0.0, 90.0, "degrees"),
        ("--rate", args.rate, 200.0, 20_000.0, "Hz"),
    ] {
        within(option, value, low, high, unit)?;
    }
    let model = Model::load(&args.model).map_err(|e| failure::refused(&args.model, e, failure::MODEL))?;
    let (table, unused) = Table::from_model(&model).map_err(|e| refuse(&e))?;
    let spread = Spread::stated(&model, args.spread);
    let demand = Demand { margins: (args.gain_margin, args.phase_margin), spread, rate: args.rate };
    let bar = progress::spinner("designing".into());
    let tell = |bandwidth: f64, disturbance: f64| {
        bar.set_message(format!("feedback of {bandwidth:.1} Hz, disturbances up to {disturbance:.0} Hz"));
    };
    let found = design(&table, &demand, tell);
    bar.finish_and_clear();
    let found = found.map_err(|e| match e {
        DesignError::Unsafe { .. } => Failure::Work(format!("{}: {e}", args.model.display())),
        _ => refuse(&e),
    })?;
    let section = section(&found, &demand, &unused);
    if !args.outputs.quiet() {
        present::print_section(&section);
    }
    let settings = toml::to_string(&found.settings).map_err(|e| Failure::Work(format!("design: settings: {e}")))?;
    write(args.out.as_deref(), &settings, args.outputs.quiet())?;
    let inputs = [args.model.clone()];
    args.outputs.write_json(answer::json(&found, &demand, &unused), &inputs)?;
    if !args.outputs.draws() {
        return Ok(());
    }
    let mut page = page(&found, args, section);
    page.sections.push(loops::section(&found, &table, &demand.spread).map_err(|e| refuse(&e))?);
    args.outputs.write_report(&mut page, &inputs)
}

fn write(out: Option<&Path>, settings: &str, quiet: bool) -> Result<(), Failure> {
    match out {
        Some(path) => write_whole(path, settings.as_bytes()),
        None if quiet => Ok(()),
        None => {
            print(settings);
            Ok(())
        }
    }
}

fn frequencies(found: &Design) -> (f32, f32) {
    found.settings.tracking.map_or((0.0, 0.0), |t| (t.bandwidth, t.disturbance))
}

/// The page: the verdict, what holds in the worst corner, what to do.
fn page(found: &Design, args: &Args, section: Section) -> Page {
    let (bandwidth, disturbance) = frequencies(found);
    let worst = &found.worst;
    let written = args.out.as_ref().map_or_else(
        || "Write the settings with `--out settings.toml`, and rehearse them: a scenario with `settings = \"settings.toml\"`.".into(),
        |path| format!("Rehearse the settings, a scenario with `settings = \"{}\"`, before `shakedown device set` writes them.", path.display()),
    );
    Page {
        title: "Design".into(),
        lead: format!(
            "Feedback of {bandwidth:.1} Hz and disturbance rejection up to {disturbance:.0} Hz keep the margins asked for, {} dB and {} degrees, \
             in the worst corner of the model's uncertainty.",
            args.gain_margin, args.phase_margin
        ),
        key: vec![
            ("gain margin, worst corner".into(), format!("{:.1} dB", worst.gain_db)),
            ("phase margin, worst corner".into(), format!("{:.0} degrees", worst.phase_degrees)),
            ("crossover, worst corner".into(), format!("{:.0} Hz", worst.crossover_hz)),
        ],
        advice: vec![written],
        sections: vec![section],
        ..Page::default()
    }
}

fn section(found: &Design, demand: &Demand, unused: &[String]) -> Section {
    let (bandwidth, disturbance) = frequencies(found);
    let s = demand.spread;
    let text = format!(
        "Feedback of {bandwidth:.1} Hz, disturbance rejection up to {disturbance:.0} Hz. Uncertainty each way: gain {:.0} %, \
         pole {:.0} %, mass {:.0} %, supply {:.0} %; {} points looked at. Of a motion's acceleration, the uncertainty is \
         expected to cost {:.1} % in the worst corner and the sensors' noise {:.1} % below 15 Hz.",
        100.0 * s.gain,
        100.0 * s.pole,
        100.0 * s.mass,
        100.0 * s.supply,
        found.corners,
        100.0 * found.expected[0],
        100.0 * found.expected[1]
    );
    let row = |name: &str, of: &dyn Fn(&Margins) -> f64, digits: usize| {
        vec![name.into(), format!("{:.digits$}", of(&found.nominal)), format!("{:.digits$}", of(&found.worst))]
    };
    let band = format!("left of a disturbance, {} to {} Hz [1]", BAND.0, BAND.1);
    let rows = vec![
        row("gain margin [dB]", &|m| m.gain_db, 1),
        row("phase margin [degrees]", &|m| m.phase_degrees, 0),
        row("crossover [Hz]", &|m| m.crossover_hz, 0),
        row("largest sensitivity [1]", &|m| m.peak_sensitivity, 2),
        row(&band, &|m| m.left, 3),
    ];
    let columns = ["figure", "on the model", "worst corner"].map(String::from).to_vec();
    let table = report::Table { caption: "Margins at the valve's command".into(), columns, rows };
    let mut items = vec![Item::Text(text), Item::Table(table)];
    if !unused.is_empty() {
        items.push(Item::Note(format!("not used by the law, left to its observers: {}", unused.join(", "))));
    }
    Section { heading: "Stability first".into(), items }
}
