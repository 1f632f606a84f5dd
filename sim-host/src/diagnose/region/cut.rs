//! The range of a variable cut into parts, and in which of them each sample of the runs lies.

use super::ends::{parts, seen};
use crate::identify::data::Run;
use crate::identify::evaluate::{Predicted, compared_samples};
use crate::identify::fit::secant::Chord;
use crate::plant::effects::regional::Along;

/// A variable with the ends of its parts, and by run and row of the residuals in which part the row's sample lies.
pub(super) struct Cut {
    along: Along,
    ends: Vec<f64>,
    parts: Vec<Vec<Option<usize>>>,
}

impl Cut {
    /// Of a variable that the runs have.
    pub(super) fn of(along: Along, runs: &[Run], shown: &[Predicted]) -> Option<Self> {
        let ends = parts(along, runs, shown)?;
        let of_run = |(run, shown): (&Run, &Predicted)| {
            let values = seen(along, run, shown)?;
            let part = |k: usize| part(*values.get(k)?, &ends);
            Some(compared_samples(run).into_iter().map(part).collect())
        };
        let parts = runs.iter().zip(shown).map(of_run).collect::<Option<_>>()?;
        Some(Self { along, ends, parts })
    }

    /// Along what, and where its parts end.
    pub(super) fn ends(&self) -> (Along, &[f64]) {
        (self.along, &self.ends)
    }

    /// What a change made everywhere changes of the rows in one part: all that it does there, where it acts on a sensor.
    pub(super) fn within(&self, chord: &Chord, part: usize) -> Vec<Vec<f64>> {
        chord.only(|run, row| self.parts[run].get(row) == Some(&Some(part)))
    }
}

/// The part that a value lies in; none for no number.
fn part(value: f64, ends: &[f64]) -> Option<usize> {
    let inner = ends.get(1..ends.len() - 1)?;
    value.is_finite().then(|| inner.partition_point(|end| *end <= value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_lies_in_the_part_whose_ends_hold_it() {
        let ends = [0.0, 1.0, 2.0, 3.0];
        let parts = [-5.0, 0.5, 1.0, 2.5, 9.0, f64::NAN].map(|value| part(value, &ends));
        assert_eq!(parts, [Some(0), Some(0), Some(1), Some(2), Some(2), None], "beyond the outer ends is within them");
    }
}
