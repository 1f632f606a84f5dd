//! `shakedown sweep`: what the paper's diagrams show, computed.

mod bode;
mod cancellation;
mod mass;
mod saw_tooth;
mod slew_rate;
mod trade_off;

use super::Failure;
use super::output::{Outputs, print};
use super::present::{self, Part};
use super::source::Source;
use crate::closed_loop::sweep_recording;
use crate::plant::paper::Paper;
use crate::report::Page;
use clap::ValueEnum;
use std::path::PathBuf;

/// The table's diagrams: Bode curves by amplitude, the saw-tooth, gain trade-off, slew rate, feedforward cancellation.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown sweep                                  every part, at the paper's amplitudes and gains
  shakedown sweep bode --gains 3.7,0.6 --amplitudes 1,10,50 --report bode.html
  shakedown sweep slew-rate --flow 6.5 --area 240
  shakedown sweep trade-off --record kobe.AT2 --json -
  shakedown sweep --write sweeps && shakedown identify sweeps/experiment.toml")]
pub(crate) struct Args {
    /// What to compute; everything, where nothing is named.
    #[arg(value_enum)]
    parts: Vec<What>,
    /// Writes simulated sweeps at four amplitudes, with the laboratory's noise, and an experiment for `identify`; computes
    /// nothing else.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["parts", "json", "report"])]
    write: Option<PathBuf>,
    /// Seed of that noise.
    #[arg(long, value_name = "N", default_value_t = 1, requires = "write")]
    noise_seed: u64,
    #[command(flatten)]
    bode: bode::Args,
    #[command(flatten)]
    slew_rate: slew_rate::Args,
    #[command(flatten)]
    source: Source,
    #[command(flatten)]
    outputs: Outputs,
}

/// A part of the sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum What {
    /// Bode diagrams at several amplitudes (Figs. 4, 5, 10).
    Bode,
    /// The diagram with 5 t more on the table (Fig. 4).
    Mass,
    /// The saw-tooth of a sine beyond the velocity limit (Fig. 6).
    SawTooth,
    /// Tracking against saturation over the gain (Fig. 11).
    TradeOff,
    /// Both verification tests of the feedforward cancellation (Fig. 2).
    Cancellation,
    /// Largest speed from flow, pressure drop and area (Eq. 8).
    SlewRate,
}

impl What {
    /// In the order of the page.
    const ALL: [Self; 6] = [Self::Bode, Self::Mass, Self::SawTooth, Self::TradeOff, Self::Cancellation, Self::SlewRate];

    fn run(self, args: &Args) -> Result<Part, Failure> {
        match self {
            Self::Bode => bode::run(&args.bode),
            Self::Mass => mass::run(&args.bode),
            Self::SawTooth => saw_tooth::run(),
            Self::TradeOff => trade_off::run(&args.source),
            Self::Cancellation => cancellation::run(),
            Self::SlewRate => Ok(slew_rate::run(&args.slew_rate)),
        }
    }
}

impl Args {
    /// Refuses what no part takes, and what a part cannot take, before any of them is computed.
    fn check(&self) -> Result<(), Failure> {
        let wanted = |what: What| self.write.is_none() && (self.parts.is_empty() || self.parts.contains(&what));
        if let Some(option) = self.source.given().filter(|_| !wanted(What::TradeOff)) {
            return Err(Failure::Input(format!(
                "sweep: {option} is for trade-off alone: name that part, or leave {option} out"
            )));
        }
        if let Some(folder) = self.write.as_ref().filter(|folder| folder.exists() && !folder.is_dir()) {
            return Err(Failure::Input(format!("--write {}: is a file; name a folder", folder.display())));
        }
        if let Some(there) =
            self.write.as_ref().map(|folder| folder.join("experiment.toml")).filter(|file| file.exists())
        {
            return Err(Failure::Input(format!(
                "--write: {} is there already and is not written over; name another folder, or remove it",
                there.display()
            )));
        }
        if wanted(What::Bode) || wanted(What::Mass) {
            self.bode.grid()?;
            self.bode.stable()?;
        }
        if wanted(What::SlewRate) { self.slew_rate.check() } else { Ok(()) }
    }
}

/// Computes the parts asked for, prints their tables, writes `--json` and `--report`.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    args.check()?;
    if let Some(folder) = &args.write {
        let experiment = sweep_recording::write(folder, Paper::default(), args.noise_seed)
            .map_err(|e| Failure::Work(e.to_string()))?;
        print(&format!(
            "{}\n\nNext: shakedown identify {}\n",
            experiment.display(),
            super::asked::quoted(&experiment.display().to_string())
        ));
        return Ok(());
    }
    let mut page = Page { title: "Sweep".into(), ..Page::default() };
    let mut json = serde_json::Map::new();
    let wanted = What::ALL.into_iter().filter(|what| args.parts.is_empty() || args.parts.contains(what));
    let (mut inputs, mut found) = (Vec::new(), Vec::new());
    for what in wanted {
        let part = what.run(args)?;
        if !args.outputs.quiet() {
            present::print_section(&part.section);
        }
        json.insert(part.key.into(), part.json);
        inputs.extend(part.inputs);
        found.push(part.found);
        page.key.push(part.figure);
        page.sections.push(part.section);
    }
    page.lead = found.join(" ");
    args.outputs.write_json(json.into(), &inputs)?;
    args.outputs.write_report(&mut page, &inputs)
}
