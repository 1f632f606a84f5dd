//! A sheet: parts, the nets of their pins, what is tried on it and what must come of it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::Deserialize;

use super::list::Item;
use crate::shell::Problem;

/// Largest error of a level, as a share of the output's span.
const LEVEL: f64 = 0.005;
/// Codes of the board's converter.
const CODES: f64 = 4096.0;

/// What a part is, by which it is drawn and simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Kind {
    /// Pins: either.
    #[serde(rename = "R")]
    Resistor,
    /// Pins: either.
    #[serde(rename = "C")]
    Capacitor,
    /// Pins: anode, cathode.
    #[serde(rename = "D")]
    Diode,
    /// Pins: non-inverting, inverting, output, positive and negative supply.
    OpAmp,
    /// Pins: drain, gate, source.
    Mosfet,
    /// Pins: either.
    Coil,
    /// Pins: common, contact when energised, contact at rest.
    Changeover,
    /// Pins: either; closed at rest.
    BreakContact,
    /// Any number of pins.
    Terminal,
}

impl Kind {
    /// How many pins it has; none where any number will do.
    const fn pins(self) -> Option<usize> {
        match self {
            Self::Resistor | Self::Capacitor | Self::Diode | Self::Coil | Self::BreakContact => Some(2),
            Self::Mosfet | Self::Changeover => Some(3),
            Self::OpAmp => Some(5),
            Self::Terminal => None,
        }
    }

    const fn has_value(self) -> bool {
        matches!(self, Self::Resistor | Self::Capacitor | Self::Coil)
    }
}

/// One part.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Part {
    /// Its name on the sheet.
    #[serde(rename = "ref")]
    pub(super) name: String,
    /// What is bought; nothing for a further contact of a part that is listed already.
    pub(super) item: String,
    pub(super) kind: Kind,
    /// Ohm or farad.
    #[serde(default)]
    pub(super) value: f64,
    /// As a share.
    #[serde(default)]
    pub(super) tolerance: f64,
    /// Name of its SPICE model.
    #[serde(default)]
    pub(super) model: String,
    /// The net of each pin.
    pub(super) pins: Vec<String>,
    /// Place on the drawing, grid units.
    pub(super) at: [i32; 2],
    /// Quarter turns, clockwise.
    #[serde(default)]
    pub(super) turn: u8,
}

/// What drives a sheet from outside: a voltage behind a resistance, and a wire that can break.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Stimulus {
    pub(super) nets: [String; 2],
    /// Smallest and largest resistance of the source, ohm.
    pub(super) ohm: [f64; 2],
}

/// What is looked at.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Output {
    pub(super) net: String,
    /// From one end of its range to the other, V.
    pub(super) span: f64,
    /// Resistance to ground of what is connected, ohm; 0 for none.
    #[serde(default)]
    pub(super) load: f64,
}

/// Corner of the filter from a stimulus to the output.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FilterCorner {
    pub(super) stimulus: String,
    /// About which voltage, V.
    #[serde(default)]
    pub(super) volts: f64,
    pub(super) hertz: f64,
    /// As a share.
    pub(super) within: f64,
}

/// A rail of the converter, which the guard takes for no reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Rail {
    Bottom,
    Top,
}

/// A voltage between two nets, V.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Between {
    pub(super) nets: [String; 2],
    from: f64,
    to: f64,
}

/// What is tried, and what must come of it: a level at the output, a rail, or a voltage between two nets.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Trial {
    pub(super) name: String,
    /// Stimuli that are not 0 V.
    #[serde(default)]
    pub(super) set: BTreeMap<String, f64>,
    /// Stimuli whose wire is broken.
    #[serde(default)]
    pub(super) broken: Vec<String>,
    /// Two nets that are shorted.
    pub(super) short: Option<[String; 2]>,
    /// Relays that are energised.
    #[serde(default)]
    pub(super) energised: Vec<String>,
    volts: Option<f64>,
    sees: Option<Rail>,
    pub(super) between: Option<Between>,
}

impl Trial {
    /// Why `answer` (V) is not what must come of it.
    pub(super) fn breach(&self, output: &Output, answer: f64) -> Option<String> {
        let half = 0.5 * output.span / CODES;
        let holds = match (self.volts, self.sees, &self.between) {
            (Some(volts), None, None) => (answer - volts).abs() <= LEVEL * output.span,
            (None, Some(Rail::Top), None) => answer >= output.span - half,
            (None, Some(Rail::Bottom), None) => answer <= half,
            (None, None, Some(between)) => (between.from..=between.to).contains(&answer),
            _ => return Some("one of `volts`, `sees` and `between` says what must come of it".into()),
        };
        (!holds).then(|| format!("{answer:.4} V"))
    }

    /// What all runs came to, in words.
    pub(super) fn spread(&self, output: &Output, answers: &[f64]) -> String {
        let (low, high) = ends(answers);
        let level = |volts: f64| {
            let farthest = answers.iter().map(|answer| (answer - volts).abs()).fold(0.0, f64::max);
            format!(", at most {:.2} % of the span off", 100.0 * farthest / output.span)
        };
        let rail = |rail| format!(", beyond the {}", if rail == Rail::Top { "top" } else { "bottom" });
        let said = self.volts.map(level).or_else(|| self.sees.map(rail)).unwrap_or_default();
        format!("{low:.4} to {high:.4} V{said}")
    }
}

/// Smallest and largest.
pub(super) fn ends(numbers: &[f64]) -> (f64, f64) {
    numbers.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
}

/// The sheet.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sheet {
    #[serde(skip)]
    pub(super) name: String,
    pub(super) title: String,
    pub(super) parts: Vec<Part>,
    /// Volts and their tolerance, as a share, by net.
    #[serde(default)]
    pub(super) supplies: BTreeMap<String, [f64; 2]>,
    pub(super) stimuli: BTreeMap<String, Stimulus>,
    pub(super) output: Output,
    pub(super) corner: Option<FilterCorner>,
    pub(super) trials: Vec<Trial>,
}

impl Sheet {
    /// The sheet `name` of `folder`.
    pub(super) fn read(folder: &Path, name: &str) -> Result<Self, Problem> {
        let path = folder.join(format!("{name}.toml"));
        let fail = |e: String| Problem::Failed(format!("{}: {e}", path.display()));
        let text = std::fs::read_to_string(&path).map_err(|e| fail(e.to_string()))?;
        let sheet: Self = toml::from_str(&text).map_err(|e| fail(e.to_string()))?;
        Ok(Self { name: name.to_owned(), ..sheet })
    }

    /// What is wrong with it.
    pub(super) fn mistakes(&self, items: &BTreeMap<String, Item>) -> Vec<String> {
        let mut wrong = Vec::new();
        let mut names = BTreeSet::new();
        for part in &self.parts {
            if !names.insert(&part.name) {
                wrong.push(format!("there are two {}", part.name));
            }
            if !part.item.is_empty() && !items.contains_key(&part.item) {
                wrong.push(format!("{}: no item `{}`", part.name, part.item));
            }
            if part.kind.pins().is_some_and(|pins| pins != part.pins.len()) {
                wrong.push(format!("{}: {} pins", part.name, part.pins.len()));
            }
            if part.kind.has_value() != (part.value > 0.0) {
                wrong.push(format!("{}: a value of {}", part.name, part.value));
            }
        }
        wrong.extend(self.loose_nets().into_iter().map(|net| format!("net {net} ends nowhere")));
        wrong.extend(self.unknown().into_iter().map(|name| format!("a trial speaks of `{name}`, which is not there")));
        wrong.into_iter().map(|what| format!("{}: {what}", self.name)).collect()
    }

    /// Nets with one pin and nothing from outside.
    fn loose_nets(&self) -> Vec<&str> {
        let mut pins: BTreeMap<&str, usize> = BTreeMap::new();
        let outside = self.stimuli.values().flat_map(|stimulus| &stimulus.nets).chain(self.supplies.keys());
        for net in self.parts.iter().flat_map(|part| &part.pins).chain(outside) {
            *pins.entry(net).or_default() += 1;
        }
        pins.into_iter().filter(|&(net, count)| net != "0" && count < 2).map(|(net, _)| net).collect()
    }

    /// Names in trials that are none of the sheet's.
    fn unknown(&self) -> Vec<&str> {
        let net = |net: &str| net == "0" || self.parts.iter().any(|part| part.pins.iter().any(|pin| pin == net));
        let part = |name: &str| self.parts.iter().any(|part| part.name == name);
        let mut unknown = Vec::new();
        for trial in &self.trials {
            let stimuli = trial.set.keys().chain(&trial.broken).filter(|name| !self.stimuli.contains_key(*name));
            unknown.extend(stimuli.map(String::as_str));
            unknown.extend(trial.energised.iter().filter(|name| !part(name)).map(String::as_str));
            let nets = trial.short.iter().flatten().chain(trial.between.iter().flat_map(|between| &between.nets));
            unknown.extend(nets.filter(|name| !net(name)).map(String::as_str));
        }
        unknown
    }
}
