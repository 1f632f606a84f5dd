//! Where in time, frequency and state a residual lies, found without the library.

use super::residual::{judged_channels, residual, spectrum};
use super::verdict::Conclusion;
use crate::identify::data::Run;
use crate::identify::evaluate::Predicted;
use crate::identify::judge::score;
use crate::identify::prepare::Prepared;
use crate::plant::effects::regional::{Along, window};
use crate::plant::simulate::SimulateError;
use serde::Serialize;

mod state;

/// Where the model and the recordings part.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Location {
    /// The block of the signal path: of the accepted effects, or `unlisted`; none where all is consistent.
    pub block: Option<&'static str>,
    /// Stretches of runs, most of the excess first.
    pub time: Vec<Stretch>,
    /// Bands where the residual stands above the noise, strongest first.
    pub frequency: Vec<Band>,
    /// Quantities that explain the residual, strongest first.
    pub state: Vec<StateShare>,
}

/// A stretch of a run.
#[derive(Debug, Clone, Serialize)]
pub struct Stretch {
    /// The run.
    pub run: String,
    /// Start, s on the run's clock.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Its share of all excess.
    pub share: f64,
}

/// A band of frequencies.
#[derive(Debug, Clone, Serialize)]
pub struct Band {
    /// Lower edge, Hz.
    pub from_hz: f64,
    /// Upper edge, Hz.
    pub to_hz: f64,
    /// Power of the residual over that of the noise.
    pub ratio: f64,
}

/// A quantity that explains part of the residual.
#[derive(Debug, Clone, Serialize)]
pub struct StateShare {
    /// `displacement velocity acceleration command velocity_sign path time pressure reference`.
    pub variable: &'static str,
    /// Where along it, in words.
    #[serde(rename = "where")]
    pub place: String,
    /// Share of the residual's variance it explains on blocks it was not fitted to.
    pub strength: f64,
    /// The quantity's median and the residual's mean, in standard deviations of the noise, in each of twelve equal shares of
    /// the samples.
    pub profile: Vec<[f64; 2]>,
}

/// Longest stretches named.
const STRETCHES: usize = 5;

/// Locates the mismatch of the stated model on the runs it was fitted to.
pub(crate) fn locate(prepared: &Prepared, conclusion: &Conclusion) -> Result<Location, SimulateError> {
    if conclusion.consistent() {
        return Ok(Location::default());
    }
    let predicted = score(&conclusion.stated.fit.model, &prepared.fit)?.predicted;
    let block = if conclusion.unlisted {
        Some("unlisted")
    } else {
        let last = conclusion.accepted.added.first().and_then(|id| crate::plant::effects::entry(id));
        last.map(|entry| entry.stage.name())
    };
    let location = Location {
        block,
        time: stretches(&prepared.fit, &predicted),
        frequency: bands(&prepared.fit, &predicted),
        state: state::shares(&prepared.fit, &predicted),
    };
    Ok(within(location, conclusion, (&prepared.fit, &predicted)))
}

/// The location with the window of an effect that was found to act in one: where the residual is large beside that is where
/// the loop carries it.
fn within(mut location: Location, conclusion: &Conclusion, (runs, predicted): (&[Run], &[Predicted])) -> Location {
    if conclusion.unlisted {
        return location;
    }
    for placed in &conclusion.accepted.fit.model.effects {
        let values = placed.numbers();
        let Some((along, from, to)) = window(placed.entry, &values) else { continue };
        if along == Along::Time {
            location.time = windows(runs, predicted, from, to);
            continue;
        }
        let place = format!("from {from:.4e} to {to:.4e}");
        // What is seen along the variable stands beside where the effect acts.
        let seen = location.state.iter().position(|share| share.variable == along.name());
        let seen = seen.map(|i| location.state.remove(i));
        let none = StateShare { variable: along.name(), place: String::new(), strength: 0.0, profile: Vec::new() };
        location.state.insert(0, StateShare { place, ..seen.unwrap_or(none) });
    }
    location
}

/// The same window of time in every run, with its share of all excess.
fn windows(runs: &[Run], predicted: &[Predicted], from: f64, to: f64) -> Vec<Stretch> {
    let blocks = blocks(runs, predicted);
    let whole: f64 = blocks.iter().map(|b| b.share.max(0.0)).sum();
    let of = |run: &Run| {
        let end = run.from + run.len() as f64 * run.dt;
        let file = run.from - run.elapsed;
        let (from_s, to_s) = ((file + from).max(run.from), (file + to).min(end));
        let inside = |b: &&Stretch| b.run == run.name && (from_s..to_s).contains(&(0.5 * (b.from_s + b.to_s)));
        let excess: f64 = blocks.iter().filter(inside).map(|b| b.share.max(0.0)).sum();
        (to_s > from_s).then(|| Stretch { run: run.name.clone(), from_s, to_s, share: excess / whole.max(1e-12) })
    };
    runs.iter().filter_map(of).collect()
}

/// Locates what a model leaves of runs, whatever its physics; `predicted` holds one prediction a run.
pub fn leftover(runs: &[Run], predicted: &[Predicted]) -> Location {
    Location {
        block: None,
        time: stretches(runs, predicted),
        frequency: bands(runs, predicted),
        state: state::shares(runs, predicted),
    }
}

fn stretches(runs: &[Run], predicted: &[Predicted]) -> Vec<Stretch> {
    let all = blocks(runs, predicted);
    let whole: f64 = all.iter().map(|b| b.share.max(0.0)).sum();
    let joined = join(all, whole / runs.len().max(1) as f64 / 40.0);
    let mut named: Vec<Stretch> =
        joined.into_iter().map(|s| Stretch { share: (s.share / whole.max(1e-12)).clamp(0.0, 1.0), ..s }).collect();
    named.sort_by(|a, b| b.share.total_cmp(&a.share));
    named.truncate(STRETCHES);
    named
}

/// Every half second of every run, with its excess where its share will stand.
fn blocks(runs: &[Run], predicted: &[Predicted]) -> Vec<Stretch> {
    let mut all = Vec::new();
    for (run, predicted) in runs.iter().zip(predicted) {
        let block = ((0.5 / run.dt).round() as usize).max(1);
        let mut sums = vec![0.0; run.len().div_ceil(block)];
        for channel in judged_channels(run) {
            for (k, r) in residual(run, predicted, channel).unwrap_or_default().iter().enumerate() {
                sums[k / block] += if r.is_finite() { r * r - 1.0 } else { 0.0 };
            }
        }
        all.extend(sums.into_iter().enumerate().map(|(i, excess)| Stretch {
            run: run.name.clone(),
            from_s: run.from + (i * block) as f64 * run.dt,
            to_s: run.from + ((i + 1) * block).min(run.len()) as f64 * run.dt,
            share: excess,
        }));
    }
    all
}

/// Joins neighbouring stretches that all stand out.
fn join(all: Vec<Stretch>, stands_out: f64) -> Vec<Stretch> {
    let mut joined: Vec<Stretch> = Vec::new();
    let mut before = false;
    for stretch in all {
        let out = stretch.share > stands_out;
        match joined.last_mut() {
            Some(last) if out && before && last.run == stretch.run => {
                last.to_s = stretch.to_s;
                last.share += stretch.share;
            }
            _ if out => joined.push(stretch),
            _ => {}
        }
        before = out;
    }
    joined
}

fn bands(runs: &[Run], predicted: &[Predicted]) -> Vec<Band> {
    let Some(dt) = runs.first().map(|r| r.dt) else { return Vec::new() };
    let size = ((4.0 / dt) as usize).next_power_of_two().max(64);
    let mut power = vec![0.0; size / 2 + 1];
    let mut count = 0.0;
    for (run, predicted) in runs.iter().zip(predicted) {
        for channel in judged_channels(run) {
            let series = residual(run, predicted, channel).unwrap_or_default();
            power.iter_mut().zip(spectrum(&series, size)).for_each(|(sum, p)| *sum += p);
            count += 1.0;
        }
    }
    let hz = 1.0 / (size as f64 * dt);
    let mut bands: Vec<Band> = Vec::new();
    let mut edge = 0.25;
    while edge < 0.5 / dt {
        let upper = (edge * 1.5_f64).max(edge + 0.5).min(0.5 / dt);
        let (i, j) = ((edge / hz) as usize, ((upper / hz) as usize).min(power.len()));
        if j > i {
            let ratio = power[i..j].iter().sum::<f64>() / (j - i) as f64 / f64::max(count, 1.0);
            bands.push(Band { from_hz: edge, to_hz: upper, ratio });
        }
        edge = upper;
    }
    bands.retain(|b| b.ratio > 1.3);
    bands.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
    bands.truncate(STRETCHES);
    bands
}
