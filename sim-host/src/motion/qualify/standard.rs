//! Standards as data: what is required, by which rules, how far each is known.

use super::super::STANDARD_GRAVITY as G;
use super::Required;

/// A standard's rules. What is `None` the standard does not ask.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standard {
    /// Its name on the command line.
    pub id: &'static str,
    /// Its title and edition.
    pub title: &'static str,
    /// What is known of it and from where.
    pub status: &'static str,
    /// Damping ratio, 1.
    pub damping: f64,
    /// Points an octave at which spectra are compared.
    pub per_octave: usize,
    /// Lowest and highest frequency, Hz.
    pub band: (f64, f64),
    /// How far a point may lie below what is required, where its neighbours do not, as a share; and how many such points.
    pub dips: Option<(f64, usize)>,
    /// Share of the required spectrum that it is advised not to exceed, and up to which frequency, Hz.
    pub ceiling: Option<(f64, f64)>,
    /// Least zero-period acceleration as a share of the required; 0 where it is no rule.
    pub zero_period: f64,
    /// Least duration, s.
    pub duration: Option<f64>,
    /// Least strong motion (5 to 95 % of the Arias intensity), s.
    pub strong: Option<f64>,
    /// Least ratio of 25 to 75 % over 5 to 95 % of the Arias intensity.
    pub strong_ratio: Option<f64>,
    /// Largest factor between a third of the strong motion and the whole of it, RMS by octaves.
    pub stationary: Option<f64>,
    /// Largest correlation of two axes, at any shift up to half a second.
    pub correlation: Option<f64>,
    /// Largest coherence of two axes.
    pub coherence: Option<f64>,
    /// Rules that were not checked against the text of the standard.
    pub unchecked: &'static [&'static str],
}

/// A rule that nothing states.
const NONE: Standard = Standard {
    id: "",
    title: "",
    status: "",
    damping: 0.05,
    per_octave: 6,
    band: (1.0, 33.0),
    dips: None,
    ceiling: None,
    zero_period: 1.0,
    duration: None,
    strong: None,
    strong_ratio: None,
    stationary: None,
    correlation: None,
    coherence: None,
    unchecked: &[],
};

/// Every standard.
pub const STANDARDS: [Standard; 5] = [
    Standard {
        id: "ac156",
        title: "ICC-ES AC156, shake-table testing of nonstructural components",
        status: "spectrum, zero-period acceleration and independence of axes from public code; the rest from memory",
        band: (1.3, 33.3),
        dips: Some((0.1, 2)),
        ceiling: Some((1.3, 33.3)),
        zero_period: 0.9,
        duration: Some(30.0),
        strong: Some(20.0),
        correlation: Some(0.3),
        coherence: Some(0.5),
        unchecked: &["envelope", "ceiling", "duration", "strong motion"],
        ..NONE
    },
    Standard {
        id: "ieee693",
        title: "IEEE 693-2005, seismic design of substations, required response spectrum",
        status: "spectrum and strong-part ratio from public code; resolution, duration and bounds from memory",
        per_octave: 12,
        band: (0.3, 33.0),
        dips: Some((0.1, 2)),
        ceiling: Some((1.5, 33.0)),
        duration: Some(20.0),
        strong_ratio: Some(0.3),
        unchecked: &["envelope", "ceiling", "duration", "strong-part ratio"],
        ..NONE
    },
    Standard {
        id: "ieee344",
        title: "IEEE 344 / IEC 60068-3-3, seismic qualification, random motion",
        status: "all from memory; the required spectrum is the user's (--rrs)",
        dips: Some((0.1, 2)),
        strong: Some(15.0),
        stationary: Some(1.7),
        correlation: Some(0.3),
        coherence: Some(0.5),
        unchecked: &[
            "envelope",
            "zero-period acceleration",
            "strong motion",
            "stationarity",
            "correlation",
            "coherence",
        ],
        ..NONE
    },
    Standard {
        id: "gr63",
        title: "Telcordia GR-63-CORE, zone 4",
        status: "damping from public notes; spectrum and bounds from memory; the standard prescribes a waveform, which is not checked",
        damping: 0.02,
        band: (1.0, 50.0),
        ceiling: Some((1.3, 7.0)),
        unchecked: &["envelope", "ceiling", "zero-period acceleration"],
        ..NONE
    },
    Standard {
        id: OWN,
        title: "a required spectrum of one's own",
        status: "the spectrum is the user's (--rrs), and no other rule is held",
        zero_period: 0.0,
        ..NONE
    },
];

/// The name of no standard: a required spectrum alone, over the frequencies that it states.
const OWN: &str = "own";

/// The building code by which AC156 finds its levels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Code {
    /// ASCE 7-16.
    Asce16,
    /// ASCE 7-22.
    Asce22,
}

/// The direction of shaking.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Horizontal.
    Horizontal,
    /// Vertical.
    Vertical,
}

/// What the level of a required spectrum follows from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// AC156: design spectral acceleration at short periods, g.
    pub s_ds: f64,
    /// AC156: height of attachment over the roof's, 0 to 1.
    pub z_over_h: f64,
    /// AC156: the building code.
    pub code: Code,
    /// Horizontal or vertical.
    pub direction: Direction,
    /// IEEE 693: true for the high level, twice the moderate.
    pub high: bool,
}

/// Why there is no required spectrum.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StandardError {
    /// The standard leaves the spectrum to the user.
    #[error("{0} states no spectrum of its own: give it with --rrs FILE, lines of frequency [Hz] and acceleration [g]")]
    Unstated(&'static str),
}

impl Standard {
    /// The standard of a name.
    pub fn named(id: &str) -> Option<Self> {
        STANDARDS.into_iter().find(|standard| standard.id == id)
    }

    /// True for a required spectrum of the user's without further rules.
    pub fn is_own(&self) -> bool {
        self.id == OWN
    }

    /// The same for a spectrum of the user's: of no standard, its band is the spectrum's.
    #[must_use]
    pub fn for_spectrum(self, required: &Required) -> Self {
        match required.points.as_slice() {
            [first, .., last] if self.is_own() => Self { band: (first.0, last.0), ..self },
            _ => self,
        }
    }

    /// The spectrum that it requires.
    pub fn required(&self, site: &Site) -> Result<Required, StandardError> {
        let points = match self.id {
            "ac156" => ac156(site),
            "ieee693" => ieee693(self.damping, site),
            "gr63" => vec![(0.3, 0.2), (0.6, 2.0), (2.0, 5.0), (5.0, 5.0), (15.0, 1.6), (50.0, 1.6)],
            _ => return Err(StandardError::Unstated(self.title)),
        };
        Ok(Required { damping: self.damping, points: points.into_iter().map(|(f, a)| (f, a * G)).collect() })
    }
}

/// Flexible and rigid levels, g, and the spectrum between them.
fn ac156(site: &Site) -> Vec<(f64, f64)> {
    let Site { s_ds, z_over_h, code, direction, .. } = *site;
    let (flexible, rigid) = match (direction, code) {
        (Direction::Vertical, _) => (0.67 * s_ds, 0.27 * s_ds),
        (Direction::Horizontal, Code::Asce16) => {
            let height = 1.0 + 2.0 * z_over_h;
            ((s_ds * height).min(1.6 * s_ds), 0.4 * s_ds * height)
        }
        (Direction::Horizontal, Code::Asce22) => {
            let ratio = (1.0 + 2.5 * z_over_h) / if z_over_h > 0.0 { 1.3 } else { 1.0 };
            ((s_ds * ratio).min(1.6 * s_ds), 0.4 * s_ds * ratio)
        }
    };
    vec![(0.1, 0.1 * flexible), (1.3, flexible), (8.3, flexible), (33.3, rigid)]
}

/// The curve in steps fine enough for straight lines between them, g.
fn ieee693(damping: f64, site: &Site) -> Vec<(f64, f64)> {
    let b = (3.21 - 0.68 * (100.0 * damping).ln()) / 2.1156;
    let direction = if site.direction == Direction::Vertical { 0.8 } else { 1.0 };
    let level = if site.high { 2.0 * direction } else { direction };
    let moderate = |f: f64| match f {
        f if f <= 1.1 => 0.572 * b * f,
        f if f <= 8.0 => 0.625 * b,
        f if f < 33.0 => (6.6 * b - 2.64) / f - 0.2 * b + 0.33,
        _ => 0.25,
    };
    let bend = |k: i32| 8.0 * (33.0f64 / 8.0).powf(f64::from(k) / 24.0);
    let frequencies = [0.1, 1.1, 1.1001, 8.0].into_iter().chain((1..=24).map(bend));
    frequencies.map(|f| (f, level * moderate(f))).collect()
}
