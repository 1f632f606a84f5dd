//! How often intervals hold the truth: one model, fresh noise by seed, white or coloured.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;
use shakedown::blocks::identify::{
    Channel, Effort, Fit, Local, Measured, Model, ModelEffect, NINETY, Run, SignalScales, Value, predict, profiles,
};
use shakedown::blocks::plant::{Kind, SimulatedLaw, entry};

const DT: f64 = 0.005;
const SECONDS: f64 = 15.0;
const TRUTH: [f64; 4] = [0.69, 138.0, 57.65, 0.242];
const BIAS: f64 = 1e-3;
const NOISE: [f64; 2] = [2e-5, 0.2];

/// Intervals that held the truth, of how many, for one parameter.
#[derive(Debug, Clone, Default)]
pub(crate) struct Count {
    /// The parameter.
    pub(crate) name: String,
    /// Profile intervals that held it.
    pub(crate) profile: usize,
    /// Intervals from the standard deviation that held it.
    pub(crate) normal: usize,
    /// Intervals made.
    pub(crate) of: usize,
}

/// Fits `seeds` sets of two runs each, their noise `x[k] = colour x[k-1] + e[k]` of the stated standard deviation.
pub(crate) fn count(seeds: u64, colour: f64) -> Vec<Count> {
    let clean: Vec<Run> = (0..2).map(run).collect();
    let made: Vec<Vec<(String, bool, bool)>> =
        (0..seeds).into_par_iter().map(|seed| one(&clean, seed, colour)).collect();
    let mut counts: Vec<Count> = Vec::new();
    for (name, profile, normal) in made.into_iter().flatten() {
        let place = counts.iter().position(|c| c.name == name).unwrap_or_else(|| {
            counts.push(Count { name, ..Count::default() });
            counts.len() - 1
        });
        counts[place].of += 1;
        counts[place].profile += usize::from(profile);
        counts[place].normal += usize::from(normal);
    }
    counts
}

/// All parameters together.
pub(crate) fn total(counts: &[Count]) -> (f64, f64) {
    let of: usize = counts.iter().map(|c| c.of).sum();
    let share = |held: usize| held as f64 / of.max(1) as f64;
    (share(counts.iter().map(|c| c.profile).sum()), share(counts.iter().map(|c| c.normal).sum()))
}

fn truth() -> Model {
    let own = TRUTH.iter().zip(Kind::Servo.parameters()).map(|(&value, own)| Value {
        value,
        low: 0.1 * value,
        high: 10.0 * value,
        positive: own.positive,
        free: true,
        prior: None,
    });
    let mut bias = ModelEffect::start(entry("null_bias").expect("listed"), 0, &SignalScales::TYPICAL).expect("a start");
    bias.values[0].value = BIAS;
    Model::bare(Kind::Servo, own.collect()).with(bias)
}

/// A run without noise.
fn run(number: i32) -> Run {
    let n = (SECONDS / DT) as usize;
    let tone = |k: usize, i: i32| {
        let hz = 0.2 * 1.6_f64.powi(i);
        let phase = f64::from(i * (number + 1)) + f64::from(number);
        0.05 / f64::from(i + 1) * (std::f64::consts::TAU * hz * k as f64 * DT + phase).sin()
    };
    let input = (0..n).map(|k| (k as f64 * DT).min(1.0) * (0..8).map(|i| tone(k, i)).sum::<f64>());
    let channel = |channel, noise| Measured { channel, values: vec![0.0; n], noise, stated: Some(noise), judged: true };
    let mut run = Run {
        name: format!("run {number}"),
        dt: DT,
        from: 0.0,
        elapsed: 0.0,
        ticks: 1,
        input: input.collect(),
        added: Vec::new(),
        law: SimulatedLaw::Pi { kp: 8.0, ki: 1.0 },
        shaping: shakedown::blocks::plant::Shaping::default(),
        loop_noise: None,
        sent_before: Vec::new(),
        moving_start: false,
        measured: vec![channel(Channel::Displacement, NOISE[0]), channel(Channel::Acceleration, NOISE[1])],
        motion: None,
        filter: None,
    };
    let model = truth();
    let predicted = predict(&model, &run, &Local::start(&model, &run)).expect("the truth runs");
    for (measured, values) in run.measured.iter_mut().zip(predicted.channels) {
        measured.values = values;
    }
    run
}

fn one(clean: &[Run], seed: u64, colour: f64) -> Vec<(String, bool, bool)> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut runs = clean.to_vec();
    for measured in runs.iter_mut().flat_map(|r| &mut r.measured) {
        let mut x = measured.noise * gauss(&mut random);
        for value in &mut measured.values {
            *value += x;
            x = colour * x + (1.0 - colour * colour).sqrt() * measured.noise * gauss(&mut random);
        }
    }
    let mut fit = Fit::begin(truth(), &runs).expect("the truth runs");
    fit.improve(&runs, Effort::FULL).expect("near the truth");
    let intervals = profiles(&fit, &runs).expect("near the truth");
    let truth = truth();
    let values = truth.values().zip(fit.model.values()).zip(fit.deviations()).zip(intervals).zip(truth.names());
    values
        .filter_map(|((((truth, found), deviation), interval), name)| {
            let interval = interval?;
            let inside = interval.low.is_none_or(|low| low <= truth.value)
                && interval.high.is_none_or(|high| truth.value <= high);
            Some((name, inside, (found.value - truth.value).abs() <= NINETY * deviation))
        })
        .collect()
}

/// Twelve uniforms less six: near enough to a Gaussian of unit variance.
fn gauss(random: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| f64::from(random.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0
}
