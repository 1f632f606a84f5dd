use super::super::grow_beside;
use super::*;
use crate::identify::evaluate::{Local, predict};
use crate::identify::fit::Effort;
use crate::identify::fit::tests::{TRUTH, gauss, model, recorded};
use crate::identify::model::{Model, SignalScales, Value};
use crate::plant::effects::entry;
use crate::plant::model::Kind;
use crate::plant::simulate::MeasuredMotion;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use std::f64::consts::TAU;

/// A structure that rings for fifty periods, as heavy as its table, beyond the ladder of starts.
const FREQUENCY: f64 = 21.8;
const STRUCTURE: [f64; 3] = [1.2, FREQUENCY, 0.003];
const NOISE: f64 = 0.02;

/// A force balance, its scale, dashpot and lead free.
fn balance(scale: f64) -> Model {
    let free = |value: f64, reach| Value {
        value,
        low: value - reach,
        high: value + reach,
        positive: false,
        free: true,
        prior: None,
    };
    Model::bare(Kind::ForceBalance, vec![free(scale, 10.0), free(0.0, 100.0), free(0.0, 0.05)])
}

/// A table that moves by tones at every half hertz, and the pressure of these effects in truth.
fn measured(truth: &Model) -> Run {
    let run = recorded(&model(TRUTH), 1);
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let tones: Vec<(f64, f64, f64)> =
        (1..50).map(|i| (0.5 * f64::from(i), 0.3 + 0.1 * gauss(&mut random), TAU * gauss(&mut random))).collect();
    let mut motion = MeasuredMotion::default();
    for k in 0..run.len() {
        let (mut x, mut v, mut a) = (0.0, 0.0, 0.0);
        for (hz, size, phase) in &tones {
            let (w, (sin, cos)) = (TAU * hz, (TAU * hz * k as f64 * run.dt + phase).sin_cos());
            (x, v, a) = (x - size * sin / (w * w), v - size * cos / w, a + size * sin);
        }
        motion.displacement.push(x);
        motion.velocity.push(v);
        motion.acceleration.push(a);
    }
    let mut run = Run { motion: Some(motion), measured: run.measured[..1].to_vec(), ..run };
    run.measured[0].channel = Channel::PressureDifference;
    run.measured[0].noise = NOISE;
    let predicted = predict(truth, &run, &Local::start(truth, &run)).unwrap();
    run.measured[0].values = predicted.channels[0].iter().map(|p| p + NOISE * gauss(&mut random)).collect();
    run
}

fn effect(id: &str, values: &[f64], scales: &SignalScales) -> ModelEffect {
    let mut placed = ModelEffect::start(entry(id).unwrap(), 0, scales).unwrap();
    placed.values.iter_mut().zip(values).for_each(|(value, truth)| value.value = *truth);
    placed
}

/// Friction and a structure that rings, and the friction's fit, beside which the structure is looked for.
fn beside_friction() -> (Vec<Run>, SignalScales, Fit) {
    let scales = SignalScales::of(&[measured(&balance(0.2))], 1.0);
    let friction = |model: Model| model.with(effect("coulomb_friction", &[0.8, 2e-6], &scales));
    let truth = friction(balance(0.2).with(effect("payload_resonance", &STRUCTURE, &scales)));
    let runs = vec![measured(&truth)];
    let mut fit = Fit::begin(friction(balance(0.4)), &runs).unwrap();
    fit.improve(&runs, Effort::FULL).unwrap();
    (runs, scales, fit)
}

#[test]
fn a_structure_that_rings_is_found_beside_a_friction() {
    let (runs, scales, friction) = beside_friction();
    assert!(friction.chi2() > 100.0, "{}", friction.chi2());
    let found = &grow_beside(&friction, &runs, &scales).unwrap()[0];
    assert_eq!(found.model.ids(), ["coulomb_friction", "payload_resonance"]);
    let values: Vec<f64> = found.model.effects[1].values.iter().map(|v| v.value).collect();
    let left = found.chi2() / friction.chi2();
    assert!(left < 1e-3 && (values[1] / FREQUENCY - 1.0).abs() < 1e-3, "{left} left, {values:?}");
}

#[test]
fn a_structure_begins_where_the_residual_is_strongest() {
    let (runs, scales, friction) = beside_friction();
    let peaks = dominant_frequencies(&friction, &runs).unwrap();
    let at = peaks.iter().copied().find(|at| (at / FREQUENCY - 1.0).abs() < 0.04).expect("a peak where it rings");
    let start = |id| effect(id, &[], &scales);
    let placed = structure_at(start("payload_resonance"), at).unwrap();
    assert!((placed.values[1].value - at).abs() < 1e-12 && placed.values[2].value < 0.05);
    for id in ["oil_compliance", "mains_hum", "coulomb_friction"] {
        assert!(structure_at(start(id), at).is_none(), "{id} is no structure");
    }
    assert!(structure_at(start("payload_resonance"), 90.0).is_none(), "beyond what a structure may have");
}
