//! Whether what a model leaves follows the motion: physics does, noise does not.
//!
//! The residual of each judged channel is regressed on the simulated motion and command, some powers and signs of them, each at
//! a few times before and after, on every other stretch of the runs; what the regression foretells of the stretches between
//! is structure. Noise of any colour, size or distribution, drift of a sensor and quantisation foretell nothing. So no figure of the noise's
//! size is needed to tell that something is missing, and a wrong one makes nothing up.

use crate::identify::data::{Channel, Run};
use crate::identify::evaluate::Predicted;
use nalgebra::{DMatrix, DVector};

/// Times before and after at which the motion is looked at, s.
const LAGS: [f64; 7] = [-0.1, -0.03, -0.01, 0.0, 0.01, 0.03, 0.1];
/// Length of a stretch, s.
const STRETCH: f64 = 1.5;
/// Most samples of a run that are looked at.
const SAMPLES: usize = 6000;
/// Weight that holds coefficients to zero, as a share of the regressors' own.
const RIDGE: f64 = 1e-3;
/// Features of one time.
const FEATURES: usize = 8;

/// How much of a residual follows the motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Structure {
    /// Mean square that is foretold, in units of the noise's.
    pub(super) foretold: f64,
    /// The same over its standard error, as deviations of a normal variable with the same chance of being exceeded.
    pub(super) certainty: f64,
}

impl Structure {
    /// True where something follows the motion beyond doubt.
    pub(super) fn is_certain(self) -> bool {
        self.certainty > CERTAIN && self.foretold > LEAST
    }
}

/// Normal deviates beyond which structure is no chance: one in a thousand.
const CERTAIN: f64 = 3.1;
/// Mean square, in units of the noise's, below which structure is nothing to speak of.
const LEAST: f64 = 0.01;

/// The structure of each judged channel that has samples enough to tell.
pub(super) fn structures(runs: &[Run], predicted: &[Predicted]) -> Vec<(Channel, Structure)> {
    let mut channels: Vec<Channel> = runs.iter().flat_map(super::residual::judged_channels).collect();
    channels.sort_unstable();
    channels.dedup();
    channels
        .into_iter()
        .filter_map(|channel| Some((channel, of_channel(runs.iter().zip(predicted), channel)?)))
        .collect()
}

/// One sample: its stretch, what was left and the features.
struct Row {
    stretch: usize,
    residual: f64,
    features: Vec<f64>,
}

/// The structure of one channel; none where it has too few samples to tell.
pub(super) fn of_channel<'a>(
    looks: impl Iterator<Item = (&'a Run, &'a Predicted)>,
    channel: Channel,
) -> Option<Structure> {
    let mut rows = Vec::new();
    for (run, predicted) in looks {
        let Some(residual) = super::residual::residual(run, predicted, channel) else { continue };
        let first = rows.last().map_or(0, |row: &Row| row.stretch + 1);
        rows.extend(rows_of(run, predicted, &residual, first));
    }
    let stretches = rows.last()?.stretch + 1;
    if stretches < 6 || rows.len() < 8 * FEATURES * LAGS.len() {
        return None;
    }
    standardise(&mut rows);
    let halves = [0, 1].map(|parity| fit(&rows, |stretch| stretch % 2 == parity));
    let mut gains = vec![0.0; stretches];
    let mut counts = vec![0.0; stretches];
    for row in &rows {
        let other = halves[(row.stretch + 1) % 2].as_ref()?;
        let foretold = other.dot(&DVector::from_column_slice(&row.features));
        gains[row.stretch] += row.residual.powi(2) - (row.residual - foretold).powi(2);
        counts[row.stretch] += 1.0;
    }
    let means: Vec<f64> = gains.iter().zip(&counts).filter(|(_, n)| **n > 0.0).map(|(g, n)| g / n).collect();
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    let spread = (means.iter().map(|g| (g - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    let certainty = normal_deviate(mean / (spread / n.sqrt()).max(f64::MIN_POSITIVE), n - 1.0);
    // A few stretches that hold nearly all of it are as good as many: their size speaks, not their number.
    let whole = gains.iter().sum::<f64>() / counts.iter().sum::<f64>();
    let power = rows.iter().map(|row| row.residual.powi(2)).sum::<f64>() / rows.len() as f64;
    let overwhelming = whole > 0.3 * power && whole > 1.0;
    Some(Structure { foretold: whole, certainty: if overwhelming { certainty.max(2.0 * CERTAIN) } else { certainty } })
}

/// The normal deviate that is exceeded as often as this value of Student's t with `freedom` degrees of freedom: a few stretches
/// scatter by chance as a normal variable does not.
///
/// Source: D. L. Wallace, "Bounds on normal approximations to Student's and the chi-square distributions", Annals of
/// Mathematical Statistics 30 (1959) 1121-1130.
fn normal_deviate(t: f64, freedom: f64) -> f64 {
    let factor = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    (factor * (freedom * (t * t / freedom).ln_1p()).sqrt()).copysign(t)
}

/// The rows of one run, thinned to what is looked at.
fn rows_of(run: &Run, predicted: &Predicted, residual: &[f64], first: usize) -> Vec<Row> {
    let n = run.len();
    let series = |channel: Channel| {
        run.measured.iter().position(|m| m.channel == channel).map(|i| predicted.channels[i].as_slice())
    };
    let place = series(Channel::Displacement).unwrap_or(&run.input);
    let command = series(Channel::Command).unwrap_or(&run.input);
    let length = ((STRETCH / run.dt) as usize).max(16);
    let step = n.div_ceil(SAMPLES).max(1);
    let lags = LAGS.map(|lag| (lag / run.dt).round() as i64);
    let at = |series: &[f64], k: i64| series.get(k.clamp(0, n as i64 - 1) as usize).copied().unwrap_or(0.0);
    // Rates over a few samples: what is simulated has no noise, what a recording drives has.
    let reach = ((0.004 / run.dt).round() as i64).max(1);
    let scale = |values: &dyn Fn(i64) -> f64| {
        let squares: f64 = (0..n as i64).step_by(7).map(|k| values(k).powi(2)).sum();
        (squares / n.div_ceil(7) as f64).sqrt().max(1e-300)
    };
    let speed = |k: i64| at(place, k + reach) - at(place, k - reach);
    let acceleration = |k: i64| at(place, k + reach) - 2.0 * at(place, k) + at(place, k - reach);
    let about = place.iter().sum::<f64>() / n as f64;
    let shown = |k: i64| at(place, k) - about;
    let sent = |k: i64| at(command, k);
    let (sx, sv, sa, su) = (scale(&shown), scale(&speed), scale(&acceleration), scale(&sent));
    let features = |k: i64| {
        let (x, v, a, u) = (shown(k) / sx, speed(k) / sv, acceleration(k) / sa, sent(k) / su);
        [x, v, a, u, (20.0 * v).tanh(), v * v.abs(), u * u * u, x * x]
    };
    let usable = |k: &usize| residual[*k].is_finite();
    let row = |k: usize| Row {
        stretch: first + k / length,
        residual: residual[k],
        features: lags.iter().flat_map(|lag| features(k as i64 + lag)).collect(),
    };
    (0..n).step_by(step).filter(usable).map(row).collect()
}

/// Takes the means off and makes every feature of size one.
fn standardise(rows: &mut [Row]) {
    let n = rows.len() as f64;
    let count = rows.first().map_or(0, |row| row.features.len());
    let level = rows.iter().map(|row| row.residual).sum::<f64>() / n;
    for row in rows.iter_mut() {
        row.residual -= level;
    }
    for i in 0..count {
        let mean = rows.iter().map(|row| row.features[i]).sum::<f64>() / n;
        let size = (rows.iter().map(|row| (row.features[i] - mean).powi(2)).sum::<f64>() / n).sqrt();
        let inverse = if size > 0.0 { 1.0 / size } else { 0.0 };
        for row in rows.iter_mut() {
            row.features[i] = (row.features[i] - mean) * inverse;
        }
    }
}

/// Ridge regression on the stretches that are taken.
fn fit(rows: &[Row], taken: impl Fn(usize) -> bool) -> Option<DVector<f64>> {
    let count = rows.first()?.features.len();
    let (mut matrix, mut right, mut n) = (DMatrix::<f64>::zeros(count, count), DVector::<f64>::zeros(count), 0.0);
    for row in rows.iter().filter(|row| taken(row.stretch)) {
        n += 1.0;
        for i in 0..count {
            right[i] += row.features[i] * row.residual;
            for j in i..count {
                matrix[(i, j)] += row.features[i] * row.features[j];
            }
        }
    }
    for i in 0..count {
        matrix[(i, i)] += RIDGE * n;
        for j in 0..i {
            matrix[(i, j)] = matrix[(j, i)];
        }
    }
    Some(matrix.cholesky()?.solve(&right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::data::Measured;
    use crate::plant::simulate::SimulatedLaw;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    const N: usize = 8000;
    const DT: f64 = 0.005;

    fn motion(k: usize) -> f64 {
        let t = k as f64 * DT;
        0.02 * (1.0 + (0.2 * t).sin()) * ((5.0 * t).sin() + 0.4 * (13.0 * t + 1.0).sin())
    }

    fn case(residual: impl Fn(usize, f64) -> f64, seed: u64) -> Structure {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || (0..12).map(|_| f64::from(random.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0;
        let model: Vec<f64> = (0..N).map(motion).collect();
        let values = model.iter().enumerate().map(|(k, x)| x + 1e-5 * residual(k, normal())).collect();
        let measured =
            Measured { channel: Channel::Displacement, values, noise: 1e-5, stated: Some(1e-5), judged: true };
        let run = Run {
            name: "a".into(),
            dt: DT,
            from: 0.0,
            elapsed: 0.0,
            ticks: 1,
            input: model.clone(),
            added: Vec::new(),
            law: SimulatedLaw::Pi { kp: 5.0, ki: 0.0 },
            shaping: crate::plant::simulate::Shaping::default(),
            loop_noise: None,
            sent_before: Vec::new(),
            moving_start: false,
            measured: vec![measured],
            motion: None,
            filter: None,
        };
        let predicted = Predicted { channels: vec![model], displacement: Vec::new() };
        structures(&[run], &[predicted])[0].1
    }

    #[test]
    fn noise_of_any_size_and_colour_has_none() {
        let false_alarms = (0..60).filter(|&seed| case(|_, e| 1.4 * e, seed).is_certain()).count();
        assert_eq!(false_alarms, 0);
        for seed in 0..20 {
            let past = std::cell::Cell::new(0.0);
            let coloured = |_: usize, e: f64| {
                past.set(0.95 * past.get() + e);
                past.get()
            };
            assert!(!case(coloured, seed).is_certain(), "{seed}");
        }
    }

    #[test]
    fn a_value_of_student_s_t_is_worth_its_tail() {
        // Upper tails of 0.1 %: t = 5.893, 4.144 and 3.174 with 5, 10 and 100 degrees of freedom; 3.090 for a normal variable.
        for (t, freedom) in [(5.893, 5.0), (4.144, 10.0), (3.174, 100.0)] {
            assert!((normal_deviate(t, freedom) - 3.09).abs() < 0.03, "{t}");
        }
        assert!(normal_deviate(-3.0, 10.0) < 0.0);
    }

    #[test]
    fn what_follows_the_motion_is_seen_far_below_the_noise() {
        let speed = |k: usize| (motion(k + 1) - motion(k)) / DT;
        for seed in 0..10 {
            assert!(case(|k, e| e + 0.4 * speed(k).signum(), seed).is_certain());
            assert!(case(|k, e| e + 20.0 * motion(k), seed).is_certain());
        }
    }
}
