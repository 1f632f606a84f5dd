//! What a campaign came to: by class, latencies in percentiles, and every run that did not keep what was promised.

use super::class::{CLASSES, Class, Promise};
use super::watcher::{Outcome, Violation};
use serde::Serialize;

/// One class.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Its name.
    pub class: &'static str,
    /// What happens.
    pub what: &'static str,
    /// Runs.
    pub runs: u64,
    /// Runs in which there was something to see.
    pub visible: u64,
    /// Runs that were reported.
    pub reported: u64,
    /// Latency promised, s; none where none is.
    pub bound_s: Option<f64>,
    /// Latencies of those reported, s: median, 95th, 99th percentile, largest.
    pub latency_s: Option<[f64; 4]>,
    /// Runs that left the stroke less the margin, or the stroke where the valve does not obey, promised or not.
    pub outside: u64,
    /// Farthest from the middle, m.
    pub farthest_m: f64,
    /// Farthest from where it would have been until it was reported, m.
    pub deviation_m: f64,
    /// Largest acceleration of the specimen, m/s2.
    pub acceleration_m_s2: f64,
    /// Runs that broke a promise, by which.
    pub broken: Vec<(Violation, u64)>,
}

/// The whole.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Runs.
    pub runs: u64,
    /// By class, in the registry's order.
    pub rows: Vec<Row>,
    /// Runs that broke a promise.
    pub failed: Vec<Outcome>,
    /// Runs that the guard ended before their fault, for what was so: nothing is learned of the fault.
    pub ended: u64,
}

const KINDS: [Violation; 6] = [
    Violation::Excursion,
    Violation::Unreported,
    Violation::Late,
    Violation::Moving,
    Violation::Rough,
    Violation::Alarm,
];

impl Summary {
    /// Of `outcomes`, in any order.
    pub fn of(outcomes: &[Outcome]) -> Self {
        let rows = CLASSES.iter().map(|class| row(class, outcomes)).filter(|row| row.runs > 0).collect();
        let mut failed: Vec<Outcome> = outcomes.iter().filter(|o| !o.broken.is_empty()).cloned().collect();
        failed.sort_by_key(|o| o.run);
        let ended = outcomes.iter().filter(|o| o.ended).count() as u64;
        Self { runs: outcomes.len() as u64, rows, failed, ended }
    }

    /// How many runs broke a promise in this way.
    pub fn broken(&self, how: Violation) -> u64 {
        self.failed.iter().filter(|o| o.broken.contains(&how)).count() as u64
    }
}

fn count(outcomes: &[&Outcome]) -> Vec<(Violation, u64)> {
    KINDS
        .into_iter()
        .map(|how| (how, outcomes.iter().filter(|o| o.broken.contains(&how)).count() as u64))
        .filter(|(_, n)| *n > 0)
        .collect()
}

fn row(class: &Class, outcomes: &[Outcome]) -> Row {
    let of: Vec<&Outcome> = outcomes.iter().filter(|o| o.class == class.id).collect();
    // A run that tripped before its fault says nothing of the fault.
    let met: Vec<&&Outcome> = of.iter().filter(|o| !o.ended && !o.broken.contains(&Violation::Alarm)).collect();
    let mut latencies: Vec<f64> = met.iter().filter(|o| o.visible).filter_map(|o| o.latency_s).collect();
    latencies.sort_by(f64::total_cmp);
    let rank = |share: f64| latencies[((share * latencies.len() as f64).ceil() as usize).max(1) - 1];
    let largest = |of: &dyn Fn(&Outcome) -> f64| met.iter().map(|o| of(o)).fold(0.0, f64::max);
    Row {
        class: class.id,
        what: class.what,
        runs: of.len() as u64,
        visible: met.iter().filter(|o| o.visible).count() as u64,
        reported: met.iter().filter(|o| o.reported.is_some()).count() as u64,
        bound_s: match class.promise {
            Promise::Reported(_, within) | Promise::Relay(_, within) => Some(within),
            _ => None,
        },
        latency_s: (!latencies.is_empty()).then(|| [rank(0.5), rank(0.95), rank(0.99), rank(1.0)]),
        outside: met.iter().filter(|o| o.outside).count() as u64,
        farthest_m: largest(&|o| o.farthest_m),
        deviation_m: largest(&|o| o.deviation_m),
        acceleration_m_s2: largest(&|o| o.acceleration_m_s2),
        broken: count(&of),
    }
}
