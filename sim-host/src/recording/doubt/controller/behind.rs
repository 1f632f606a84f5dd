//! How the recorded command comes behind the law that made it: late, with the displacement shifted, through a low-pass, with an offset.

use super::super::replay::Linear;
use super::{CERTAIN, FAR_LESS, Fitted, correlation, fit, significant};
use crate::recording::channel::Channel;
use crate::recording::lag::undone;
use crate::recording::law::RecordedLaw;
use crate::recording::run::Run;
use crate::recording::signal::filled;

/// Delays that are tried of every law, samples; and the longest of one that leaves much, s.
const SHORT: i32 = 3;
const LONGEST: f64 = 0.025;
/// Share of the command's power that a law leaves from which longer delays and a lag are tried.
const MUCH: f64 = 1e-4;
/// Longest lag that is tried, s, and how many in all.
const LONGEST_LAG: f64 = 0.05;
const LAGS: i32 = 24;
/// Share of the command's size below which its offset is left alone.
const LEAST_OFFSET: f64 = 1e-3;

/// How the recorded command comes behind its law, samples.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Behind {
    /// The whole law late, by parts of a sample too.
    pub(super) delay: f64,
    /// The displacement earlier.
    pub(super) shift: i32,
    /// Time of a low-pass of first order.
    pub(super) lag: f64,
}

/// The law as it fits best: as recorded, unless a delay, a shift of the displacement or a lag leaves far less.
pub(super) fn best(runs: &[&Run]) -> Option<(Fitted, Behind)> {
    let first = runs.first()?;
    let stated_feed = first.shaping.kvf != 0.0;
    let plain = fit(runs, Behind::default(), stated_feed)?;
    let most = if plain.share > MUCH { ((LONGEST / first.dt) as i32).clamp(SHORT, 100) } else { SHORT };
    let delays = (1..=most).map(|delay| Behind { delay: f64::from(delay), ..Behind::default() });
    let shifts = [1, 2, -1, -2, -3].into_iter().map(|shift| Behind { shift, ..Behind::default() });
    let tried = delays.chain(shifts).filter_map(|behind| Some((fit(runs, behind, stated_feed)?, behind)));
    let least = tried.min_by(|a, b| a.0.power.total_cmp(&b.0.power));
    let mut best = match least {
        Some(other) if other.0.power < FAR_LESS * plain.power && significant(plain.share) => other,
        _ => (plain, Behind::default()),
    };
    let between = |part: i32| Behind { delay: best.1.delay + 0.1 * f64::from(part), ..best.1 };
    let parts =
        (-5..=5).map(between).filter(|behind| best.1.delay > 0.0 && significant(best.0.share) && behind.delay > 0.0);
    let finer = parts.filter_map(|behind| Some((fit(runs, behind, stated_feed)?, behind)));
    if let Some(finer) =
        finer.min_by(|a, b| a.0.power.total_cmp(&b.0.power)).filter(|f| f.0.power < FAR_LESS * best.0.power)
    {
        best = finer;
    }
    // What looks late may be slow.
    if significant(best.0.share)
        && (best.0.share > MUCH || best.1.delay > 0.0)
        && let Some(lagged) = lagged(runs, stated_feed).filter(|lagged| lagged.0.power < FAR_LESS * best.0.power)
    {
        best = lagged;
    }
    if stated_feed {
        return Some(best);
    }
    match fit(runs, best.1, true) {
        Some(fed) if fed.power < FAR_LESS * best.0.power && significant(best.0.share) => Some((fed, best.1)),
        _ => Some(best),
    }
}

/// The law behind the lag that fits best.
fn lagged(runs: &[&Run], stated_feed: bool) -> Option<(Fitted, Behind)> {
    let longest = LONGEST_LAG / runs.first()?.dt;
    let tried = |lag: f64| {
        let behind = Behind { lag, ..Behind::default() };
        Some((fit(runs, behind, stated_feed)?, behind))
    };
    let less = |a: &(Fitted, Behind), b: &(Fitted, Behind)| a.0.power.total_cmp(&b.0.power);
    let ratio = (longest / 0.25).max(1.0).powf(f64::from(LAGS).recip());
    let coarse = (0..=LAGS).filter_map(|i| tried(0.25 * ratio.powi(i))).min_by(less)?;
    let near = |best: (Fitted, Behind), step: f64| {
        let lag = best.1.lag;
        (-10..=10).filter_map(|i| tried(lag * ratio.powf(step * f64::from(i)))).min_by(less)
    };
    near(near(coarse, 0.1)?, 0.01)
}

/// What the recorded command is more than the law makes, and its standard error, where the law has no integral that would hold it.
pub(super) fn offset(runs: &[&Run], fitted: &Fitted, behind: Behind) -> Option<(f64, f64)> {
    let feed = fitted.gains.len() > 2;
    let (mut sum, mut count, mut size) = (0.0, 0.0, 0.0);
    let mut inflation = 1.0_f64;
    for run in runs.iter().filter(|run| matches!(run.law, RecordedLaw::Cascade { .. })) {
        let linear = Linear::of(run, behind.shift, behind.delay, feed)?.lagged(behind.lag);
        let residual = linear.residual(&fitted.gains);
        let kept: Vec<f64> = residual.iter().zip(&linear.known).filter(|(_, k)| **k).map(|(r, _)| *r).collect();
        size += linear.command.iter().map(|u| u * u).sum::<f64>();
        let mean = kept.iter().sum::<f64>() / kept.len().max(1) as f64;
        inflation = inflation.max(correlation(&kept.iter().map(|r| r - mean).collect::<Vec<_>>()));
        sum += kept.iter().sum::<f64>();
        count += kept.len() as f64;
    }
    let (mean, size) = (sum / count, (size / count).sqrt());
    let std = (fitted.power * inflation / count).sqrt();
    (mean.abs() > CERTAIN * std && mean.abs() > LEAST_OFFSET * size).then_some((mean, std))
}

/// The command as it was sent: without the low-pass and the offset of its recording.
pub(super) fn restore_command(run: &mut Run, lag: f64, offset: f64) {
    if lag == 0.0 && offset == 0.0 {
        return;
    }
    let Some(command) = run.channel(Channel::Command) else { return };
    let sent = undone(&filled(command), lag);
    let sent = command.iter().zip(sent).map(|(u, sent)| if u.is_finite() { sent - offset } else { f64::NAN }).collect();
    run.channels.set(Channel::Command, sent);
}
