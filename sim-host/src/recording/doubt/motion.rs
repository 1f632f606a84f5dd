//! The accelerometer against the displacement beside it, where the measured motion drives the model.
//!
//! A force balance takes both as they are, and no residual of it shows what is wrong with one of them for what it is. The transfer
//! function from the displacement's second derivative to the acceleration, `H(w) = g exp(-j w d) / (1 + j w T)`, is fitted where the
//! two are coherent: gain `g`, lag `T` (s) and delay `d` (s). The displacement is the standard.

use super::{Doubt, SetUpFinding};
use crate::recording::channel::Channel;
use crate::recording::check::{Bin, delay_over, spectra_of};
use crate::recording::experiment::Experiment;
use crate::recording::lag::undone;
use crate::recording::model::Baseline;
use crate::recording::run::Run;
use crate::recording::signal::{Spectra, filled};
use crate::scalar::earlier;
use nalgebra::{Matrix3, Vector3};
use realfft::num_complex::Complex64;
use std::f64::consts::TAU;

/// Length of a segment (s): lines of specimens are narrower than their neighbours' means, tables move at 1 Hz and above.
const SEGMENT: f64 = 2.5;
/// Coherence from which the phase of a frequency counts, which noise scatters and does not move; and its gain, which noise of either
/// channel moves by no more than some per cent then.
const COHERENT: f64 = 0.5;
const CLEAN: f64 = 0.95;
/// Frequencies that count (Hz): below, an accelerometer tilts with its table; above, a displacement's second derivative is noise.
const BAND: std::ops::Range<f64> = 1.0..25.0;
/// Fewest frequencies that tell a lag from a delay.
const FEWEST: usize = 8;
/// Fewest that tell a gain.
const FEWEST_CLEAN: usize = 3;
/// Standard deviations from which a value is another than the stated one.
const CERTAIN: f64 = 4.0;
/// Standard deviation of a good sensor's gain over its band, as a logarithm: no frequencies average it out.
const FLAT: f64 = 0.005;
/// Samples from which a delay matters.
const LATE: f64 = 0.25;
/// Longest lag that is looked for (s), and the steps to it.
const LONGEST: f64 = 0.05;
const STEPS: i32 = 1000;
/// Neighbouring bins share a Hann window, so about half of them count.
const SHARED: f64 = 2.0;

/// The transfer function as fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Transfer {
    /// Logarithm of the gain, and its standard deviation.
    log_gain: f64,
    log_gain_std: f64,
    /// Lag (s), zero where the data do not ask for one, and its standard deviation.
    lag: f64,
    lag_std: f64,
    /// Delay (s), and its standard deviation.
    delay: f64,
    delay_std: f64,
}

/// Finds gain, lag and delay over all runs, which one sensor recorded, and takes them off.
pub(super) fn doubt(experiment: &mut Experiment) -> Vec<SetUpFinding> {
    if !matches!(experiment.model.baseline, Baseline::ForceBalance(_)) {
        return Vec::new();
    }
    let Some(found) = pooled(&experiment.runs).and_then(|spectra| transfer(&spectra)) else { return Vec::new() };
    let is_other = found.log_gain.abs() > CERTAIN * found.log_gain_std;
    let gain = if is_other { found.log_gain.exp() } else { 1.0 };
    let mut findings = Vec::new();
    if found.lag > 0.0 {
        findings.push(SetUpFinding::new(Doubt::SensorLag, found.lag, "s").against(0.0).within(found.lag_std));
    }
    if is_other {
        let std = gain * found.log_gain_std;
        findings.push(SetUpFinding::new(Doubt::SensorGain, gain, "1").against(1.0).within(std));
    }
    let dt = experiment.runs.first().map_or(0.0, |run| run.dt);
    let is_late = found.delay.abs() > (LATE * dt).max(CERTAIN * found.delay_std);
    let delay = if is_late { found.delay } else { 0.0 };
    if is_late {
        findings.push(SetUpFinding::new(Doubt::SampleShift, delay, "s").against(0.0).within(found.delay_std));
    }
    if !findings.is_empty() {
        experiment.runs.iter_mut().for_each(|run| correct(run, gain, found.lag, delay));
    }
    findings.into_iter().map(|finding| finding.of_channel(Channel::Acceleration)).collect()
}

/// The acceleration as a sensor of gain one, without a lag and on time, would have shown it.
fn correct(run: &mut Run, gain: f64, lag: f64, delay: f64) {
    let Some(a) = run.channel(Channel::Acceleration).filter(|a| !a.is_empty()) else { return };
    let undone: Vec<f64> = undone(&filled(a), lag / run.dt).iter().map(|a| a / gain).collect();
    let corrected: Vec<f64> = a.iter().zip(undone).map(|(a, u)| if a.is_finite() { u } else { f64::NAN }).collect();
    run.channels.set(Channel::Acceleration, earlier(&corrected, delay / run.dt));
}

/// Spectra over all runs of one rate.
fn pooled(runs: &[Run]) -> Option<Spectra> {
    let dt = runs.first()?.dt;
    let segment = (SEGMENT / dt).round() as usize;
    let mut sum: Option<Spectra> = None;
    for run in runs.iter().filter(|run| (run.dt / dt - 1.0).abs() < 1e-6 && run.len() >= segment) {
        let (Some(x), Some(a)) = (run.channel(Channel::Displacement), run.channel(Channel::Acceleration)) else {
            continue;
        };
        let one = spectra_of(x, a, dt, 2, segment);
        sum = Some(sum.map_or_else(|| one.clone(), |sum| together(sum, &one)));
    }
    sum
}

/// Two averages as one, weighted by their segments.
fn together(mut sum: Spectra, other: &Spectra) -> Spectra {
    let all = (sum.segments + other.segments).max(1) as f64;
    let (own, more) = (sum.segments as f64 / all, other.segments as f64 / all);
    for k in 0..sum.frequency.len().min(other.frequency.len()) {
        sum.input[k] = own * sum.input[k] + more * other.input[k];
        sum.output[k] = own * sum.output[k] + more * other.output[k];
        sum.cross[k] = sum.cross[k] * own + Complex64::from(more) * other.cross[k];
    }
    sum.segments += other.segments;
    sum
}

/// The transfer function of coherent frequencies; none where they are too few, or do not belong together.
fn transfer(spectra: &Spectra) -> Option<Transfer> {
    let used = |k: &usize| BAND.contains(&spectra.frequency[*k]) && spectra.coherence(*k) > COHERENT;
    let bins: Vec<Bin> = (0..spectra.frequency.len()).filter(used).map(|k| Bin::of(spectra, k, 2)).collect();
    let clean = bins.iter().filter(|bin| by_gain(bin) > 0.0).count();
    if bins.len() < FEWEST || clean < FEWEST_CLEAN {
        return None;
    }
    let mut delay = delay_over(&bins);
    let mut best = Fitted::with(&bins, 0.0, delay);
    let straight = best;
    let step = LONGEST / f64::from(STEPS);
    for i in 1..=STEPS {
        let fitted = Fitted::with(&bins, step * f64::from(i), delay - step);
        delay = fitted.delay;
        if fitted.squares < best.squares {
            best = fitted;
        }
    }
    let degrees = (bins.len() + clean - 3) as f64;
    let scatter = SHARED * best.squares / degrees;
    let lags = best.lag > 0.0 && straight.squares - best.squares > CERTAIN * CERTAIN * scatter;
    let chosen = if lags { best } else { straight };
    let scatter = SHARED * chosen.squares / degrees;
    let covariance = chosen.information(&bins, lags).try_inverse()? * scatter;
    // Whose noise it is that makes the two incoherent is not known: it may have moved the gain either way.
    let weights: f64 = bins.iter().map(by_gain).sum();
    let moved = bins.iter().map(|b| by_gain(b) * 0.5 * (1.0 / b.weight).ln_1p()).sum::<f64>() / weights;
    let is_same = chosen.log_gain.abs() < 2.0_f64.ln();
    is_same.then(|| Transfer {
        log_gain: chosen.log_gain,
        log_gain_std: covariance[(0, 0)].sqrt().hypot(moved).hypot(FLAT),
        lag: chosen.lag,
        lag_std: covariance[(2, 2)].sqrt(),
        delay: chosen.delay,
        delay_std: covariance[(1, 1)].sqrt(),
    })
}

/// Weight of a frequency's gain.
fn by_gain(bin: &Bin) -> f64 {
    if bin.weight > CLEAN / (1.0 - CLEAN) { bin.weight } else { 0.0 }
}

/// Gain and delay that fit best beside a lag, and the weighted squares left.
#[derive(Debug, Clone, Copy)]
struct Fitted {
    log_gain: f64,
    delay: f64,
    lag: f64,
    squares: f64,
}

impl Fitted {
    /// For a lag (s), with the delay (s) near one that is known.
    fn with(bins: &[Bin], lag: f64, near: f64) -> Self {
        let angle = |b: &Bin| TAU * b.frequency;
        let size = |b: &Bin| b.gain.ln() + 0.5 * (angle(b) * lag).powi(2).ln_1p();
        let phase = |b: &Bin| {
            let away = b.phase + (angle(b) * lag).atan() + angle(b) * near;
            away - TAU * (away / TAU).round()
        };
        let sum = |of: &dyn Fn(&Bin) -> f64| bins.iter().map(of).sum::<f64>();
        let log_gain = sum(&|b| by_gain(b) * size(b)) / sum(&by_gain);
        let later = sum(&|b| b.weight * angle(b) * phase(b)) / sum(&|b| b.weight * angle(b).powi(2));
        let left =
            |b: &Bin| by_gain(b) * (size(b) - log_gain).powi(2) + b.weight * (phase(b) - later * angle(b)).powi(2);
        let squares = sum(&left);
        Self { log_gain, delay: near - later, lag, squares }
    }

    /// Normal matrix of gain, delay and lag; without a lag of one that is known.
    fn information(&self, bins: &[Bin], lags: bool) -> Matrix3<f64> {
        let mut matrix = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, if lags { 0.0 } else { f64::MAX.sqrt() }));
        for bin in bins {
            let angle = TAU * bin.frequency;
            let share = (1.0 + (angle * self.lag).powi(2)).recip();
            let by_lag = if lags { 1.0 } else { 0.0 };
            let gain = Vector3::new(1.0, 0.0, -by_lag * angle * angle * self.lag * share);
            let phase = Vector3::new(0.0, -angle, -by_lag * angle * share);
            matrix += gain * gain.transpose() * by_gain(bin) + phase * phase.transpose() * bin.weight;
        }
        matrix
    }
}

#[cfg(test)]
mod tests;
