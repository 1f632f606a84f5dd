//! The ground motion of a command: a file, or a generated near-field motion.

use super::Failure;
use super::failure::first_given;
use super::output::tell;
use crate::files::layout::{Decimal, Delimiter, Stated, is_unit};
use crate::motion::read::Options;
use crate::motion::{Motion, Record, STANDARD_GRAVITY, generate, peak, read};
use crate::recording::Experiment;
use std::path::{Path, PathBuf};

/// Which record, and what its file leaves out.
#[derive(Debug, Clone, Default, clap::Args)]
#[group(skip)]
pub(crate) struct Source {
    /// Ground-motion record: PEER, CSMIP, COSMOS, GeoNet, K-NET, or columns with --dt and --unit; without one, a generated
    /// near-field motion.
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    /// Sampling interval, s, where the file does not state it.
    #[arg(long, value_name = "S")]
    pub(crate) dt: Option<f64>,
    /// Unit of the acceleration, where the file does not state it: m/s2, cm/s2, mm/s2, gal or g.
    #[arg(long, value_name = "UNIT")]
    pub(crate) unit: Option<String>,
    /// Component, where the file has several: its number or a part of its name.
    #[arg(long, value_name = "NAME")]
    pub(crate) channel: Option<String>,
    #[command(flatten)]
    pub(crate) text: Text,
    /// Seed of the generated motion.
    #[arg(long, value_name = "N", conflicts_with = "record")]
    pub(crate) seed: Option<u64>,
}

/// How columns of text are laid out, as far as it is not to be found.
#[derive(Debug, Clone, Default, clap::Args)]
#[group(skip)]
pub(crate) struct Text {
    /// Columns of text: lines above the line with the names, or above the first row.
    #[arg(long, value_name = "N")]
    skip_lines: Option<usize>,
    /// Columns of text: what separates them: tab, semicolon, comma or blank.
    #[arg(long, value_name = "NAME")]
    delimiter: Option<Delimiter>,
    /// Columns of text: the decimal sign, point or comma.
    #[arg(long, value_name = "NAME")]
    decimal: Option<Decimal>,
    /// Columns of text: unit of each column in order, such as s,mm,g; empty for one without.
    #[arg(long, value_name = "UNIT,...", value_delimiter = ',', value_parser = unit)]
    units: Option<Vec<String>>,
}

/// Reads the unit of a column; empty for one without.
fn unit(text: &str) -> Result<String, String> {
    if text.is_empty() || is_unit(text) {
        return Ok(text.to_owned());
    }
    Err("is no unit; write mm, m/s2, g, V or the like, nothing for a column without".into())
}

impl Text {
    /// The same for the readers.
    pub(crate) fn stated(&self) -> Stated {
        let Self { skip_lines, delimiter, decimal, units } = self.clone();
        Stated { skip_lines, delimiter, decimal, units }
    }

    /// The first option given.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let all = [
            ("--skip-lines", self.skip_lines.is_some()),
            ("--delimiter", self.delimiter.is_some()),
            ("--decimal", self.decimal.is_some()),
            ("--units", self.units.is_some()),
        ];
        first_given(all)
    }
}

impl Source {
    /// Reads or generates the record.
    pub(crate) fn load(&self) -> Result<Record, Failure> {
        let Some(path) = &self.record else {
            if let Some(option) = self.describes() {
                return Err(Failure::Input(format!("{option} describes a file: give it with --record FILE")));
            }
            return generate::NEAR_FIELD_STRONG
                .generate(self.seed.unwrap_or(1))
                .map_err(|e| Failure::Work(format!("generated motion: {e}")));
        };
        let unit = self.unit.as_deref().map(str::parse).transpose();
        let options = Options {
            dt: self.dt,
            unit: unit.map_err(|e| Failure::Input(format!("--unit: {e}")))?,
            channel: self.channel.as_deref().map_or_else(Default::default, |name| {
                let Ok(channel) = name.parse();
                channel
            }),
            text: self.text.stated(),
        };
        record(path, &options)
    }

    /// The first option given that describes a file.
    fn describes(&self) -> Option<&'static str> {
        let own = [("--dt", self.dt.is_some()), ("--unit", self.unit.is_some()), ("--channel", self.channel.is_some())];
        first_given(own).or_else(|| self.text.given())
    }

    /// The first option given, for parts of a command that take no motion.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let own = [("--record", self.record.is_some()), ("--seed", self.seed.is_some())];
        first_given(own).or_else(|| self.describes())
    }

    /// The files read.
    pub(crate) fn inputs(&self) -> Vec<PathBuf> {
        self.record.iter().cloned().collect()
    }
}

/// Reads a record; what was assumed of its layout is said.
pub(crate) fn record(path: &Path, options: &Options) -> Result<Record, Failure> {
    let record = read::record(path, options).map_err(|e| Failure::Input(e.to_string()))?;
    for fact in record.facts.iter().filter(|fact| fact.key == "layout") {
        tell(&format!("note: {}: {}", path.display(), fact.value));
    }
    Ok(record)
}

/// Says what was assumed of an experiment's recordings, and which effects begin at the library's own values.
pub(crate) fn told(experiment: &Experiment) {
    for note in &experiment.notes {
        tell(&format!("note: {note}"));
    }
    for effect in experiment.model.effects.iter().filter(|effect| effect.parameters.is_empty()) {
        tell(&format!(
            "note: {}: no parameter of {} is stated: each begins at the library's value",
            experiment.path.display(),
            effect.id
        ));
    }
}

/// Beyond these no earthquake was recorded: m/s2 and m.
const STRONGEST: f64 = 5.0 * STANDARD_GRAVITY;
const FARTHEST: f64 = 2.0;

/// Says where a motion is stronger than any that was recorded: its unit or its scale is wrong, or it is no earthquake.
pub(crate) fn plausible(place: &str, motion: &Motion) {
    let (a, x) = (peak(&motion.acceleration), peak(&motion.displacement));
    if a > STRONGEST || x > FARTHEST {
        tell(&format!(
            "warning: {place}: peaks of {:.3} g and {x:.3} m are beyond any recorded earthquake (5 g, 2 m): check the unit and the scale",
            a / STANDARD_GRAVITY
        ));
    }
}
