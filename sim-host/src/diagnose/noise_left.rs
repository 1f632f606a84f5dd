//! The noise of each channel by what a model that explains the recordings leaves: what was stated of it, and whether it grows with
//! the motion.

use super::line::without_line;
use super::residual::{judged_channels, residual};
use super::verdict::Conclusion;
use crate::identify::data::{Channel, Run};
use crate::identify::evaluate::Predicted;
use crate::identify::judge::score;
use crate::identify::prepare::Prepared;
use crate::plant::simulate::SimulateError;
use crate::recording::signal::{curvature, deviation, mean, quantile};
use crate::recording::{Doubt, Experiment, SetUpFinding};

/// Factor between stated and found that is worth a word.
const WORTH: f64 = 1.02;
/// Standard errors beyond which it is no chance.
const CERTAIN: f64 = 5.0;
/// Factor by which the noise of the fastest quarter exceeds that of the slowest, that is worth a word.
const GROWTH: f64 = 1.12;
/// By how much second differences of white noise, which are alike, overstate their number: 1 + 2 (16 + 1) / 36.
const ALIKE: f64 = 1.94;
/// Blocks of a channel's samples whose mean squares are compared.
const BLOCKS: usize = 64;
/// Largest residuals left out, as a share: spikes are reported by themselves.
const TRIMMED: f64 = 0.002;

/// Adds what is found to the findings, in the place of what was thought of the noise before anything was explained.
pub(super) fn report(
    experiment: &Experiment,
    whole: &Prepared,
    conclusion: &Conclusion,
    findings: &mut Vec<SetUpFinding>,
) -> Result<(), SimulateError> {
    if conclusion.unlisted || conclusion.more_missing {
        return Ok(());
    }
    let fitted = score(&conclusion.accepted.fit.model, &whole.fit)?;
    let mut looks: Vec<(&Run, &Predicted)> = whole.fit.iter().zip(&fitted.predicted).collect();
    if conclusion.held_out {
        looks.extend(conclusion.judging.iter().zip(&conclusion.accepted.hold.predicted));
    }
    let mut channels: Vec<Channel> = whole.fit.iter().flat_map(judged_channels).collect();
    channels.sort_unstable();
    channels.dedup();
    for channel in channels.into_iter().filter(|c| *c != Channel::SupplyPressure) {
        let rows = rows(&looks, channel);
        let (Some(found), Some(noise)) = (power(rows.iter().map(|r| r.left)), noise_of(whole, channel)) else {
            continue;
        };
        if let Some(stated) = stated(experiment, channel) {
            let value = noise * found.sqrt();
            let std = uncertainty(&rows);
            findings.retain(|f| f.what != Doubt::Noise || f.channel != Some(channel.name()));
            if (value / stated).ln().abs() > WORTH.ln().max(CERTAIN * std) {
                findings.push(SetUpFinding::noise(channel.name(), stated, value, value * std, channel.unit()));
            }
        }
        if let Some((factor, std)) = growth(rows) {
            findings.push(SetUpFinding::noise_growth(channel.name(), factor - 1.0, std));
        }
    }
    Ok(())
}

fn noise_of(whole: &Prepared, channel: Channel) -> Option<f64> {
    whole.fit.iter().find_map(|run| run.channel(channel)).map(|m| m.noise)
}

/// What the experiment states of a channel's noise, where it does.
fn stated(experiment: &Experiment, channel: Channel) -> Option<f64> {
    experiment.runs.iter().find_map(|run| run.noise.get(channel.recorded()).copied())
}

/// A sample of a channel.
struct Row {
    /// Residual, in units of the noise.
    left: f64,
    /// Its second difference, in the same units: see [`differences`].
    difference: f64,
    /// Size of the motion that would shake it.
    motion: f64,
}

/// The samples of a channel in all runs that were recorded.
fn rows(looks: &[(&Run, &Predicted)], channel: Channel) -> Vec<Row> {
    let mut rows = Vec::new();
    for (run, predicted) in looks {
        let Some(left) = residual(run, predicted, channel) else { continue };
        // A hum is no noise, however large it is.
        let left = if channel == Channel::Acceleration { without_line(left, run.dt) } else { left };
        let Some(place) = run.measured.iter().position(|m| m.channel == channel) else { continue };
        let shown = &predicted.channels[place];
        let last = shown.len() - 1;
        let motion = |k: usize| match channel {
            Channel::Displacement => (shown[(k + 1).min(last)] - shown[k.saturating_sub(1)]).abs() / run.dt,
            _ => shown[k].abs(),
        };
        let both = left.iter().zip(differences(&left)).enumerate();
        let all = both.map(|(k, (&left, difference))| Row { left, difference, motion: motion(k) });
        rows.extend(all.filter(|row| row.left.is_finite()));
    }
    rows
}

/// Second differences of a residual, of the same mean square as white noise itself.
fn differences(left: &[f64]) -> Vec<f64> {
    curvature(left, 1.0).into_iter().map(|d| d / 6.0_f64.sqrt()).collect()
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

/// Standard deviation of the noise in the fastest quarter over that in the slowest, with its standard error, where it is worth a word. It is
/// taken from second differences: what a model lacks grows with the motion too, but varies slowly.
fn growth(mut rows: Vec<Row>) -> Option<(f64, f64)> {
    rows.retain(|row| row.difference.is_finite());
    rows.sort_unstable_by(|a, b| a.motion.total_cmp(&b.motion));
    let quarter = rows.len() / 4;
    let slow = power(rows[..quarter].iter().map(|r| r.difference))?;
    let fast = power(rows[rows.len() - quarter..].iter().map(|r| r.difference))?;
    let (factor, std) = ((fast / slow).sqrt(), (ALIKE / quarter as f64).sqrt());
    (factor > GROWTH.max(1.0 + CERTAIN * std)).then_some((factor, std))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::fit::tests::gauss;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;

    /// Samples at 1 kHz whose residual is this function of noise and motion.
    fn of(left: impl Fn(f64, f64) -> f64) -> Vec<Row> {
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
        let (grows, _) = growth(of(|noise, motion| noise * (1.0 + 0.5 * motion.abs()))).unwrap();
        assert!((1.3..1.55).contains(&grows), "{grows}");
        assert_eq!(growth(of(|noise, _| noise)), None);
        assert_eq!(growth(of(|noise, motion| noise + 3.0 * motion)), None);
    }
}
