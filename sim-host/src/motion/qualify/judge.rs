//! A motion held against a standard, rule by rule.

use super::super::metrics::{Intensity, coherence, intensity};
use super::super::peak;
use super::super::spectrum::{SpectrumError, response_spectrum};
use super::measures::{correlation, middle, part, unsteadiness};
use super::{Requirement, Standard};

/// A motion's spectrum beside the required one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ordinate {
    /// Hz.
    pub frequency: f64,
    /// m/s2.
    pub required: f64,
    /// m/s2.
    pub reached: f64,
}

impl Ordinate {
    /// Reached over required.
    pub fn ratio(&self) -> f64 {
        self.reached / self.required
    }
}

/// One rule, what was found and what is asked.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// What it is called.
    pub name: &'static str,
    /// What was found, in `unit`.
    pub found: f64,
    /// What is asked, in `unit`.
    pub bound: f64,
    /// True where `found` must not be below the bound; else it must not be above it.
    pub at_least: bool,
    /// Unit of both; empty for a pure number.
    pub unit: &'static str,
    /// True where it is kept.
    pub holds: bool,
    /// True where it is advice and does not decide.
    pub advised: bool,
    /// True where the rule was checked against the standard's text.
    pub checked: bool,
    /// Where it is broken or nearly, in words.
    pub place: String,
}

/// A motion held against a standard.
#[derive(Debug, Clone, PartialEq)]
pub struct ScoredModel {
    /// Rules in their order.
    pub rules: Vec<Rule>,
    /// The spectra at the points that were judged.
    pub ordinates: Vec<Ordinate>,
    /// Reached over required where that is least.
    pub margin: f64,
    /// Where that is, Hz.
    pub worst_hz: f64,
    /// Axes of the test: of those beyond the first nothing was judged but how independent each two are.
    pub axes: usize,
    /// Largest acceleration of the motion, m/s2.
    pub zero_period: f64,
    /// Strength of the motion.
    pub intensity: Intensity,
    /// The points of the grid lie this share of their distance off its beginning.
    pub offset: f64,
}

impl ScoredModel {
    /// True where every rule that decides is kept.
    pub fn complies(&self) -> bool {
        self.rules.iter().all(|rule| rule.holds || rule.advised)
    }

    /// The rules that decide and are broken.
    pub fn broken(&self) -> impl Iterator<Item = &Rule> {
        self.rules.iter().filter(|rule| !rule.holds && !rule.advised)
    }
}

/// Why a motion can not be judged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum QualifyError {
    /// It has no response spectrum.
    #[error(transparent)]
    Spectrum(#[from] SpectrumError),
    /// It is sampled too slowly for the standard's band.
    #[error(
        "is sampled at {rate:.0} Hz: the standard's spectrum reaches to {highest} Hz, which takes 4 samples a cycle at least"
    )]
    Slow {
        /// Hz.
        rate: f64,
        /// Hz.
        highest: f64,
    },
    /// Axes that are not of one test.
    #[error("the axes have {first} and {other} samples: they have to be of one test")]
    Axes {
        /// Samples of the first axis.
        first: usize,
        /// Samples of another.
        other: usize,
    },
}

/// Offsets of the grid that are tried.
const OFFSETS: usize = 12;

/// Holds an acceleration (m/s2, every `dt` s) against what a standard asks; `axes` are the other axes of the same test, of which each two are
/// held against each other, and nothing else: a vertical axis has a spectrum of its own.
pub fn judge(
    acceleration: &[f64],
    dt: f64,
    axes: &[Vec<f64>],
    asked: Requirement<'_>,
) -> Result<ScoredModel, QualifyError> {
    let Requirement { standard, required, lowest } = asked;
    let highest = standard.band.1;
    if 1.0 / dt < 4.0 * highest {
        return Err(QualifyError::Slow { rate: 1.0 / dt, highest });
    }
    let fine = ordinates(acceleration, dt, asked)?;
    let grids = grids(&fine);
    let judge = Judge { standard };
    let worst = grids.first().and_then(|(_, o)| o.iter().copied().min_by(|a, b| a.ratio().total_cmp(&b.ratio())));
    // A grid whose dips are allowed serves where none lies above everywhere.
    let serves = grids.iter().position(|(_, o)| judge.envelope(o).holds).unwrap_or(0);
    let (offset, ordinates) = grids.into_iter().nth(serves).unwrap_or((0, fine));
    let strength = intensity(acceleration, dt);
    let strong = part(acceleration, dt, &strength);
    let mut rules = vec![judge.envelope(&ordinates)];
    rules.extend(judge.ceiling(&ordinates));
    let asked = standard.zero_period > 0.0;
    rules.extend(asked.then(|| judge.zero_period(peak(acceleration), required.zero_period())));
    let duration = acceleration.len() as f64 * dt;
    rules.extend(standard.duration.map(|least| judge.least("duration", duration, least, "s")));
    rules.extend(standard.strong.map(|least| judge.least("strong motion", strength.d5_95, least, "s")));
    let ratio = middle(acceleration, dt) / strength.d5_95;
    rules.extend(standard.strong_ratio.map(|least| judge.least("strong-part ratio", ratio, least, "")));
    rules.extend(standard.stationary.map(|most| {
        let (found, place) = unsteadiness(strong, dt, (lowest, highest));
        Rule { place, ..judge.most("stationarity", found, most, "") }
    }));
    if let Some(other) = axes.iter().map(Vec::len).find(|&length| length != acceleration.len()) {
        return Err(QualifyError::Axes { first: acceleration.len(), other });
    }
    let strong_parts: Vec<&[f64]> =
        std::iter::once(strong).chain(axes.iter().map(|axis| part(axis, dt, &strength))).collect();
    for (j, other) in strong_parts.iter().enumerate() {
        for (i, one) in strong_parts.iter().enumerate().take(j) {
            rules.extend(judge.independence(
                [one, other],
                dt,
                (lowest, highest),
                &format!("axes {} and {}", i + 1, j + 1),
            ));
        }
    }
    Ok(ScoredModel {
        rules,
        margin: worst.map_or(f64::NAN, |o| o.ratio()),
        worst_hz: worst.map_or(f64::NAN, |o| o.frequency),
        ordinates,
        axes: 1 + axes.len(),
        zero_period: peak(acceleration),
        intensity: strength,
        offset: offset as f64 / OFFSETS as f64,
    })
}

/// The spectra at every point of every offset.
fn ordinates(acceleration: &[f64], dt: f64, asked: Requirement<'_>) -> Result<Vec<Ordinate>, QualifyError> {
    let Requirement { standard, required, lowest } = asked;
    let each = (standard.per_octave * OFFSETS) as f64;
    let count = ((standard.band.1 / lowest).log2() * each + 1e-9).floor() as usize;
    let frequencies: Vec<f64> = (0..=count).map(|k| lowest * (k as f64 / each).exp2()).collect();
    let periods: Vec<f64> = frequencies.iter().map(|f| 1.0 / f).collect();
    // The oscillators ring on when the table has stopped.
    let rest = (1.0 / (lowest * dt)).ceil() as usize;
    let shaken: Vec<f64> = acceleration.iter().copied().chain(std::iter::repeat_n(0.0, rest)).collect();
    let spectrum = response_spectrum(&shaken, dt, required.damping, &periods)?;
    let pairs = frequencies.into_iter().zip(spectrum.s_a);
    Ok(pairs.filter_map(|(f, reached)| Some(Ordinate { frequency: f, required: required.at(f)?, reached })).collect())
}

/// The grids that a laboratory may lay, from the one that lies farthest above what is required at its worst point.
fn grids(fine: &[Ordinate]) -> Vec<(usize, Vec<Ordinate>)> {
    let grid = |offset: usize| (offset, fine.iter().copied().skip(offset).step_by(OFFSETS).collect::<Vec<_>>());
    let mut grids: Vec<(usize, Vec<Ordinate>)> = (0..OFFSETS).map(grid).filter(|(_, o)| !o.is_empty()).collect();
    let least = |o: &[Ordinate]| o.iter().map(Ordinate::ratio).fold(f64::INFINITY, f64::min);
    grids.sort_by(|(_, a), (_, b)| least(b).total_cmp(&least(a)));
    grids
}

/// Makes rules of a standard.
struct Judge<'a> {
    standard: &'a Standard,
}

impl Judge<'_> {
    fn rule(&self, name: &'static str, found: f64, bound: f64, unit: &'static str, at_least: bool) -> Rule {
        // A bound met but for rounding is met.
        let slack = 1e-9 * bound.abs();
        let holds = if at_least { found >= bound - slack } else { found <= bound + slack };
        let checked = !self.standard.unchecked.contains(&name);
        Rule { name, found, bound, at_least, unit, holds, advised: false, checked, place: String::new() }
    }

    fn least(&self, name: &'static str, found: f64, bound: f64, unit: &'static str) -> Rule {
        self.rule(name, found, bound, unit, true)
    }

    fn most(&self, name: &'static str, found: f64, bound: f64, unit: &'static str) -> Rule {
        self.rule(name, found, bound, unit, false)
    }

    /// Nowhere below what is required, but for the dips that are allowed.
    fn envelope(&self, ordinates: &[Ordinate]) -> Rule {
        let (deep, many) = self.standard.dips.unwrap_or((0.0, 0));
        let ratio = |k: usize| ordinates.get(k).map_or(1.0, Ordinate::ratio);
        let low: Vec<usize> = (0..ordinates.len()).filter(|&k| ratio(k) < 1.0 - 1e-9).collect();
        let lone = |k: usize| ratio(k.wrapping_sub(1)) >= 1.0 - 1e-9 && ratio(k + 1) >= 1.0 - 1e-9;
        let allowed = low.len() <= many && low.iter().all(|&k| ratio(k) >= 1.0 - deep && lone(k));
        let worst = ordinates.iter().copied().min_by(|a, b| a.ratio().total_cmp(&b.ratio()));
        let found = worst.map_or(f64::NAN, |o| o.ratio());
        let at = worst.map_or(0.0, |o| o.frequency);
        let place = match low.len() {
            0 => format!("least at {at:.2} Hz"),
            n => format!("{n} of {} points below, deepest at {at:.2} Hz", ordinates.len()),
        };
        let bound = if low.is_empty() || !allowed { 1.0 } else { 1.0 - deep };
        Rule { holds: allowed, place, ..self.least("envelope", found, bound, "") }
    }

    fn ceiling(&self, ordinates: &[Ordinate]) -> Option<Rule> {
        let (most, up_to) = self.standard.ceiling?;
        let inside = ordinates.iter().filter(|o| o.frequency <= up_to);
        let worst = inside.copied().max_by(|a, b| a.ratio().total_cmp(&b.ratio()))?;
        let place = format!("highest at {:.2} Hz", worst.frequency);
        Some(Rule { advised: true, place, ..self.most("ceiling", worst.ratio(), most, "") })
    }

    /// How independent the strong parts of two axes, named by `place`, are within a band (Hz).
    fn independence(&self, [one, other]: [&[f64]; 2], dt: f64, (low, high): (f64, f64), place: &str) -> Vec<Rule> {
        let Standard { correlation: alike, coherence: shared, .. } = self.standard;
        let of = |rule: Rule| Rule { place: place.to_owned(), ..rule };
        let alike = alike.map(|most| of(self.most("correlation", correlation(one, other, dt), most, "")));
        let shared = shared.map(|most| {
            let found = coherence(one, other, dt, (1.0 / dt) as usize);
            let inside = found.frequency.iter().zip(&found.value).filter(|(f, _)| (low..=high).contains(*f));
            of(self.most("coherence", inside.fold(0.0, |most: f64, (_, c)| most.max(*c)), most, ""))
        });
        alike.into_iter().chain(shared).collect()
    }

    fn zero_period(&self, found: f64, required: f64) -> Rule {
        self.least("zero-period acceleration", found, self.standard.zero_period * required, "m/s2")
    }
}
