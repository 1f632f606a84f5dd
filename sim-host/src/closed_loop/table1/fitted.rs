//! The rows that the paper does not have: its strong PI on records fitted to the table.
//!
//! The record is fitted to the plant's speed and the settings' stroke and played as it then is. What runs online on the
//! device (`clip`, `causal`, `preview`) is here the core's own arithmetic run over the record beforehand, the preview's lag
//! taken out, so that all rows are held against the same instant.

use super::super::published::{Event, Named};
use super::super::trial::{ScoredSignal, Scores, Setup, Trial, TrialError};
use super::super::twin::Twin;
use super::Case;
use crate::motion::fit::named::RecordFit;
use rayon::prelude::*;

/// The fits that have a row, `None` being the record as it is.
pub const ROWS: [Option<&str>; 6] = [None, Some("clip"), Some("taut"), Some("convex"), Some("causal"), Some("preview")];

/// Largest peak of the table's acceleration against the reference's that a fitted record may leave.
pub const SPIKE: f64 = 1.05;

/// Strong PI on a record fitted to the table.
#[derive(Debug, Clone)]
pub struct FittedRow {
    /// Record.
    pub event: Event,
    /// Name of the fit; `None` for the record as it is.
    pub fit: Option<&'static str>,
    /// Over the whole record, against the record before it was fitted.
    pub whole: Scores,
    /// Largest displacement of the table, and the displacement it ends with, m.
    pub reached: (f64, f64),
    /// Peak acceleration of the table over the reference's, nothing filtered, 1.
    pub spike: f64,
}

impl FittedRow {
    /// Whether the row leaves no spike. The paper's own Eq. 10 and the record as it is are shown, not held.
    pub fn holds(&self) -> Option<bool> {
        match self.fit {
            None | Some("clip") => None,
            Some(_) => Some(self.spike <= SPIKE),
        }
    }
}

/// Runs every row on every case, over all cores; `done` is called after each.
pub fn rows(cases: &[Case], table: &Twin, done: impl Fn() + Sync) -> Result<Vec<FittedRow>, TrialError> {
    let all: Vec<_> = cases.iter().flat_map(|case| ROWS.map(|fit| (case, fit))).collect();
    all.par_iter()
        .map(|&(case, fit)| {
            let row = row(case, fit, table)?;
            done();
            Ok(row)
        })
        .collect()
}

fn row(case: &Case, fit: Option<&'static str>, table: &Twin) -> Result<FittedRow, TrialError> {
    let setup = Setup { table: table.clone(), ..Setup::paper(Named::Strong) };
    let given = match fit.and_then(RecordFit::parse) {
        None => case.motion.clone(),
        Some(fit) => fit.apply(&case.motion, setup.table.velocity_limit(), f64::from(setup.settings.stroke), |_| {})?,
    };
    let trial = setup.play(&given)?.fitted_from(&case.motion);
    let whole = trial.scores(ScoredSignal::Truly, None)?;
    Ok(FittedRow { event: case.event, fit, whole, reached: reached(&trial), spike: spike(&trial) })
}

/// Largest and last displacement of the table, m.
fn reached(trial: &Trial) -> (f64, f64) {
    let x = &trial.trace.displacement;
    (crate::motion::peak(x), x.last().copied().unwrap_or(0.0))
}

/// Peak acceleration of the table over the reference's.
fn spike(trial: &Trial) -> f64 {
    crate::motion::peak(&trial.trace.acceleration) / crate::motion::peak(&trial.wanted.acceleration)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::generate::{NEAR_FIELD_STRONG, Recipe};

    #[test]
    fn a_fitted_record_takes_the_spike_away_and_ends_at_the_centre() {
        let record = Recipe { duration: 15.0, ..NEAR_FIELD_STRONG }.generate(1).unwrap();
        let case = Case::new(Event::Kobe, &record, true).unwrap();
        let (plain, fitted) = {
            let table = Twin::default();
            (row(&case, None, &table).unwrap(), row(&case, Some("taut"), &table).unwrap())
        };
        assert!(plain.spike > 1.3 && plain.holds().is_none(), "{}", plain.spike);
        assert!(fitted.holds() == Some(true), "{}", fitted.spike);
        assert!(fitted.reached.1.abs() < 2e-3 && fitted.whole.saturated_s < plain.whole.saturated_s);
        assert!(fitted.whole.against_wanted.e_a.ratio < plain.whole.against_wanted.e_a.ratio);
    }
}
