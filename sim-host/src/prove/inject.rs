//! Known faults planted into real recordings: each stretch is diagnosed as it is and with one fault in it. Scored is whether
//! the fault is found, and whether anything is claimed of the stretch as it is that is not claimed of the whole recording.

mod fault;
mod verdict;

pub use fault::{Fault, Kind, noise};
pub use verdict::{Claims, claims, found, mistaken_for};

use super::bounds::{lower, upper};
use super::gates::{Gate, Limit};
use crate::report::Table;
use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Least size of a planted fault, in standard deviations.
pub const LEAST: f64 = 5.0;

/// One stretch, asked twice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Number of the stretch.
    pub number: u64,
    /// The recording that it is a part of.
    pub recording: String,
    /// Its start and end by the file's clock (s).
    pub from_s: f64,
    /// Its end (s).
    pub to_s: f64,
    /// What was planted.
    pub fault: Fault,
    /// Whether that was found.
    pub found: bool,
    /// What was claimed of the stretch with the fault.
    pub planted: Claims,
    /// What was claimed of the stretch as it is.
    pub untouched: Claims,
    /// What of that is not claimed of the whole recording.
    pub false_claims: Vec<String>,
}

/// A share with bounds from whole recordings drawn again.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// What was planted, on which channel.
    pub name: String,
    /// Stretches.
    pub stretches: usize,
    /// Of them, with the fault found.
    pub found: usize,
}

/// All trials.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Found, and falsely changed.
    pub gates: Vec<Gate>,
    /// By fault and channel.
    pub rows: Vec<Row>,
    /// Recordings.
    pub recordings: usize,
    /// The trials.
    pub trials: Vec<Trial>,
}

/// Draws of the recordings for the bounds.
const DRAWS: usize = 2000;

/// Sums up.
pub fn summarise(trials: Vec<Trial>) -> Summary {
    let mut by_recording: BTreeMap<&str, Vec<&Trial>> = BTreeMap::new();
    let mut by_fault: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for trial in &trials {
        by_recording.entry(&trial.recording).or_default().push(trial);
        let row = by_fault.entry(format!("{}, {}", trial.fault.kind.name(), trial.fault.channel)).or_default();
        *row = (row.0 + 1, row.1 + usize::from(trial.found));
    }
    let groups: Vec<Vec<&Trial>> = by_recording.into_values().collect();
    let share = |name: &str, limit, yes: &dyn Fn(&Trial) -> bool| {
        let counts: Vec<(usize, usize)> =
            groups.iter().map(|g| (g.iter().filter(|t| yes(t)).count(), g.len())).collect();
        let (k, n) = counts.iter().fold((0, 0), |(k, n), c| (k + c.0, n + c.1));
        let value = if n == 0 { f64::NAN } else { k as f64 / n as f64 };
        let (low, high) = resampled(&counts);
        // Recordings that all agree say nothing of how few the stretches are.
        let bounds = if n == 0 { (0.0, 1.0) } else { (low.min(lower(k, n)), high.max(upper(k, n))) };
        Gate { count: k, ..Gate::bounded(name, value, bounds, n, limit) }
    };
    let gates = vec![
        share("planted fault found", Limit::AtLeast(0.90), &|t| t.found),
        share("untouched stretch falsely changed", Limit::AtMost(0.02), &|t| !t.false_claims.is_empty()),
    ];
    let row = |(name, (stretches, found))| Row { name, stretches, found };
    let rows = by_fault.into_iter().map(row).collect();
    Summary { gates, rows, recordings: groups.len(), trials }
}

/// Bounds of 95 % each from recordings drawn with replacement: stretches of one recording are no independent trials.
fn resampled(counts: &[(usize, usize)]) -> (f64, f64) {
    if counts.is_empty() {
        return (0.0, 1.0);
    }
    let mut rng = ChaCha8Rng::seed_from_u64(counts.len() as u64);
    let mut shares: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let drawn = (0..counts.len()).map(|_| counts[(rng.next_u64() % counts.len() as u64) as usize]);
            let (k, n) = drawn.fold((0, 0), |(k, n), c| (k + c.0, n + c.1));
            k as f64 / n as f64
        })
        .collect();
    shares.sort_by(f64::total_cmp);
    (shares[DRAWS / 20], shares[DRAWS - 1 - DRAWS / 20])
}

/// Found by fault and channel.
pub fn table(summary: &Summary) -> Table {
    let row = |r: &Row| vec![r.name.clone(), r.stretches.to_string(), r.found.to_string()];
    Table {
        columns: ["Planted", "Stretches", "Found"].map(String::from).to_vec(),
        rows: summary.rows.iter().map(row).collect(),
        caption: format!("{} recordings; bounds from recordings drawn again.", summary.recordings),
    }
}

/// What was missed or falsely changed, one a row.
pub fn misses(summary: &Summary) -> Table {
    let odd = summary.trials.iter().filter(|t| !t.found || !t.false_claims.is_empty());
    let row = |t: &Trial| {
        let fault = &t.fault;
        vec![
            format!("{} {:.1} to {:.1} s", t.recording, t.from_s, t.to_s),
            format!(
                "{} {} {:.3e} {}, {:.0} s.d.",
                fault.kind.name(),
                fault.channel,
                fault.size,
                fault.unit,
                fault.sigma
            ),
            if t.found { "found".into() } else { t.planted.text() },
            t.false_claims.join(", "),
        ]
    };
    Table {
        columns: ["Stretch", "Planted", "Said", "Falsely claimed of it as it is"].map(String::from).to_vec(),
        rows: odd.map(row).collect(),
        caption: String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::resampled;

    #[test]
    fn bounds_are_as_wide_as_recordings_differ() {
        let (low, high) = resampled(&[(90, 100); 6]);
        assert!((low - 0.9).abs() < 1e-12 && (high - 0.9).abs() < 1e-12);
        let (low, high) = resampled(&[(100, 100), (100, 100), (0, 100)]);
        // Two of three drawn from the bad one is the lower bound: all three are drawn in one of 27.
        assert!(low < 0.34 && high > 0.99, "{low} to {high}");
        assert_eq!(resampled(&[]), (0.0, 1.0));
    }
}
