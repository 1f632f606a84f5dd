//! Single samples that a model misses by far, and their neighbours not.

use super::rows::Look;
use crate::diagnose::residual::residual;
use crate::identify::data::Channel;
use crate::recording::signal::quantile;
use crate::recording::{Doubt, SetUpFinding};

/// Residual from which a sample is wrong, in standard deviations of its run, robust ones or those of the channel's noise where they are
/// larger, as of coarse counts; noise does not reach that.
const FAR: f64 = 10.0;
/// Residuals that its neighbours may have, as a share of its own, and by chance.
const SUPPORTED: f64 = 0.25;
const CHANCE: f64 = 4.0;
/// Largest share of a run's samples that are single errors; with more it is something else.
const MOST: f64 = 0.002;

/// Samples within which two sensors are wrong together: then it is what both of them measure.
const TOGETHER: usize = 2;

/// Adds the wrong samples of each run of which none are said yet, but for those that another of the `channels` judged shows too.
pub(super) fn report(looks: &[Look], channel: Channel, channels: &[Channel], findings: &mut Vec<SetUpFinding>) {
    for (run, predicted) in looks {
        let Some(left) = residual(run, predicted, channel) else { continue };
        let elsewhere = channels.iter().filter(|other| **other != channel);
        let elsewhere: Vec<usize> =
            elsewhere.filter_map(|other| Some(wrong(&residual(run, predicted, *other)?))).flatten().collect();
        let alone = |k: &usize| !elsewhere.iter().any(|other| other.abs_diff(*k) <= TOGETHER);
        let count = wrong(&left).into_iter().filter(alone).count();
        let known = |f: &SetUpFinding| {
            f.what == Doubt::Outliers && f.channel == Some(channel.name()) && f.run.as_deref() == Some(&run.name)
        };
        if count > 0 && (count as f64) < MOST * left.len() as f64 && !findings.iter().any(known) {
            findings.push(SetUpFinding::outliers(channel.name(), &run.name, count));
        }
    }
}

/// Places of samples that are wrong and their neighbours right.
fn wrong(left: &[f64]) -> Vec<usize> {
    let sizes: Vec<f64> = left.iter().map(|r| r.abs()).filter(|r| r.is_finite()).collect();
    if sizes.len() < 64 {
        return Vec::new();
    }
    let usual = (1.4826 * quantile(&sizes, 0.5)).max(1.0);
    let single = |w: &&[f64]| {
        let (size, beside) = (w[2].abs(), [w[0], w[1], w[3], w[4]].iter().fold(0.0, |most: f64, r| most.max(r.abs())));
        size > FAR * usual && beside < (SUPPORTED * size).max(CHANCE * usual)
    };
    left.windows(5).enumerate().filter(|(_, w)| single(w)).map(|(i, _)| i + 2).collect()
}
