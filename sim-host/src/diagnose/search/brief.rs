//! The beginnings of long runs, on which many models are looked at before few are fitted to all.
//!
//! A simulation starts where its run starts, so that a part from elsewhere would ask for states that nobody measured. Each run is
//! kept as far as its share of it says what the whole says: what a model leaves is there at about its mean, and at about its most.
//! Little that is left needs every sample: then there is no such beginning.

use super::super::residual::squares_in;
use super::CHANCE;
use crate::identify::data::Run;
use crate::identify::evaluate::{Local, predict};
use crate::identify::fit::Fit;
use crate::identify::model::Model;
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// Share of a run that is looked at at least, and samples of all runs.
const SHARE: f64 = 0.2;
const SAMPLES: f64 = 12_000.0;
/// Share beyond which the whole is no slower.
const WORTH: f64 = 0.6;
/// Share of the mean and of the most of what is left that a beginning must have.
const TYPICAL: f64 = 0.5;
/// Parts of a run in which what is left is summed.
const PARTS: usize = 50;
/// Squares beyond the noise, in gains of which chance makes one, that rank models by a beginning as by all.
const AMPLE: f64 = 30.0;

/// The beginning of each run that shows what this fit leaves; none where the runs are short or what is left is little.
pub(in crate::diagnose) fn brief(fit: &Fit, runs: &[Run]) -> Result<Option<Vec<Run>>, SimulateError> {
    beginnings(fit, runs, SAMPLES, SHARE)
}

/// The same of so many samples and this share of a run at least.
pub(in crate::diagnose) fn beginnings(
    fit: &Fit,
    runs: &[Run],
    least: f64,
    share: f64,
) -> Result<Option<Vec<Run>>, SimulateError> {
    let samples = runs.iter().map(Run::len).sum::<usize>() as f64;
    let share = (least / samples).max(share);
    if share > WORTH || fit.squares - (fit.rows as f64) < AMPLE * CHANCE {
        return Ok(None);
    }
    let ends = runs.par_iter().zip(&fit.locals).map(|(run, local)| beginning(&fit.model, run, local, share));
    let ends = ends.collect::<Result<Vec<f64>, SimulateError>>()?;
    let kept = runs.iter().zip(&ends).map(|(run, end)| end * run.len() as f64).sum::<f64>();
    if kept > WORTH * samples {
        return Ok(None);
    }
    let beginnings = runs.iter().zip(ends).map(|(run, end)| run.beginning((end * run.len() as f64) as usize));
    Ok(Some(beginnings.collect()))
}

/// The share of a run, `least` at least, that shows what a model leaves of the whole.
pub(in crate::diagnose) fn beginning(
    model: &Model,
    run: &Run,
    local: &Local,
    least: f64,
) -> Result<f64, SimulateError> {
    let predicted = predict(model, run, local)?;
    Ok(typical(&squares_in(run, &predicted, PARTS, |k| k * PARTS / run.len()), least))
}

/// The shortest beginning, as a share of all, that is typical of what is left.
fn typical(sums: &[f64], least: f64) -> f64 {
    let parts = sums.len() as f64;
    let mean = sums.iter().sum::<f64>() / parts;
    let most = sums.iter().copied().fold(0.0, f64::max);
    let (mut sum, mut largest) = (0.0, 0.0_f64);
    for (i, part) in sums.iter().enumerate() {
        sum += part;
        largest = largest.max(*part);
        let seen = (i + 1) as f64;
        if seen >= least * parts && sum >= TYPICAL * mean * seen && largest >= TYPICAL * most {
            return seen / parts;
        }
    }
    1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_beginning_reaches_to_what_is_left() {
        let even = vec![1.0; PARTS];
        assert!((typical(&even, 0.2) - 0.2).abs() < 1e-12);
        let mut once = even.clone();
        once[30] = 50.0;
        assert!((typical(&once, 0.2) - 31.0 / 50.0).abs() < 1e-12, "the moment that shows it is within");
        let late: Vec<f64> = (0..PARTS).map(|i| if i < 40 { 0.1 } else { 4.0 }).collect();
        assert!(typical(&late, 0.2) > 0.8, "what begins late is within");
    }
}
