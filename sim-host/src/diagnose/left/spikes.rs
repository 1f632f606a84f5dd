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

/// Adds the wrong samples of each run of which none are said yet.
pub(super) fn report(looks: &[Look], channel: Channel, findings: &mut Vec<SetUpFinding>) {
    for (run, predicted) in looks {
        let Some(left) = residual(run, predicted, channel) else { continue };
        let count = wrong(&left);
        let known = |f: &SetUpFinding| {
            f.what == Doubt::Outliers && f.channel == Some(channel.name()) && f.run.as_deref() == Some(&run.name)
        };
        if count > 0 && (count as f64) < MOST * left.len() as f64 && !findings.iter().any(known) {
            findings.push(SetUpFinding::outliers(channel.name(), &run.name, count));
        }
    }
}

/// How many samples are wrong and their neighbours right.
fn wrong(left: &[f64]) -> usize {
    let sizes: Vec<f64> = left.iter().map(|r| r.abs()).filter(|r| r.is_finite()).collect();
    if sizes.len() < 64 {
        return 0;
    }
    let usual = (1.4826 * quantile(&sizes, 0.5)).max(1.0);
    let single = |w: &&[f64]| {
        let (size, beside) = (w[2].abs(), [w[0], w[1], w[3], w[4]].iter().fold(0.0, |most: f64, r| most.max(r.abs())));
        size > FAR * usual && beside < (SUPPORTED * size).max(CHANCE * usual)
    };
    left.windows(5).filter(single).count()
}
