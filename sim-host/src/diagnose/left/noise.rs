//! The noise of each channel: what was stated of it, and whether it grows with the motion.

use super::rows::{Look, Row, rows};
use crate::identify::data::Channel;
use crate::recording::signal::{deviation, mean, quantile};
use crate::recording::{Doubt, Experiment, SetUpFinding};

/// Factor between stated and found that is worth a word.
const WORTH: f64 = 1.02;
/// Standard errors beyond which it is no chance.
const CERTAIN: f64 = 5.0;
/// Factor by which the noise of the fastest quarter exceeds that of the slowest, that is worth a word.
const GROWTH: f64 = 1.12;
/// The same beyond which it is no noise: impacts that a model misses grow so.
const MOST_GROWTH: f64 = 4.0;
/// By how much second differences of white noise, which are alike, overstate their number: 1 + 2 (16 + 1) / 36.
const ALIKE: f64 = 1.94;
/// Parts of a channel's samples, by their motion, whose noises a line is laid through.
const PARTS: usize = 16;
/// Blocks of a channel's samples whose mean squares are compared.
const BLOCKS: usize = 64;
/// Largest residuals left out, as a share: spikes are reported by themselves.
const TRIMMED: f64 = 0.002;
/// Samples of a stretch, and the share of the stretches with the least motion that say what colour the noise has.
const STRETCH: usize = 64;
const QUIET: f64 = 0.25;
/// Factor between a residual and its second differences up to which it is white, and nothing but noise whatever the model lacks.
const WHITE: f64 = 1.03;

/// Adds what is found of a channel whose residuals are counted in a noise. What is not white is coloured noise, or something that the
/// model lacks: where the table is quiet it is the noise's colour.
pub(super) fn report(
    experiment: &Experiment,
    looks: &[Look],
    (channel, noise): (Channel, f64),
    lacking: impl FnOnce() -> bool,
    findings: &mut Vec<SetUpFinding>,
) {
    let mut rows = rows(looks, channel);
    let is_white = is_white(&rows);
    let growth = growth(&rows).filter(|_| is_white || !lacking());
    if growth.is_some_and(|(factor, _)| factor > MOST_GROWTH) {
        return;
    }
    if let Some((factor, std)) = growth {
        findings.push(SetUpFinding::noise_growth(channel.name(), factor - 1.0, std));
    }
    if !is_white {
        as_coloured_at_rest(&mut rows);
    }
    let (Some(found), Some(stated)) = (power(rows.iter().map(|r| r.left)), stated(experiment, channel)) else { return };
    let value = noise * found.sqrt();
    if growth.is_some() {
        at_rest(&mut rows);
    }
    // The colour is that of a part of the samples.
    let std = uncertainty(&rows) * if is_white { 1.0 } else { (1.0 / QUIET).sqrt() };
    findings.retain(|f| f.what != Doubt::Noise || f.channel != Some(channel.name()));
    if (value / stated).ln().abs() > WORTH.ln().max(CERTAIN * std) {
        findings.push(SetUpFinding::noise(channel.name(), stated, value, value * std, channel.unit()));
    }
}

/// Puts second differences, made as large as the noise's colour makes residuals beside them where the table is quiet, in the place of
/// residuals.
fn as_coloured_at_rest(rows: &mut Vec<Row>) {
    rows.retain(|row| row.difference.is_finite());
    let mut stretches: Vec<&[Row]> = rows.chunks(STRETCH).collect();
    stretches.sort_by(|a, b| mean_motion(*a).total_cmp(&mean_motion(*b)));
    let quiet = ((stretches.len() as f64 * QUIET) as usize).max(1).min(stretches.len());
    let at_rest = colour(stretches[..quiet].iter().flat_map(|stretch| stretch.iter())).unwrap_or(1.0);
    let colour = at_rest.max(1.0).min(colour(rows.iter()).unwrap_or(1.0));
    for row in rows {
        row.left = colour * row.difference;
    }
}

/// What the experiment states of a channel's noise, where it does.
fn stated(experiment: &Experiment, channel: Channel) -> Option<f64> {
    experiment.runs.iter().find_map(|run| run.noise.get(channel.recorded()).copied())
}

/// Whether a residual is as large as its second differences say.
fn is_white(rows: &[Row]) -> bool {
    colour(rows.iter()).is_some_and(|colour| colour < WHITE)
}

/// Residuals over their second differences, by their root mean squares; none of too few.
fn colour<'a>(rows: impl Iterator<Item = &'a Row> + Clone) -> Option<f64> {
    let differences = power(rows.clone().map(|r| r.difference).filter(|d| d.is_finite()))?;
    Some((power(rows.map(|r| r.left))? / differences).sqrt())
}

/// Mean square without the largest.
fn power(residuals: impl Iterator<Item = f64>) -> Option<f64> {
    let mut squares: Vec<f64> = residuals.map(|r| r * r).collect();
    squares.sort_unstable_by(f64::total_cmp);
    let kept = (squares.len() as f64 * (1.0 - TRIMMED)) as usize;
    // Without its largest 0.2 % a normal variable's square is 0.977 on average.
    (kept > 200).then(|| squares[..kept].iter().sum::<f64>() / kept as f64 / 0.977)
}

/// Relative standard error of a channel's noise, from the scatter of its mean square over blocks. Neighbours that are alike and stretches that
/// are louder raise it; other channels do not. A spike counts as the largest residual that is kept.
fn uncertainty(rows: &[Row]) -> f64 {
    let squares: Vec<f64> = rows.iter().map(|r| r.left * r.left).collect();
    let largest = quantile(&squares, 1.0 - TRIMMED);
    let kept: Vec<f64> = squares.into_iter().map(|square| square.min(largest)).collect();
    let blocks: Vec<f64> = kept.chunks(kept.len().div_ceil(BLOCKS).max(1)).map(mean).collect();
    0.5 * deviation(&blocks) / (blocks.len() as f64).sqrt() / mean(&blocks)
}

/// The rows by their motion, the slowest first, without those that have no second difference.
fn by_motion(rows: &[Row]) -> Vec<&Row> {
    let mut sorted: Vec<&Row> = rows.iter().filter(|row| row.difference.is_finite()).collect();
    sorted.sort_unstable_by(|a, b| a.motion.total_cmp(&b.motion));
    sorted
}

/// Standard deviation of the noise in the fastest quarter over that in the slowest, with its standard error, where it is worth a word. It is
/// taken from second differences: what a model lacks grows with the motion too, but varies slowly. Impacts do not, and are few: the
/// median must grow as well.
fn growth(rows: &[Row]) -> Option<(f64, f64)> {
    let sorted = by_motion(rows);
    let quarter = sorted.len() / 4;
    let sizes = |part: &[&Row]| part.iter().map(|row| row.difference.abs()).collect::<Vec<f64>>();
    let [slow, fast] = [&sorted[..quarter], &sorted[sorted.len() - quarter..]].map(sizes);
    let [quiet, loud] = [&slow, &fast].map(|part| power(part.iter().copied()));
    let usual = [&slow, &fast].map(|part| quantile(part, 0.5));
    let (by_power, std) = ((loud? / quiet?).sqrt(), (ALIKE / quarter as f64).sqrt());
    // Of coarse counts more than half may differ by nothing.
    let factor = if usual[0] > 0.0 { by_power.min(usual[1] / usual[0]) } else { by_power };
    (factor > GROWTH.max(1.0 + CERTAIN * std)).then_some((factor, std))
}

/// Residuals less what the motion adds to their noise, which grows along a line: `1 + k m`, m the motion. They scatter alike then, and say
/// how well the noise is known.
fn at_rest(rows: &mut [Row]) {
    let sorted = by_motion(rows);
    // Weighted sums of a line: a part's standard deviation is known to a share of itself.
    let (mut w, mut m, mut mm, mut s, mut ms) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for part in sorted.chunks(sorted.len().div_ceil(PARTS).max(1)) {
        let Some(power) = power(part.iter().map(|r| r.difference)) else { continue };
        let motion = mean_motion(part.iter().copied());
        let (size, weight) = (power.sqrt(), 1.0 / power);
        w += weight;
        m += weight * motion;
        mm += weight * motion * motion;
        s += weight * size;
        ms += weight * motion * size;
    }
    let determinant = w * mm - m * m;
    let (rest, slope) = ((mm * s - m * ms) / determinant, (w * ms - m * s) / determinant);
    let growth = slope / rest;
    if growth.is_finite() && growth > 0.0 && rest > 0.0 {
        for row in rows {
            row.left /= 1.0 + growth * row.motion;
        }
    }
}

fn mean_motion<'a>(part: impl IntoIterator<Item = &'a Row>) -> f64 {
    let (sum, count) = part.into_iter().fold((0.0, 0.0_f64), |(sum, count), row| (sum + row.motion, count + 1.0));
    sum / count.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::super::rows::differences;
    use super::*;
    use crate::identify::fit::tests::gauss;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;

    /// Samples at 1 kHz whose residual is this function of noise and motion.
    fn of(mut left: impl FnMut(f64, f64) -> f64) -> Vec<Row> {
        let mut noise = ChaCha8Rng::seed_from_u64(7);
        let motion: Vec<f64> = (0..20_000).map(|k| (f64::from(k) * 1e-3 * std::f64::consts::TAU * 2.0).sin()).collect();
        let left: Vec<f64> = motion.iter().map(|m| left(gauss(&mut noise), *m)).collect();
        let all = left.iter().zip(differences(&left)).zip(&motion);
        all.map(|((&left, difference), motion)| Row { left, difference, motion: motion.abs() }).collect()
    }

    /// White noise is known as its number of samples says, coloured noise worse, and a spike takes nothing from either.
    #[test]
    fn noise_is_as_certain_as_its_blocks_scatter() {
        let white = of(|noise, _| noise);
        let expected = (0.5 / white.len() as f64).sqrt();
        assert!((0.7..1.4).contains(&(uncertainty(&white) / expected)), "{}", uncertainty(&white) / expected);
        let mut spiked = of(|noise, _| noise);
        spiked[5000].left = 300.0;
        assert!((uncertainty(&spiked) / uncertainty(&white) - 1.0).abs() < 0.05);
        let mut last = 0.0;
        let mut coloured = of(|noise, _| noise);
        for row in &mut coloured {
            last = 0.95 * last + row.left;
            row.left = last;
        }
        assert!(uncertainty(&coloured) > 2.5 * expected, "{}", uncertainty(&coloured) / expected);
    }

    /// Noise whose size follows the motion is told by its growth; noise that does not, and what a model lacks, are not.
    #[test]
    fn noise_that_grows_is_told_from_what_a_model_lacks() {
        let (grows, _) = growth(&of(|noise, motion| noise * (1.0 + 0.5 * motion.abs()))).unwrap();
        assert!((1.3..1.55).contains(&grows), "{grows}");
        assert_eq!(growth(&of(|noise, _| noise)), None);
        assert_eq!(growth(&of(|noise, motion| noise + 3.0 * motion)), None);
    }

    /// Less what the motion adds the noise is the sensor's at rest.
    #[test]
    fn what_the_motion_adds_is_taken_off() {
        let mut rows = of(|noise, motion| 1.3 * noise * (1.0 + 0.8 * motion.abs()));
        at_rest(&mut rows);
        let found = power(rows.iter().map(|r| r.left)).unwrap().sqrt();
        assert!((found / 1.3 - 1.0).abs() < 0.04, "{found}");
    }

    /// A misfit beneath white noise is no part of it, and is seen not to be white.
    #[test]
    fn what_a_model_lacks_is_not_white() {
        assert!(is_white(&of(|noise, _| noise)));
        assert!(!is_white(&of(|noise, motion| noise + 0.5 * motion)));
    }

    /// Nor do impacts, which are few, make a noise that grows.
    #[test]
    fn impacts_at_speed_are_no_noise() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let impact = |motion: f64, chance: f64| if motion.abs() > 0.9 && chance > 2.5 { 15.0 } else { 0.0 };
        let rows = of(|noise, motion| noise + impact(motion, gauss(&mut random)));
        let slow = power(rows.iter().filter(|r| r.motion < 0.5).map(|r| r.difference));
        let fast = power(rows.iter().filter(|r| r.motion > 0.9).map(|r| r.difference));
        assert!(fast.zip(slow).is_some_and(|(fast, slow)| fast > 1.3 * slow));
        assert_eq!(growth(&rows), None);
    }

    /// Coloured noise beneath what a model lacks at speed is found by its colour at rest.
    #[test]
    fn coloured_noise_is_told_from_what_a_model_lacks() {
        let mut last = 0.0;
        let coloured = |noise: f64, motion: f64| {
            last = 0.5 * last + noise;
            last + 12.0 * (motion.abs() - 0.6).max(0.0) * motion.signum()
        };
        let mut rows = of(coloured);
        let size = |rows: &[Row]| power(rows.iter().map(|r| r.left)).map_or(0.0, f64::sqrt);
        let with_misfit = size(&rows);
        as_coloured_at_rest(&mut rows);
        let noise = (1.0_f64 - 0.25).sqrt().recip();
        assert!(with_misfit > 2.0 * noise);
        assert!((size(&rows) / noise - 1.0).abs() < 0.1, "{} of {noise}", size(&rows));
    }
}
