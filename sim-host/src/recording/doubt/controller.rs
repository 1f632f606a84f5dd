//! Gains, feed-forward and delay of the controller, from what it made of reference and displacement.
//!
//! The recorded command is linear in the gains. Over all runs that state one law they are fitted by least squares, samples far
//! off left out once, and tested against the stated ones by their standard error, whose effective number of samples counts
//! the residual's correlation. Where the recording holds just what the controller saw, this finds a part in a thousand.

mod behind;

use super::replay::{Linear, gains};
use super::{Doubt, SetUpFinding};
use crate::recording::channel::Channel;
use crate::recording::experiment::Experiment;
use crate::recording::law::{RecordedLaw, Shaping};
use crate::recording::run::Run;
use crate::recording::signal::shifted;
use behind::{Behind, best, offset, restore_command};
use nalgebra::{DMatrix, DVector};

/// Standard errors beyond which a stated gain is not the one that ran.
const CERTAIN: f64 = 5.0;
/// Relative difference of a gain below which it is as stated: three written digits are no better.
const ROUNDED: f64 = 2e-3;
/// Relative difference below which it is taken as stated: the quartz of a clock is no better, and keeps a gain over a time off by as much.
const QUARTZ: f64 = 5e-5;
/// Share of the command's size that a law may leave unexplained and still be the law that ran.
const EXPLAINED: f64 = 0.1;
/// Share of the residual's power that a delay or a further term must leave at most to be believed.
const FAR_LESS: f64 = 0.25;
/// How far found gains may be from stated ones, as a factor: beyond it a unit is the likelier fault.
const FACTOR: f64 = 6.0;

/// A law fitted to the recorded commands of the runs that state it.
#[derive(Debug, Clone)]
struct Fitted {
    /// The gains that fit best.
    gains: Vec<f64>,
    /// Their standard errors.
    std: Vec<f64>,
    /// Mean square of what is left.
    power: f64,
    /// The same over the command's mean square.
    share: f64,
}

/// Fits each stated law and corrects it.
pub(super) fn doubt(experiment: &mut Experiment) -> Vec<SetUpFinding> {
    let mut findings = Vec::new();
    let mut seen: Vec<(RecordedLaw, Shaping)> = Vec::new();
    let laws: Vec<(RecordedLaw, Shaping)> = experiment.runs.iter().map(|run| (run.law.clone(), run.shaping)).collect();
    for (law, shaping) in laws {
        if seen.contains(&(law.clone(), shaping)) {
            continue;
        }
        seen.push((law.clone(), shaping));
        let same = |run: &Run| run.law == law && run.shaping == shaping;
        let Some(stated) = gains(&law) else { continue };
        let runs: Vec<&Run> = experiment.runs.iter().filter(|run| same(run)).collect();
        let Some((fitted, behind)) = best(&runs) else { continue };
        let Behind { delay, shift, lag } = behind;
        if fitted.share > EXPLAINED * EXPLAINED || !credible(stated, &fitted.gains) {
            continue;
        }
        let corrected = corrected(&law, &fitted);
        findings.extend(different(&law, &corrected, &fitted, &runs));
        // A lag and a part of a sample are known to their steps, and bend the gains by as much.
        if lag == 0.0 && delay.fract() == 0.0 {
            findings.extend(clock(&law, &fitted, runs[0].dt));
        }
        let feed = fitted.gains.get(2).zip(fitted.std.get(2));
        let kvf = feed.filter(|(kvf, std)| moved(shaping.kvf, **kvf, **std, QUARTZ)).map_or(shaping.kvf, |f| *f.0);
        if moved(shaping.kvf, kvf, 0.0, ROUNDED) {
            let finding = SetUpFinding::new(Doubt::ControllerKvf, kvf, "unit of u s per m").against(shaping.kvf);
            findings.push(finding.within(fitted.std.get(2).copied().unwrap_or(0.0)));
        }
        let late = delay.max(f64::from(-shift)) * runs[0].dt;
        if late > 0.0 {
            findings.push(SetUpFinding::new(Doubt::ControllerDelay, late, "s").against(0.0));
        }
        if shift > 0 {
            let found = f64::from(shift) * runs[0].dt;
            findings
                .push(SetUpFinding::new(Doubt::SampleShift, found, "s").against(0.0).of_channel(Channel::Displacement));
        }
        let dt = runs[0].dt;
        if lag > 0.0 {
            let finding = SetUpFinding::new(Doubt::SensorLag, lag * dt, "s").against(0.0);
            findings.push(finding.of_channel(Channel::Command));
        }
        let offset = offset(&runs, &fitted, behind);
        findings.extend(offset.map(|(found, std)| {
            SetUpFinding::new(Doubt::Offset, found, "unit of u").against(0.0).within(std).of_channel(Channel::Command)
        }));
        for run in experiment.runs.iter_mut().filter(|run| run.law == law && run.shaping == shaping) {
            restore_command(run, lag, offset.map_or(0.0, |offset| offset.0));
            run.law = corrected.clone();
            let (late_command, late_displacement) = (delay.round() as usize, (-shift).max(0) as usize);
            run.shaping = Shaping { kvf, late_command, late_displacement, ..shaping };
            // A displacement recorded late is moved; one that the controller sees late was recorded as it was.
            if shift > 0
                && let Some(x) = run.channel(Channel::Displacement)
            {
                let moved = shifted(x, shift);
                run.channels.set(Channel::Displacement, moved);
            }
        }
    }
    findings
}

/// True where what a law leaves is more than the writing of the numbers.
fn significant(share: f64) -> bool {
    share > 1e-8
}

/// True where found gains are those of the same law with other numbers.
fn credible(stated: [f64; 2], found: &[f64]) -> bool {
    let ratio = found[0] / stated[0];
    ratio.is_finite() && (1.0 / FACTOR..FACTOR).contains(&ratio)
}

/// The law with its fitted gains, each left as stated where it is not told apart from that.
fn corrected(law: &RecordedLaw, fitted: &Fitted) -> RecordedLaw {
    let pick = |stated: f64, i: usize| match (fitted.gains.get(i), fitted.std.get(i)) {
        (Some(&found), Some(&std)) if moved(stated, found, std, QUARTZ) => found,
        _ => stated,
    };
    with_gains(law, pick)
}

/// The law with other gains, each of the stated one and its place in a fit.
fn with_gains(law: &RecordedLaw, gain: impl Fn(f64, usize) -> f64) -> RecordedLaw {
    match law {
        RecordedLaw::ProportionalIntegral { kp, ki } => {
            RecordedLaw::ProportionalIntegral { kp: gain(*kp, 0), ki: gain(*ki, 1) }
        }
        RecordedLaw::Cascade { kp, kv } => {
            let (product, inner) = (gain(kp * kv, 0), gain(*kv, 1));
            RecordedLaw::Cascade { kp: product / inner, kv: inner }
        }
        other => other.clone(),
    }
}

/// True where a value is not the stated one: beyond its error, and by more than `least` of it.
fn moved(stated: f64, found: f64, std: f64, least: f64) -> bool {
    let away = (found - stated).abs();
    away > CERTAIN * std && away > least * stated.abs().max(1e-3 * found.abs())
}

/// The gains that are not as stated.
fn different(stated: &RecordedLaw, found: &RecordedLaw, fitted: &Fitted, runs: &[&Run]) -> Vec<SetUpFinding> {
    let rows: Vec<(Doubt, f64, f64, f64, &str)> = match (stated, found) {
        (
            RecordedLaw::ProportionalIntegral { kp, ki },
            RecordedLaw::ProportionalIntegral { kp: found_kp, ki: found_ki },
        ) => vec![
            (Doubt::ControllerKp, *kp, *found_kp, fitted.std[0], "unit of u per m"),
            (Doubt::ControllerKi, *ki, *found_ki, fitted.std[1], "unit of u per m s"),
        ],
        (RecordedLaw::Cascade { kp, kv }, RecordedLaw::Cascade { kp: found_kp, kv: found_kv }) => vec![
            (Doubt::ControllerKp, *kp, *found_kp, fitted.std[0] / kv.abs(), "1/s"),
            (Doubt::ControllerKv, *kv, *found_kv, fitted.std[1], "unit of u s per m"),
        ],
        _ => Vec::new(),
    };
    // A gain that moves the command by less than its last written digit is none to report.
    let told = |(_, stated, found, std, _): &(Doubt, f64, f64, f64, &str)| moved(*stated, *found, *std, ROUNDED);
    let finding = |(what, stated, found, std, unit): (Doubt, f64, f64, f64, &str)| {
        let finding = SetUpFinding::new(what, found, unit).against(stated).within(std);
        if runs.len() == 1 { finding.of_run(&runs[0].name) } else { finding }
    };
    rows.into_iter().filter(told).map(finding).collect()
}

/// The sampling period by a gain over a time that is off by less than gains are stated wrong by, where the other gain is what was stated.
fn clock(law: &RecordedLaw, fitted: &Fitted, dt: f64) -> Option<SetUpFinding> {
    let found = with_gains(law, |stated, i| fitted.gains.get(i).copied().unwrap_or(stated));
    let rate = law.factors_of(&found)?.clock_rate()?;
    let std = fitted.std[1] / fitted.gains[1].abs();
    let told = moved(1.0, 1.0 + rate, std, QUARTZ) && !moved(1.0, 1.0 + rate, std, ROUNDED);
    told.then(|| SetUpFinding { corrected: false, ..SetUpFinding::clock_rate(dt, dt * (1.0 + rate), Some(dt * std)) })
}

/// Least squares over runs; none where the terms do not determine the gains.
fn fit(runs: &[&Run], behind: Behind, feed_forward: bool) -> Option<Fitted> {
    let of = |run: &&Run| Linear::of(run, behind.shift, behind.delay, feed_forward);
    let linear = |run: &&Run| Some(of(run)?.lagged(behind.lag).without_trends());
    let mut parts: Vec<Linear> = runs.iter().filter_map(linear).collect();
    let n = parts.first()?.terms.len();
    let first = solve(&parts, n)?;
    // A spike in what was recorded must not pass for a gain.
    for part in &mut parts {
        let residual = part.residual(first.0.as_slice());
        let mut sizes: Vec<f64> = residual.iter().zip(&part.known).filter(|(_, k)| **k).map(|(r, _)| r.abs()).collect();
        if sizes.is_empty() {
            continue;
        }
        let middle = sizes.len() / 2;
        let limit = 8.0 * 1.4826 * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
        for (known, r) in part.known.iter_mut().zip(&residual) {
            *known &= r.abs() <= limit.max(1e-12);
        }
    }
    let (gains, inverse) = solve(&parts, n).or(Some(first))?;
    let (mut squares, mut count, mut size, mut inflation) = (0.0, 0.0, 0.0, 1.0_f64);
    for part in &parts {
        let residual = part.residual(gains.as_slice());
        let kept: Vec<f64> = residual.iter().zip(&part.known).filter(|(_, k)| **k).map(|(r, _)| *r).collect();
        squares += kept.iter().map(|r| r * r).sum::<f64>();
        size += part.command.iter().zip(&part.known).filter(|(_, k)| **k).map(|(u, _)| u * u).sum::<f64>();
        count += kept.len() as f64;
        inflation = inflation.max(correlation(&kept));
    }
    let power = squares / f64::max(count, 1.0);
    let std = (0..n).map(|i| (inverse[(i, i)].max(0.0) * power * inflation).sqrt()).collect();
    let share = squares / size.max(f64::MIN_POSITIVE);
    Some(Fitted { gains: gains.iter().copied().collect(), std, power, share })
}

/// Gains and the inverse of their normal matrix.
fn solve(parts: &[Linear], n: usize) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let (mut matrix, mut right) = (DMatrix::<f64>::zeros(n, n), DVector::<f64>::zeros(n));
    for part in parts {
        for (k, _) in part.known.iter().enumerate().filter(|(_, known)| **known) {
            for i in 0..n {
                right[i] += part.terms[i][k] * part.command[k];
                for j in 0..n {
                    matrix[(i, j)] += part.terms[i][k] * part.terms[j][k];
                }
            }
        }
    }
    let scale: Vec<f64> = (0..n).map(|i| matrix[(i, i)].sqrt()).collect();
    if scale.iter().any(|s| !s.is_normal()) {
        return None;
    }
    let scaled = DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / (scale[i] * scale[j]));
    let inverse = scaled.cholesky()?.inverse();
    let inverse = DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (scale[i] * scale[j]));
    Some((&inverse * right, inverse))
}

/// One plus twice the sum of the correlations over a second's neighbours, while they are positive.
fn correlation(residual: &[f64]) -> f64 {
    let power: f64 = residual.iter().map(|r| r * r).sum::<f64>().max(f64::MIN_POSITIVE);
    let lagged = |lag: usize| residual.iter().zip(residual.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>() / power;
    1.0 + 2.0 * (1..=200.min(residual.len() / 4)).map(lagged).take_while(|r| *r > 0.02).sum::<f64>()
}
