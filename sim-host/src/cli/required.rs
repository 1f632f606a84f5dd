//! What a standard asks of a motion, as options: the standard, its level, or a required spectrum of one's own.

use super::Failure;
use super::failure::{first_given, within};
use super::output::sha256;
use super::written::provenance::Fact;
use crate::motion::qualify::{Code, Direction, Required, Requirement, STANDARDS, Site, Standard};
use clap::ValueEnum;
use std::path::PathBuf;

/// The options.
#[derive(Debug, Clone, Default, clap::Args)]
#[group(skip)]
pub(crate) struct Demand {
    /// The standard whose required spectrum and rules are meant; `own` is the spectrum of --rrs without further rules.
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(STANDARDS.map(|s| s.id)))]
    standard: Option<String>,
    /// AC156: design spectral acceleration at short periods, g.
    #[arg(long, value_name = "G")]
    sds: Option<f64>,
    /// AC156: height of attachment over the roof's, 0 to 1 [default: 1].
    #[arg(long, value_name = "SHARE")]
    z_over_h: Option<f64>,
    /// AC156: the building code [default: asce7-16].
    #[arg(long, value_enum)]
    code: Option<Building>,
    /// Direction of the shaking [default: horizontal].
    #[arg(long, value_enum)]
    direction: Option<Axis>,
    /// IEEE 693: the level [default: high].
    #[arg(long, value_enum)]
    level: Option<Level>,
    /// A required spectrum of your own instead of the standard's: lines of frequency (Hz) and acceleration (g).
    #[arg(long, value_name = "FILE")]
    pub(crate) rrs: Option<PathBuf>,
    /// Damping of the spectrum of --rrs, 1 [default: the standard's].
    #[arg(long, value_name = "RATIO", requires = "rrs")]
    rrs_damping: Option<f64>,
    /// Lowest natural frequency of the specimen, Hz: spectra are judged from three quarters of it on, within the standard's range.
    #[arg(long, value_name = "HZ")]
    lowest: Option<f64>,
}

/// What is asked for.
#[derive(Debug, Clone)]
pub(crate) struct Demanded {
    pub(crate) standard: Standard,
    pub(crate) required: Required,
    /// The lowest frequency that is judged, Hz.
    pub(crate) lowest: f64,
}

impl Demanded {
    /// The same as motions are made for it and judged by it.
    pub(crate) fn requirement(&self) -> Requirement<'_> {
        Requirement { standard: &self.standard, required: &self.required, lowest: self.lowest }
    }
}

/// Building codes by name.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Building {
    /// ASCE 7-16.
    #[value(name = "asce7-16")]
    Asce16,
    /// ASCE 7-22.
    #[value(name = "asce7-22")]
    Asce22,
}

/// Directions by name.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Axis {
    /// In the plane.
    Horizontal,
    /// Upright.
    Vertical,
}

/// Levels of IEEE 693.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Level {
    /// 0.25 g at zero period.
    Moderate,
    /// 0.5 g.
    High,
}

impl Demand {
    /// What is asked for; none where no standard is named.
    pub(crate) fn demanded(&self) -> Result<Option<Demanded>, Failure> {
        let Some(id) = &self.standard else { return self.without_standard().map(|()| None) };
        let standard = self.stated(id)?;
        let required = self.required(&standard)?;
        let standard = standard.for_spectrum(&required);
        let lowest = self.from(&standard)?;
        Ok(Some(Demanded { standard, required, lowest }))
    }

    /// Refuses what describes a standard's demands where none is named.
    fn without_standard(&self) -> Result<(), Failure> {
        let all = [
            ("--sds", self.sds.is_some()),
            ("--z-over-h", self.z_over_h.is_some()),
            ("--code", self.code.is_some()),
            ("--direction", self.direction.is_some()),
            ("--level", self.level.is_some()),
            ("--rrs", self.rrs.is_some()),
            ("--lowest", self.lowest.is_some()),
        ];
        match first_given(all) {
            Some(option) => Err(Failure::Input(format!(
                "{option}: says what a standard asks for: name it with --standard, one of {}",
                STANDARDS.map(|s| s.id).join(", ")
            ))),
            None => Ok(()),
        }
    }

    /// What a drive says of it.
    pub(crate) fn facts(&self, demanded: &Demanded) -> Result<Vec<Fact>, Failure> {
        let mut facts = vec![("standard".to_owned(), demanded.standard.title.to_owned())];
        if let Some(path) = &self.rrs {
            facts.push(("required_spectrum_sha256".into(), sha256(path)?));
        }
        Ok(facts)
    }

    fn stated(&self, id: &str) -> Result<Standard, Failure> {
        let standard =
            Standard::named(id).ok_or_else(|| Failure::Input(format!("--standard {id}: no such standard")))?;
        let own = |of: &str, option: &str, given: bool| {
            let wrong = given && (standard.id != of || self.rrs.is_some());
            let why = if self.rrs.is_some() { "--rrs gives the spectrum" } else { "belongs to another standard" };
            if wrong { Err(Failure::Input(format!("{option}: {why}: leave it out"))) } else { Ok(()) }
        };
        own("ac156", "--sds", self.sds.is_some())?;
        own("ac156", "--z-over-h", self.z_over_h.is_some())?;
        own("ac156", "--code", self.code.is_some())?;
        own("ieee693", "--level", self.level.is_some())?;
        if standard.id == "ac156" && self.sds.is_none() && self.rrs.is_none() {
            return Err(Failure::Input("--sds G: AC156 takes its level from the design spectral acceleration".into()));
        }
        within("--sds", self.sds.unwrap_or(1.0), 0.01, 10.0, "g")?;
        within("--z-over-h", self.z_over_h.unwrap_or(1.0), 0.0, 1.0, "")?;
        within("--rrs-damping", self.rrs_damping.unwrap_or(0.05), 1e-3, 0.5, "")?;
        within("--lowest", self.lowest.unwrap_or(1.0), 0.1, 100.0, "Hz")?;
        Ok(standard)
    }

    fn required(&self, standard: &Standard) -> Result<Required, Failure> {
        if let Some(path) = &self.rrs {
            let refuse = |e: String| Failure::Input(format!("{}: {e}", path.display()));
            let text = crate::files::bounded::text(path, 1 << 20).map_err(|e| refuse(e.to_string()))?;
            return Required::parse(&text, self.rrs_damping.unwrap_or(standard.damping)).map_err(refuse);
        }
        let site = Site {
            s_ds: self.sds.unwrap_or(1.0),
            z_over_h: self.z_over_h.unwrap_or(1.0),
            code: self.code.map_or(Code::Asce16, |code| match code {
                Building::Asce16 => Code::Asce16,
                Building::Asce22 => Code::Asce22,
            }),
            direction: self.direction.map_or(Direction::Horizontal, |axis| match axis {
                Axis::Horizontal => Direction::Horizontal,
                Axis::Vertical => Direction::Vertical,
            }),
            high: !matches!(self.level, Some(Level::Moderate)),
        };
        standard.required(&site).map_err(|e| Failure::Input(e.to_string()))
    }

    /// The lowest frequency that is judged, Hz.
    fn from(&self, standard: &Standard) -> Result<f64, Failure> {
        let Some(lowest) = self.lowest else { return Ok(standard.band.0) };
        // AC156 allows no higher beginning than 3.5 Hz.
        let from = (0.75 * lowest).min(3.5).max(standard.band.0);
        if from < standard.band.1 {
            Ok(from)
        } else {
            Err(Failure::Input(format!("--lowest {lowest}: beyond the standard's range")))
        }
    }
}
