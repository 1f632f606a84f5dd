//! The stretches of long recordings that say most, so that a search over hundreds of models ends.
//!
//! Of every run the stretch with the most motion of what drives it is kept, as long as its share of what is wanted. What a table
//! does at its limits is within it, and what it does always is too. A stretch that does not begin with its run starts in motion.

use super::channel::Channel;
use super::experiment::Experiment;
use super::run::Run;

/// Shortest stretch that is kept of any run, s.
const SHORTEST: f64 = 10.0;

/// The experiment with about so many samples of each purpose at most; none where it has no more than that.
pub fn excerpt(experiment: &Experiment, samples: usize) -> Option<Experiment> {
    let count = |run: &Run| experiment.runs.iter().filter(|r| r.purpose == run.purpose).map(Run::len).sum::<usize>();
    if experiment.runs.iter().all(|run| count(run) <= samples) {
        return None;
    }
    let shortened = |run: &Run| -> Run {
        let share = samples as f64 / count(run).max(1) as f64;
        let length = ((share * run.len() as f64) as usize).max((SHORTEST / run.dt) as usize);
        if length >= run.len() { run.clone() } else { strongest(run, length) }
    };
    Some(Experiment { runs: experiment.runs.iter().map(shortened).collect(), ..experiment.clone() })
}

/// The stretch of so many samples with the most motion of what drives the run.
fn strongest(run: &Run, length: usize) -> Run {
    let mut drives = [Channel::Reference, Channel::Displacement, Channel::Command].into_iter();
    let Some(driver) = drives.find_map(|channel| run.channel(channel)) else { return run.part(0, length) };
    let square = |k: usize| {
        let rate = driver[k] - driver[k.saturating_sub(1)];
        if rate.is_finite() { rate * rate } else { 0.0 }
    };
    let mut sum: f64 = (0..length).map(square).sum();
    let (mut most, mut from) = (sum, 0);
    for k in length..run.len() {
        sum += square(k) - square(k - length);
        // A stretch from the start needs no state of its own: a later one must have more to show.
        if sum > 1.05 * most {
            (most, from) = (sum, k + 1 - length);
        }
    }
    run.part(from, from + length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::doubt::tests::experiment;
    use crate::recording::law::{RecordedLaw, Shaping};

    #[test]
    fn the_stretch_with_the_most_motion_is_kept() {
        let mut experiment = experiment(&RecordedLaw::ProportionalIntegral { kp: 2.0, ki: 0.5 }, Shaping::default(), 1);
        let run = &mut experiment.runs[0];
        let mut quiet = run.channel(Channel::Reference).unwrap().to_vec();
        // Swells and fades: a step would be the strongest motion of all.
        let loud = |k: usize| (-((k as f64 - 5500.0) / 700.0).powi(2)).exp();
        quiet.iter_mut().enumerate().for_each(|(k, x)| *x *= loud(k));
        run.channels.set(Channel::Reference, quiet);
        let (whole, dt) = (run.len(), run.dt);
        assert!(excerpt(&experiment, whole).is_none());
        let short = excerpt(&experiment, whole / 2).unwrap();
        let kept = &short.runs[0];
        assert!(kept.len() >= (SHORTEST / dt) as usize && kept.len() < whole && kept.cut);
        let rates: Vec<f64> =
            experiment.runs[0].channel(Channel::Reference).unwrap().windows(2).map(|w| (w[1] - w[0]).powi(2)).collect();
        let motion = |from: usize| rates[from..(from + kept.len() - 1).min(rates.len())].iter().sum::<f64>();
        let most = (0..=whole - kept.len()).map(motion).fold(0.0, f64::max);
        let from = (kept.time[0] / dt).round() as usize;
        assert!(1.06 * motion(from) > most && motion(0) < 0.8 * most, "{} of {most}", motion(from));
    }
}
