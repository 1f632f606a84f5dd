//! One recording under two names: what is fitted may not judge itself, nor count twice, whatever its file is called.

use super::error::{Place, Problem, RecordingError};
use super::run::{Run, Use};

/// Fewest samples that are no coincidence.
const LEAST: usize = 16;

/// Difference of two steps, as a share, that is the rounding of their stamps.
const ROUNDING: f64 = 1e-6;

/// Refuses an experiment that has the same samples in two runs: those of one file, of a copy, or of parts that overlap.
///
/// `places` are those of the runs' files in the experiment, in the order of the runs.
pub(super) fn refuse(runs: &[Run], places: &[Place]) -> Result<(), RecordingError> {
    for (k, (run, place)) in runs.iter().zip(places).enumerate() {
        let Some(first) = runs[..k].iter().find(|first| shares(first, run)) else { continue };
        let said = |run: &Run| if run.purpose == Use::Fit { "fitted" } else { "held out" };
        let whose = if first.path == run.path {
            "the same file is".to_owned()
        } else {
            format!("{} holds the same samples as {}, which is", run.name, first.name)
        };
        let problem = if first.purpose == run.purpose {
            format!(
                "{whose} {} above already, so that its samples would count twice; leave one out, or part them with `from_s` and `to_s`",
                said(run)
            )
        } else {
            format!(
                "{whose} {} above and {} here, so that it would judge itself; split it with `from_s` and `to_s`, or name another",
                said(first),
                said(run)
            )
        };
        return Err(place.clone().refuse(Problem::Contradiction(problem)));
    }
    Ok(())
}

/// Whether two runs hold the same samples at the same times, for as long as both last; or all the same, whatever their times.
fn shares(a: &Run, b: &Run) -> bool {
    let (Some(a0), Some(b0)) = (a.time.first(), b.time.first()) else { return false };
    // Steps are estimates from the stamps: those of a copy are the same but for their rounding.
    if (a.dt - b.dt).abs() > ROUNDING * a.dt {
        return false;
    }
    let apart = (b0 - a0) / a.dt;
    let overlap = (apart - apart.round()).abs() < 1e-3 && same(a, b, apart.round());
    overlap || (a.len() == b.len() && same(a, b, 0.0))
}

/// Whether two runs hold the same samples while both last, the one beginning so many samples after the other.
///
/// All that was measured must be the same to the last bit, and something must move: two tests of one reference share it and nothing
/// else, and two tables at rest share everything.
fn same(a: &Run, b: &Run, later: f64) -> bool {
    let (from_a, from_b) = (later.max(0.0) as usize, (-later).max(0.0) as usize);
    let shared = a.len().saturating_sub(from_a).min(b.len().saturating_sub(from_b));
    if shared < LEAST {
        return false;
    }
    let part = |samples: &[f64], from: usize| samples[from..from + shared].iter().map(|v| v.to_bits()).collect();
    let pairs: Vec<(Vec<u64>, Vec<u64>)> = a
        .channels
        .iter()
        .filter_map(|(channel, samples)| Some((part(samples, from_a), part(b.channel(channel)?, from_b))))
        .collect();
    let moves = |samples: &[u64]| samples.iter().any(|value| *value != samples[0]);
    pairs.iter().all(|(a, b)| a == b) && pairs.iter().any(|(a, _)| moves(a))
}
