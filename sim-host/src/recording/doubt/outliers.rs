//! Single samples that no neighbour supports.
//!
//! A sample is an outlier where it alone departs from the cubic through its two neighbours on either side by far more than
//! neighbouring samples do at that stretch of the run. Motion, impacts and chatter move more than one sample: there the
//! neighbours depart too. An outlier is dropped, as a lost sample is. Errors know nothing of the motion: what an accelerometer shows at
//! reversals and nowhere else are impacts, however short.

use super::{Doubt, SetUpFinding};
use crate::recording::channel::Channel;
use crate::recording::experiment::Experiment;
use crate::recording::run::Run;
use crate::recording::signal::{filled, slope};
use crate::recording::steps::quantisation_step;

/// Departure beyond which a sample is wrong, in robust standard deviations of the run's departures; an accelerometer feels impacts,
/// which may fill a sample or two, and a displacement cannot.
const FAR: f64 = 10.0;
const FAR_OF_PLACE: f64 = 6.5;
/// Departures that neighbours may have by chance, in the same.
const CHANCE: f64 = 4.0;
/// Departures of the neighbours beyond which it is motion, as a share of the sample's own, its own effect on them taken off.
const SUPPORTED: f64 = 0.25;
/// Share of its departure by which a wrong sample lies beyond what leads up to it and away from it: within it is a step.
const BEYOND: f64 = 0.5;
/// Samples on either side whose departures say what is usual at that stretch.
const AROUND: usize = 12;
/// Largest share of a run's samples that are single errors; with more it is something else.
const MOST: f64 = 0.01;

/// Samples after a wrong displacement in which what answers it through the loop is no error of another sensor.
const ANSWERS: usize = 3;

/// Standard errors by which the speed at what looks wrong is another than at all samples, for it to be the motion's.
const FOLLOWS: f64 = 4.0;

/// Drops outliers of every sensor.
pub(super) fn doubt(experiment: &mut Experiment) -> Vec<SetUpFinding> {
    const SENSORS: [Channel; 4] =
        [Channel::Displacement, Channel::Acceleration, Channel::Velocity, Channel::PressureDifference];
    let mut findings = Vec::new();
    let mut fed_back: Vec<Vec<usize>> = vec![Vec::new(); experiment.runs.len()];
    for channel in SENSORS {
        let far = if channel == Channel::Displacement { FAR_OF_PLACE } else { FAR };
        let places = |run: &Run| run.channel(channel).map_or_else(Vec::new, |samples| outliers(samples, far));
        let wrong: Vec<Vec<usize>> = experiment.runs.iter().map(places).collect();
        if channel == Channel::Acceleration && follow_motion(&experiment.runs, &wrong) {
            continue;
        }
        for ((run, wrong), fed_back) in experiment.runs.iter_mut().zip(&wrong).zip(&fed_back) {
            let Some(samples) = run.channel(channel).filter(|_| !wrong.is_empty()) else { continue };
            let mut kept = samples.to_vec();
            for &k in wrong {
                kept[k] = f64::NAN;
            }
            run.channels.set(channel, kept);
            // What a wrong displacement makes a loop do, the table does, and the other sensors are right to show it.
            let own =
                wrong.iter().filter(|&k| !fed_back.iter().any(|from| (*from..=from + ANSWERS).contains(k))).count();
            if own > 0 {
                let finding = SetUpFinding::new(Doubt::Outliers, own as f64, "samples").against(0.0);
                findings.push(finding.of_run(&run.name).of_channel(channel));
            }
        }
        if channel == Channel::Displacement {
            fed_back = wrong;
        }
    }
    findings
}

/// Whether samples stand where the table is slow, or where it is fast, more than chance has it: by the mean rank of their speeds among
/// those of all samples, which is uniform of what knows nothing of the motion.
fn follow_motion(runs: &[Run], places: &[Vec<usize>]) -> bool {
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for (run, places) in runs.iter().zip(places).filter(|(_, places)| !places.is_empty()) {
        let Some(x) = run.channel(Channel::Displacement) else { continue };
        let speeds: Vec<f64> = slope(&filled(x), run.dt).iter().map(|v| v.abs()).collect();
        let mut sorted = speeds.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let rank = |speed: f64| sorted.partition_point(|other| *other < speed) as f64 / sorted.len() as f64;
        sum += places.iter().map(|&k| rank(speeds[k]) - 0.5).sum::<f64>();
        count += places.len() as f64;
    }
    // A uniform variable has a variance of a twelfth.
    sum.abs() > FOLLOWS * (count / 12.0).sqrt()
}

/// Places of single wrong samples.
fn outliers(samples: &[f64], far: f64) -> Vec<usize> {
    let n = samples.len();
    if n < 64 {
        return Vec::new();
    }
    let whole = filled(samples);
    // Departure from the cubic through two neighbours on either side.
    let departure = |k: usize| whole[k] - (4.0 * (whole[k - 1] + whole[k + 1]) - (whole[k - 2] + whole[k + 2])) / 6.0;
    let departures: Vec<f64> = (0..n).map(|k| if k < 2 || k + 2 >= n { 0.0 } else { departure(k) }).collect();
    let mut sizes: Vec<f64> = departures.iter().map(|d| d.abs()).collect();
    let usual = 1.4826 * *sizes.select_nth_unstable_by(n / 2, f64::total_cmp).1;
    let step = quantisation_step(samples).unwrap_or(0.0);
    let chance = CHANCE * usual.max(step);
    let limit = far * usual.max(step).max(f64::MIN_POSITIVE);
    let single = |&k: &usize| {
        let d = departures[k];
        if d.abs() < limit || !samples[k].is_finite() {
            return false;
        }
        // An error e here makes -2/3 e and 1/6 e of its neighbours' departures; what is left of them is the signal's own.
        let left = |j: usize, weight: f64| (departures[j] + weight * d).abs();
        let near = left(k - 1, 2.0 / 3.0)
            .max(left(k + 1, 2.0 / 3.0))
            .max(left(k - 2, -1.0 / 6.0))
            .max(left(k + 2, -1.0 / 6.0));
        // Straight on from before and straight back from behind: a sample between the two is in the middle of a step.
        let sides = [2.0 * whole[k - 1] - whole[k - 2], 2.0 * whole[k + 1] - whole[k + 2]];
        let beyond = (whole[k] - sides[0].max(sides[1])).max(sides[0].min(sides[1]) - whole[k]);
        if beyond < BEYOND * d.abs() {
            return false;
        }
        let around = (k.saturating_sub(AROUND)..(k + AROUND + 1).min(n)).filter(|j| j.abs_diff(k) > 2);
        let local = around.map(|j| departures[j].abs()).fold(0.0, f64::max);
        near < (SUPPORTED * d.abs()).max(chance) && local < (0.5 * d.abs()).max(chance)
    };
    let found: Vec<usize> = (4..n.saturating_sub(4)).filter(single).collect();
    if found.len() as f64 > MOST * n as f64 { Vec::new() } else { found }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::doubt::tests::experiment;
    use crate::recording::law::{RecordedLaw, Shaping};

    fn smooth(n: usize) -> Vec<f64> {
        let noise = |k: usize| ((k * 7919 % 1000) as f64 / 1000.0 - 0.5) * 1e-3;
        (0..n).map(|k| (0.05 * k as f64).sin() + noise(k)).collect()
    }

    /// A wrong displacement makes the loop move the table, which the accelerometer shows: one error, of one sensor.
    #[test]
    fn what_answers_a_wrong_displacement_is_no_error() {
        let found = |late: usize| {
            let law = RecordedLaw::ProportionalIntegral { kp: 20.0, ki: 0.0 };
            let mut experiment = experiment(&law, Shaping::default(), 1);
            let run = &mut experiment.runs[0];
            let n = run.len();
            let with = |mut samples: Vec<f64>, at: usize| {
                samples[at] += 0.5;
                samples
            };
            run.channels.set(Channel::Displacement, with(smooth(n), 701));
            run.channels.set(Channel::Acceleration, with(smooth(n), 701 + late));
            let said = doubt(&mut experiment);
            let masked = experiment.runs[0].channel(Channel::Acceleration).unwrap()[701 + late].is_nan();
            (said.iter().filter_map(|f| f.channel).collect::<Vec<_>>(), masked)
        };
        assert_eq!(found(1), (vec!["displacement"], true));
        assert_eq!(found(9), (vec!["displacement", "acceleration"], true));
    }

    #[test]
    fn single_errors_are_found_where_they_are() {
        let mut samples = smooth(2000);
        for k in [100, 701, 1500] {
            samples[k] += 0.03;
        }
        assert_eq!(outliers(&samples, FAR), [100, 701, 1500]);
    }

    #[test]
    fn an_impact_that_rings_is_no_error() {
        let mut samples = smooth(2000);
        for k in 0..30 {
            samples[600 + k] += 0.1 * (-(k as f64) / 6.0).exp() * (k as f64 * 1.1).cos();
        }
        assert!(outliers(&samples, FAR).is_empty());
    }

    /// A table that runs into its speed limit between two samples.
    #[test]
    fn a_sample_within_a_step_is_no_error() {
        for share in [0.0, 0.05, 0.2, 0.5, 0.8, 0.95] {
            for size in [3e-3, 6e-3, 0.02, 0.05] {
                let mut samples = smooth(2000);
                samples.iter_mut().skip(900).for_each(|x| *x += size);
                samples[899] += share * size;
                assert!(outliers(&samples, FAR).is_empty(), "{size} {share}");
            }
        }
    }

    #[test]
    fn a_step_is_no_error() {
        let mut samples = smooth(2000);
        samples.iter_mut().skip(900).for_each(|x| *x += 0.05);
        assert!(outliers(&samples, FAR).is_empty());
    }

    /// Impacts at reversals are no errors, and errors wherever they fall are.
    #[test]
    fn what_stands_at_reversals_is_motion() {
        let law = RecordedLaw::ProportionalIntegral { kp: 1.0, ki: 0.0 };
        let mut run = experiment(&law, Shaping::default(), 1).runs.remove(0);
        let place = (0..run.len()).map(|k| (0.05 * k as f64).sin()).collect();
        run.channels.set(Channel::Displacement, place);
        let reversals = (0..40).map(|i| ((f64::from(i) + 0.5) * std::f64::consts::PI / 0.05) as usize).collect();
        let anywhere = (0..40).map(|i| 50 + 97 * i).collect();
        assert!(follow_motion(std::slice::from_ref(&run), &[reversals]));
        assert!(!follow_motion(std::slice::from_ref(&run), &[anywhere]));
    }
}
