use super::*;
use crate::identify::data::{Channel, Measured};
use crate::identify::evaluate::predict;
use crate::identify::model::{ModelEffect, Prior, SignalScales, Value};
use crate::plant::effects::entry;
use crate::plant::model::Kind;
use crate::plant::simulate::SimulatedLaw;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const DT: f64 = 0.005;
/// The paper's table.
pub(crate) const TRUTH: [f64; 4] = [0.69, 138.0, 57.65, 0.242];

/// A servo table of the given values, all but the first free.
pub(crate) fn model(values: [f64; 4]) -> Model {
    let free = [false, true, true, true];
    let own = values.iter().zip(free).map(|(&value, free)| Value {
        value,
        low: 0.2 * value,
        high: 5.0 * value,
        positive: true,
        free,
        prior: None,
    });
    Model::bare(Kind::Servo, own.collect())
}

/// Twelve uniforms less six: near enough to a Gaussian of unit variance.
pub(crate) fn gauss(random: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| f64::from(random.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0
}

/// A run of the given model, with noise on its sensors.
pub(crate) fn recorded(model: &Model, seed: u64) -> Run {
    let n = 3000;
    let tone = |k: usize, i: i32| {
        let hz = 0.2 * 1.6_f64.powi(i);
        0.05 / f64::from(i + 1) * (std::f64::consts::TAU * hz * k as f64 * DT + f64::from(i) + seed as f64).sin()
    };
    let input = (0..n).map(|k| (k as f64 * DT).min(1.0) * (0..8).map(|i| tone(k, i)).sum::<f64>());
    let channel = |channel, noise| Measured { channel, values: vec![0.0; n], noise, stated: Some(noise), judged: true };
    let mut run = Run {
        name: "made".into(),
        dt: DT,
        from: 0.0,
        elapsed: 0.0,
        ticks: 1,
        input: input.collect(),
        added: Vec::new(),
        law: SimulatedLaw::Pi { kp: 8.0, ki: 1.0 },
        shaping: crate::plant::simulate::Shaping::default(),
        loop_noise: None,
        sent_before: Vec::new(),
        moving_start: false,
        measured: vec![channel(Channel::Displacement, 2e-5), channel(Channel::Acceleration, 0.1)],
        motion: None,
        filter: None,
    };
    let local = Local::start(model, &run);
    let predicted = predict(model, &run, &local).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    for (measured, clean) in run.measured.iter_mut().zip(predicted.channels) {
        measured.values = clean.iter().map(|v| v + measured.noise * gauss(&mut random)).collect();
    }
    run
}

#[test]
fn a_model_is_recovered_from_ten_per_cent_off() {
    let runs = [recorded(&model(TRUTH), 1), recorded(&model(TRUTH), 2)];
    let mut fit = Fit::begin(model([0.69, 152.0, 52.0, 0.26]), &runs).unwrap();
    fit.improve(&runs, Effort::FULL).unwrap();
    assert!((fit.chi2() - 1.0).abs() < 0.05, "chi2 {}", fit.chi2());
    for ((value, deviation), truth) in fit.model.values().zip(fit.deviations()).zip(TRUTH).skip(1) {
        assert!((value.value - truth).abs() < 4.5 * deviation, "{} +/- {deviation}, truth {truth}", value.value);
        assert!(deviation < 0.01 * truth, "{deviation} of {truth}");
    }
}

/// A goal that the steps left cannot reach at the last one's pace ends an effort; one within reach does not.
#[test]
fn no_step_is_spent_on_what_cannot_matter() {
    let runs = [recorded(&model(TRUTH), 1)];
    let begun = Fit::begin(model([0.69, 152.0, 52.0, 0.26]), &runs).unwrap();
    let towards = |goal: f64| {
        let mut fit = begun.clone();
        fit.improve_towards(&runs, Effort::FULL, goal).unwrap();
        fit
    };
    let near = towards(1.1 * begun.rows as f64);
    assert!(near.chi2() < 1.1 && near.evaluations > 3, "{}", near.evaluations);
    let far = towards(0.5 * begun.rows as f64);
    assert!(far.evaluations < near.evaluations, "{} of {}", far.evaluations, near.evaluations);
}

/// The beginning of a run is simulated as the run is.
#[test]
fn a_beginning_is_what_the_run_begins_with() {
    let run = recorded(&model(TRUTH), 1);
    let beginning = run.beginning(700);
    let predict = |run: &Run| predict(&model(TRUTH), run, &Local::start(&model(TRUTH), run)).unwrap();
    let (all, first) = (predict(&run), predict(&beginning));
    assert_eq!((beginning.len(), beginning.measured[1].values.len()), (700, 700));
    assert_eq!(all.channels[0][..700], first.channels[0][..]);
    assert_eq!(run.beginning(9000).len(), run.len());
}

/// A limit above what anything asks of it has no slope to follow.
#[test]
fn a_limit_that_nothing_reaches_is_brought_down_to_where_it_binds() {
    let limits = |positive: f64, negative: f64| {
        let mut placed = ModelEffect::start(entry("asymmetric_limit").unwrap(), 0, &SignalScales::TYPICAL).unwrap();
        for (value, limit) in placed.values.iter_mut().zip([positive, negative]) {
            (value.value, value.low, value.high) = (limit, 0.1 * limit, 10.0 * limit);
        }
        placed
    };
    let runs = [recorded(&model(TRUTH).with(limits(1.0, 1.0)), 1)];
    let fastest = |sign: f64| {
        let x = &runs[0].measured[0].values;
        x.windows(5).map(|w| sign * (w[4] - w[0]) / (4.0 * DT)).fold(0.0, f64::max)
    };
    let truth = [0.93 * fastest(1.0), 0.93 * fastest(-1.0)];
    let runs = [recorded(&model(TRUTH).with(limits(truth[0], truth[1])), 1)];
    // What was known of it beforehand, loosely, is no slope that leads there.
    for known in [false, true] {
        let mut stated = limits(truth[0], 1.12 * truth[1]);
        for value in stated.values.iter_mut().filter(|_| known) {
            value.prior = Some(Prior { mean: value.coordinate(), std: 0.25, lent: false });
        }
        let mut fit = Fit::begin(model(TRUTH).with(stated), &runs).unwrap();
        assert!(fit.chi2() > 1.3, "the limit shows: chi2 {}", fit.chi2());
        fit.improve(&runs, Effort::FULL).unwrap();
        let found = fit.model.effects[0].values[1].value;
        assert!((found / truth[1] - 1.0).abs() < 5e-3, "{found} for {}, chi2 {}", truth[1], fit.chi2());
    }
}

/// The limit is fitted a hair too high: every share that is tried at once is too low, and worse.
#[test]
fn a_limit_a_hair_too_high_is_found_between_what_is_too_low_and_what_nothing_reaches() {
    let fast = recorded(&model(TRUTH), 1).measured[0].values.windows(5).map(|w| w[4] - w[0]).fold(0.0, f64::max);
    let truth = 0.93 * fast / (4.0 * DT);
    let limited = |limit: f64| model([TRUTH[0], TRUTH[1], TRUTH[2], limit]);
    let runs = [recorded(&limited(truth), 1)];
    let fitted = |limit: f64| {
        let mut fit = Fit::begin(limited(limit), &runs).unwrap();
        fit.improve(&runs, Effort::FULL).unwrap();
        (fit.model.own[3].value / truth - 1.0, fit.chi2())
    };
    for above in [1.07, 1.09, 1.25] {
        let (off, chi2) = fitted(above * truth);
        assert!(off.abs() < 5e-3 && chi2 < 1.05, "from {above}: {off} off, chi2 {chi2}");
    }
}

/// What wants to go beyond the end of its range says what a tenth less would cost; what rests within says nothing.
#[test]
fn a_value_at_an_end_pushes_where_the_truth_is_beyond() {
    let runs = [recorded(&model(TRUTH), 4)];
    let pushed = |low: f64, high: f64| {
        let mut bounded = model(TRUTH);
        (bounded.own[2].low, bounded.own[2].high) = (low * TRUTH[2], high * TRUTH[2]);
        bounded.own[2].value = high * TRUTH[2];
        let mut fit = Fit::begin(bounded, &runs).unwrap();
        fit.improve(&runs, Effort::FULL).unwrap();
        fit.pushed()
    };
    let free = pushed(0.5, 2.0);
    assert!(free.iter().all(|&cost| cost == 0.0), "{free:?}");
    for (low, high) in [(0.5, 0.9), (1.1, 2.0)] {
        let cost = pushed(low, high);
        assert!(cost[2] > 100.0 && cost[1] == 0.0 && cost[3] == 0.0, "{low} to {high}: {cost:?}");
    }
}

#[test]
fn friction_is_found_in_one_model_and_missed_by_the_other() {
    let mut friction = ModelEffect::start(entry("coulomb_friction").unwrap(), 1, &SignalScales::TYPICAL).unwrap();
    friction.values[0].value = 0.3;
    let runs = [recorded(&model(TRUTH).with(friction), 3)];
    let mut without = Fit::begin(model(TRUTH), &runs).unwrap();
    without.improve(&runs, Effort::FULL).unwrap();
    assert!(without.chi2() > 2.0, "a model without friction must not fit: chi2 {}", without.chi2());
    let start = ModelEffect::start(entry("coulomb_friction").unwrap(), 0, &SignalScales::TYPICAL).unwrap();
    let mut with = Fit::resume(without.model.with(start), without.locals.clone(), &runs).unwrap();
    with.improve(&runs, Effort::FULL).unwrap();
    let force = with.model.effects[0].values[0].value;
    assert!((force - 0.3).abs() < 0.01 && with.chi2() < 1.05, "force {force}, chi2 {}", with.chi2());
}

/// A chord at half the friction that is there promises what a fit reaches; one of too much bias promises it only where less
/// than none makes sense; the tangent at no bias at all does as well.
#[test]
fn a_chord_promises_what_a_fit_reaches() {
    let placed = |id: &str, value: f64| {
        let mut placed = ModelEffect::start(entry(id).unwrap(), 0, &SignalScales::TYPICAL).unwrap();
        placed.values[0].value = value;
        placed
    };
    let looked = |there: ModelEffect| {
        let runs = [recorded(&model(TRUTH).with(there), 3)];
        let mut without = Fit::begin(model(TRUTH), &runs).unwrap();
        without.improve(&runs, Effort::FULL).unwrap();
        (runs, without)
    };
    let promised = |runs: &[Run], fit: &Fit, tried: ModelEffect, signed: bool| {
        let base = secant::Base::of(fit, runs).unwrap().unwrap();
        base.promised(&fit.model.with(tried), signed, runs).unwrap().unwrap() / fit.rows as f64
    };
    let (runs, without) = looked(placed("coulomb_friction", 0.3));
    let chi2 = promised(&runs, &without, placed("coulomb_friction", 0.15), false);
    // Dry friction is not linear in its force: nine tenths of what is missing will do.
    assert!(without.chi2() > 2.0 && chi2 - 1.0 < 0.1 * (without.chi2() - 1.0), "{} -> {chi2}", without.chi2());
    let (runs, without) = looked(placed("null_bias", -1e-3));
    let bias = |start, signed| promised(&runs, &without, placed("null_bias", start), signed);
    assert!(bias(1e-3, false) > 0.99 * without.chi2(), "{} -> {}", without.chi2(), bias(1e-3, false));
    for chi2 in [bias(1e-3, true), bias(0.0, true)] {
        assert!((chi2 - 1.0).abs() < 0.05 && without.chi2() > 1.5, "{} -> {chi2}", without.chi2());
    }
}
