//! Random motion for a required spectrum, as it is and with its velocity clipped.

use super::super::super::condition::{Recipe, Step};
use super::super::super::fit::Limits;
use super::super::super::resample::Interpolation;
use super::super::super::{Motion, peak};
use super::super::synthesise::sines;
use super::super::{QualifyError, Requirement, Shape, Standard};
use super::reached;
use realfft::RealFftPlanner;

/// Rounds of clipping and correcting.
const ROUNDS: usize = 24;
/// Points an octave at which the spectrum is corrected.
const POINTS: f64 = 12.0;
/// Points looked at for each of those.
const BETWEEN: usize = 4;
/// Share of a limit that clipping leaves.
const ROOM: f64 = 0.96;

/// 5 s of rise, 24 of full strength and 5 of decay, at six samples a cycle at least.
fn shape(standard: &Standard) -> Shape {
    Shape { rate: (6.0 * standard.band.1).max(200.0).ceil(), rise: 5.0, hold: 24.0, decay: 5.0 }
}

/// Random motion without what lies far below the lowest frequency judged, which costs stroke and gives nothing.
pub(super) fn plain(asked: Requirement<'_>, margin: f64, seed: u64) -> Result<Motion, QualifyError> {
    let shape = shape(asked.standard);
    let made = sines(asked, margin, &shape, seed)?;
    Ok(settled(Motion::from_acceleration(1.0 / shape.rate, made), asked.lowest))
}

/// The motion with rest at either end and without drift.
fn settled(motion: Motion, lowest: f64) -> Motion {
    let steps =
        vec![Step::Rest { before_s: 1.0, after_s: 2.0 }, Step::HighPassMotion { corner_hz: 0.35 * lowest, order: 2 }];
    Recipe { steps }.apply_to(motion.clone()).unwrap_or(motion)
}

/// The same with its velocity clipped and its spectrum corrected, in rounds; the last motion within the limits whose spectrum came
/// nearest, else the last.
pub(super) fn clipped(asked: Requirement<'_>, margin: f64, limits: &Limits, seed: u64) -> Result<Motion, QualifyError> {
    let motion = plain(asked, margin, seed)?;
    rounds(motion, asked, margin, limits, false)
}

/// A record, brought to the rate that the standard needs, its spectrum corrected in the same way.
pub(super) fn corrected_from(
    record: &Motion,
    asked: Requirement<'_>,
    margin: f64,
    limits: &Limits,
) -> Result<Motion, QualifyError> {
    let step = Step::Resample { rate_hz: shape(asked.standard).rate, between: Interpolation::Linear };
    let motion = step.apply(record.clone()).unwrap_or_else(|_| record.clone());
    rounds(settled(motion, asked.lowest), asked, margin, limits, true)
}

/// Rounds of clipping and correcting: the first motion that reaches the spectrum, or, where it is to come `near`, the one of all rounds
/// that passes it by least in the mean.
fn rounds(
    mut motion: Motion,
    asked: Requirement<'_>,
    margin: f64,
    limits: &Limits,
    near: bool,
) -> Result<Motion, QualifyError> {
    let Requirement { standard, required, lowest } = asked;
    // What lies between the points of the correction is looked at where the motion is to lie near above the spectrum.
    let each = if near { BETWEEN } else { 1 };
    let points = POINTS * each as f64;
    let count = ((standard.band.1 / lowest).log2() * points).ceil() as usize;
    let frequencies: Vec<f64> = (0..=count).map(|k| lowest * (k as f64 / points).exp2()).collect();
    let wanted: Vec<f64> = frequencies.iter().map(|f| 1.01 * margin * required.at(*f).unwrap_or(0.0)).collect();
    let corrected_at: Vec<f64> = frequencies.iter().copied().step_by(each).collect();
    let mut best: Option<(f64, Motion)> = None;
    for _ in 0..ROUNDS {
        let mut held = within(&motion, limits, lowest);
        let got = reached(&held.acceleration, held.dt, required.damping, &frequencies)?;
        let mut ratios: Vec<f64> = got.iter().zip(&wanted).map(|(g, w)| g / w).collect();
        if near {
            touch(&mut held, &mut ratios, limits);
        }
        let worth = worth(&ratios);
        if super::used(&held, limits) <= 1.0 && best.as_ref().is_none_or(|(b, _)| worth > *b) {
            best = Some((worth, held.clone()));
            if worth >= 1.0 && !near {
                break;
            }
        }
        let correction: Vec<f64> = ratios.iter().step_by(each).map(|ratio| ratio.powf(-0.8).clamp(0.6, 1.6)).collect();
        motion = corrected(&held, &corrected_at, &correction);
    }
    Ok(best.map_or(motion, |(_, motion)| motion))
}

/// What reached over wanted is worth: the least of it where that is below one; above it the more, the nearer it is in the mean.
fn worth(ratios: &[f64]) -> f64 {
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let over = ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64;
    if least >= 1.0 { 1.0 + (-over).exp() } else { least }
}

/// Scales a motion so that its spectrum, which grows with it, just touches what is wanted, where the limits allow it.
fn touch(motion: &mut Motion, ratios: &mut [f64], limits: &Limits) {
    let factor = (1.0 + 1e-9) / ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let scaled = motion.scaled(factor);
    if factor.is_finite() && super::used(&scaled, limits) <= 1.0 {
        *motion = scaled;
        for ratio in ratios {
            *ratio *= factor;
        }
    }
}

/// The motion with its velocity clipped, smoothed again and without drift; scaled where that is not enough.
fn within(motion: &Motion, limits: &Limits, lowest: f64) -> Motion {
    let mut held = motion.clone();
    for _ in 0..3 {
        let limit = ROOM * limits.velocity;
        // A soft corner: what is clipped hard rings at frequencies that the table follows worst.
        let soft = |v: f64| limit * (v / limit) / (1.0 + (v / limit).abs().powi(8)).powf(0.125);
        let velocity: Vec<f64> = held.velocity.iter().map(|v| soft(*v)).collect();
        let acceleration = super::super::super::central_difference(&velocity, held.dt);
        held = settled_in_place(Motion::from_acceleration(held.dt, acceleration), lowest);
    }
    let used = super::used(&held, limits);
    if used > 1.0 { held.scaled(0.999 / used) } else { held }
}

fn settled_in_place(motion: Motion, lowest: f64) -> Motion {
    let step = Step::HighPassMotion { corner_hz: 0.35 * lowest, order: 2 };
    step.apply(motion.clone()).unwrap_or(motion)
}

/// The motion with its amplitudes multiplied, frequency by frequency, by what is interpolated between points; beyond them the last.
fn corrected(motion: &Motion, frequencies: &[f64], factors: &[f64]) -> Motion {
    let count = motion.len();
    let size = (count + (4.0 / motion.dt) as usize).next_power_of_two();
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, inverse) = (planner.plan_fft_forward(size), planner.plan_fft_inverse(size));
    let mut padded = motion.acceleration.clone();
    padded.resize(size, 0.0);
    let mut bins = forward.make_output_vec();
    // The buffers are made for these plans: their lengths cannot be wrong.
    let _ = forward.process(&mut padded, &mut bins);
    for (i, bin) in bins.iter_mut().enumerate() {
        *bin *= between(frequencies, factors, i as f64 / (size as f64 * motion.dt));
    }
    let mut out = inverse.make_output_vec();
    if let Some(first) = bins.first_mut() {
        first.im = 0.0;
    }
    if let Some(last) = bins.last_mut() {
        last.im = 0.0;
    }
    let _ = inverse.process(&mut bins, &mut out);
    let acceleration: Vec<f64> = out.iter().take(count).map(|x| x / size as f64).collect();
    if peak(&acceleration).is_finite() { Motion::from_acceleration(motion.dt, acceleration) } else { motion.clone() }
}

fn between(frequencies: &[f64], factors: &[f64], frequency: f64) -> f64 {
    let after = frequencies.partition_point(|f| *f <= frequency);
    match (after.checked_sub(1), factors.get(after)) {
        (None, _) => factors.first().copied().unwrap_or(1.0),
        (Some(i), None) => factors.get(i).copied().unwrap_or(1.0),
        (Some(i), Some(next)) => {
            let share = (frequency / frequencies[i]).ln() / (frequencies[after] / frequencies[i]).ln();
            factors[i] + (next - factors[i]) * share
        }
    }
}
