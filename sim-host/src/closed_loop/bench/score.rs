//! What a run scores, and how scores over several records are summed up.

use crate::closed_loop::Trace;
use crate::closed_loop::trial::{TrialError, low_passed};
use crate::motion::Motion;
use crate::motion::metrics::{Comparison, compare};

/// One record's figures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Score {
    /// True motion, ideal sensors, nothing filtered.
    pub ideal: Comparison,
    /// True motion, ideal sensors, both sides low-passed at 15 Hz.
    pub ideal_low_passed: Comparison,
    /// True motion, the table's sensors, both sides low-passed at 15 Hz.
    pub sensed: Comparison,
    /// True motion, the table's sensors, nothing filtered: what noise shakes the table with at any frequency.
    pub sensed_whole: Comparison,
}

impl Score {
    /// Scores two runs along `wanted`.
    pub(crate) fn new(wanted: &Motion, ideal: &Trace, sensed: &Trace) -> Result<Self, TrialError> {
        let low = low_passed(wanted)?;
        Ok(Self {
            ideal: compare(wanted, &truth(ideal), None)?,
            ideal_low_passed: compare(&low, &low_passed(&truth(ideal))?, None)?,
            sensed: compare(&low, &low_passed(&truth(sensed))?, None)?,
            sensed_whole: compare(wanted, &truth(sensed), None)?,
        })
    }
}

/// The table's true motion.
pub(crate) fn truth(trace: &Trace) -> Motion {
    Motion {
        dt: trace.dt,
        displacement: trace.displacement.clone(),
        velocity: trace.velocity.clone(),
        acceleration: trace.acceleration.clone(),
    }
}

/// Best, quartiles and worst.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(crate) struct Quartiles {
    /// Smallest.
    pub best: f64,
    /// A quarter lies below.
    pub lower: f64,
    /// Half lies below.
    pub median: f64,
    /// Three quarters lie below.
    pub upper: f64,
    /// Largest.
    pub worst: f64,
}

impl Quartiles {
    /// Of `values`, linear between ranks; an infinite or missing value counts as infinite.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.map(|v| if v.is_nan() { f64::INFINITY } else { v }).collect();
        sorted.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let place = share * sorted.len().saturating_sub(1) as f64;
            let (low, high) = (place.floor() as usize, place.ceil() as usize);
            let (Some(&a), Some(&b)) = (sorted.get(low), sorted.get(high)) else { return f64::NAN };
            if a == b { a } else { a + (place - low as f64) * (b - a) }
        };
        Self { best: at(0.0), lower: at(0.25), median: at(0.5), upper: at(0.75), worst: at(1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_are_those_of_the_ranks() {
        let q = Quartiles::of([5.0, 1.0, 3.0, 2.0, 4.0].into_iter());
        assert_eq!((q.best, q.lower, q.median, q.upper, q.worst), (1.0, 2.0, 3.0, 4.0, 5.0));
        assert_eq!(Quartiles::of([1.0, f64::NAN].into_iter()).worst, f64::INFINITY);
        assert!(Quartiles::of(std::iter::empty()).median.is_nan());
    }
}
