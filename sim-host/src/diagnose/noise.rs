//! The scale of each channel's noise, which no laboratory knows to five per cent.
//!
//! What a model cannot follow shows where the table rests and between neighbouring samples; physics that is missing shows in
//! slower swings that follow the motion. So the scale is taken from the differences of neighbouring residuals of the stated
//! model and, where the table rests, from the residual there, within what a stated figure may be wrong by.

use super::residual::spectrum;
use crate::identify::data::{Channel, Measured, Run};
use crate::identify::evaluate::predict;
use crate::identify::fit::Fit;
use crate::identify::prepare::Prepared;
use crate::identify::stated::fit_stated;
use crate::plant::simulate::SimulateError;
use crate::recording::SetUpFinding;

/// Factor by which a stated figure may be below the truth at most: beyond it a residual is more than noise.
const BELOW: f64 = 2.0;
/// Factor by which it may be above.
const ABOVE: f64 = 20.0;
/// Factor that is worth a word.
const WORTH: f64 = 1.08;
/// Samples on either side over which motion is averaged to tell rest from motion, s.
const WINDOW: f64 = 0.25;

/// The scale of one channel's noise.
struct Scale {
    channel: Channel,
    factor: f64,
    std: f64,
    stated: f64,
}

/// Scales the noise of every judged channel to what the residual of the stated model shows, in all runs alike; what else was
/// prepared of the same experiment is scaled with it.
pub(super) fn rescale(prepared: &mut Prepared, whole: &mut Prepared) -> Result<Vec<SetUpFinding>, SimulateError> {
    let fit = fit_stated(prepared)?;
    let mut findings = Vec::new();
    for scale in scales(prepared, &fit)? {
        for of in [&mut *prepared, &mut *whole] {
            let measured = of.fit.iter_mut().chain(&mut of.holdout).flat_map(|run| &mut run.measured);
            measured.filter(|m| m.channel == scale.channel).for_each(|m| m.noise *= scale.factor);
        }
        let away = scale.factor.ln().abs();
        if away > WORTH.ln().max(4.0 * scale.std) {
            let (stated, found) = (scale.stated, scale.stated * scale.factor);
            let (name, unit) = (scale.channel.name(), scale.channel.unit());
            findings.push(SetUpFinding::noise(name, stated, found, found * scale.std, unit));
        }
    }
    Ok(findings)
}

/// One scale a judged channel, over all runs that are fitted.
fn scales(prepared: &Prepared, fit: &Fit) -> Result<Vec<Scale>, SimulateError> {
    let mut residuals: Vec<(Channel, [Vec<Vec<f64>>; 2], f64)> = Vec::new();
    for (run, local) in prepared.fit.iter().zip(&fit.locals) {
        let predicted = predict(&fit.model, run, local)?;
        for (measured, series) in run.measured.iter().zip(&predicted.channels).filter(|(m, _)| m.judged) {
            let (residual, raw) = (residual(measured, series), residual(measured, &vec![0.0; series.len()]));
            match residuals.iter_mut().find(|(channel, ..)| *channel == measured.channel) {
                Some((_, all, _)) => {
                    all[0].push(residual);
                    all[1].push(raw);
                }
                None => residuals.push((measured.channel, [vec![residual], vec![raw]], measured.noise)),
            }
        }
    }
    let resting: Vec<Vec<bool>> = prepared.fit.iter().map(at_rest).collect();
    let of = |(channel, [left, raw], stated): (Channel, [Vec<Vec<f64>>; 2], f64)| {
        scale(channel, &left, &raw, &resting, stated)
    };
    Ok(residuals.into_iter().filter_map(of).collect())
}

fn residual(measured: &Measured, series: &[f64]) -> Vec<f64> {
    measured.values.iter().zip(series).map(|(y, m)| (y - m) / measured.noise).collect()
}

/// The factor of a channel's noise. Neighbouring differences are the least that it can be, for coloured noise has more between
/// them; all that the stated model leaves is the most. A figure between the two is left as it was stated. Where the table
/// rests, what is left there is the noise.
fn scale(
    channel: Channel,
    residuals: &[Vec<f64>],
    raw: &[Vec<f64>],
    resting: &[Vec<bool>],
    stated: f64,
) -> Option<Scale> {
    let (least, count) = differences(residuals)?;
    let least = differences(raw).map_or(least, |(raw, _)| raw.min(least));
    let least = between_lines(residuals).map_or(least, |floor| floor.min(least));
    let pressure = matches!(channel, Channel::PressureDifference | Channel::SupplyPressure);
    let rest = if pressure { None } else { at_rest_power(residuals, resting) };
    let most = everywhere(residuals);
    let power = rest.map_or_else(|| 1.0_f64.clamp(least.min(most), most), |rest| rest.max(least).min(most.max(least)));
    let factor = power.sqrt().clamp(1.0 / ABOVE, BELOW * least.sqrt().max(1.0));
    Some(Scale { channel, factor, std: (1.5 / count).sqrt(), stated })
}

/// Mean square of white noise with these samples' differences, and how many there are; none for too few.
///
/// A sensor's noise is about as large at all times. Where the differences come in bursts they are blows and turning points, and the noise
/// is what the quietest stretches have.
fn differences(series: &[Vec<f64>]) -> Option<(f64, f64)> {
    let each: Vec<Vec<f64>> = series.iter().map(|r| r.windows(5).map(difference).collect()).collect();
    let mut fourth: Vec<f64> = each.iter().flatten().copied().filter(|d| d.is_finite()).collect();
    if fourth.len() < 200 {
        return None;
    }
    fourth.sort_unstable_by(f64::total_cmp);
    // Impacts and turning points are not noise: the largest hundredth is left out.
    let kept = &fourth[..fourth.len() * 99 / 100];
    let all = kept.iter().sum::<f64>() / kept.len() as f64 / TRIMMED / 70.0;
    Some((quiet(&each).map_or(all, |quiet| quiet.min(all)), fourth.len() as f64))
}

/// The same of the quietest stretches, where half of all are far louder; none where the noise is about as large at all times.
fn quiet(each: &[Vec<f64>]) -> Option<f64> {
    let stretches = each.iter().flat_map(|series| series.chunks_exact(BURST));
    let mut powers: Vec<f64> = stretches.map(|d| d.iter().sum::<f64>() / BURST as f64 / 70.0).collect();
    powers.retain(|power| power.is_finite());
    powers.sort_unstable_by(f64::total_cmp);
    let (low, middle) = (*powers.get(powers.len() / 10)?, *powers.get(powers.len() / 2)?);
    (powers.len() >= FEWEST_STRETCHES && middle > LOUDER * low).then_some(low / QUIETEST)
}

/// Power of white noise that the upper half of the band holds between its lines: a hum is no noise, however large it is.
fn between_lines(residuals: &[Vec<f64>]) -> Option<f64> {
    let longest = residuals.iter().max_by_key(|r| r.len())?;
    let size = (longest.len() / 4).next_power_of_two().min(2048);
    let mut upper = spectrum(longest, size).split_off(size / 4);
    if longest.len() < 1000 || upper.is_empty() {
        return None;
    }
    let middle = upper.len() / 2;
    Some(*upper.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Mean square of all residuals.
fn everywhere(residuals: &[Vec<f64>]) -> f64 {
    let all = || residuals.iter().flatten().filter(|r| r.is_finite());
    all().map(|r| r * r).sum::<f64>() / (all().count() as f64).max(1.0)
}

/// Mean square of a unit normal's squares without the largest hundredth.
const TRIMMED: f64 = 0.924;
/// Differences of a stretch, how many stretches say something, by how much half of them are louder than a tenth where noise is not what
/// they hold, and where that tenth lies where a quarter of them has white noise of one alone.
const BURST: usize = 50;
const FEWEST_STRETCHES: usize = 20;
const LOUDER: f64 = 4.0;
const QUIETEST: f64 = 0.9;

fn difference(w: &[f64]) -> f64 {
    (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).powi(2)
}

/// Mean square of the residual about its mean where the table rests; none for too few samples.
fn at_rest_power(residuals: &[Vec<f64>], resting: &[Vec<bool>]) -> Option<f64> {
    let mut powers = Vec::new();
    for (residual, resting) in residuals.iter().zip(resting) {
        let kept: Vec<f64> =
            residual.iter().zip(resting).filter(|(r, rest)| **rest && r.is_finite()).map(|(r, _)| *r).collect();
        powers.extend(kept.chunks_exact(CHUNK).map(|chunk| {
            let mean = chunk.iter().sum::<f64>() / CHUNK as f64;
            chunk.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / (CHUNK - 1) as f64
        }));
    }
    // What moves at rest moves for moments: the median chunk has none of it.
    powers.sort_unstable_by(f64::total_cmp);
    (powers.len() >= FEWEST).then(|| powers[powers.len() / 2])
}

/// Samples whose scatter is taken together, and how many such chunks say something.
const CHUNK: usize = 100;
const FEWEST: usize = 4;

/// Samples around which the input stands still to a thousandth of its range.
fn at_rest(run: &Run) -> Vec<bool> {
    let n = run.len();
    let (low, high) = run.input.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    let still = 1e-4 * (high - low);
    let reach = ((WINDOW / run.dt) as usize).max(4);
    // A sum of how often the input moves makes any window's count a difference.
    let mut moved = vec![0usize; n + 1];
    for k in 0..n {
        let before = run.input[k.saturating_sub(1)];
        moved[k + 1] = moved[k] + usize::from((run.input[k] - before).abs() > still * run.dt / WINDOW);
    }
    (0..n).map(|k| moved[(k + reach).min(n)] == moved[k.saturating_sub(4 * reach)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    fn white(seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (0..6000)
            .map(|_| (0..12).map(|_| f64::from(random.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0)
            .collect()
    }

    /// Blows of a gap that opens and shuts are as broad as noise and many times its size: what the quietest stretches show is the noise.
    #[test]
    fn blows_are_no_noise() {
        for seed in 0..20 {
            let blow = |k: usize| if k % 60 < 3 && k > 1500 { 15.0 } else { 0.0 };
            let struck: Vec<f64> = white(seed).iter().enumerate().map(|(k, e)| e * (1.0 + blow(k))).collect();
            let (power, _) = differences(std::slice::from_ref(&struck)).unwrap();
            assert!((power.sqrt() - 1.0).abs() < 0.15, "{seed}: {}", power.sqrt());
            assert!(everywhere(&[struck]).sqrt() > 2.0);
        }
    }

    /// Noise that is about as large at all times is measured on all of it.
    #[test]
    fn steady_noise_is_measured_on_all_samples() {
        for seed in 0..20 {
            let (power, _) = differences(&[white(seed)]).unwrap();
            assert!((power.sqrt() - 1.0).abs() < 0.04, "{seed}: {}", power.sqrt());
            let grown: Vec<f64> =
                white(seed).iter().enumerate().map(|(k, e)| e * if k % 400 < 200 { 1.3 } else { 1.0 }).collect();
            assert!(quiet(&[grown.windows(5).map(difference).collect()]).is_none());
        }
    }
}
