use super::*;
use crate::identify::fit::tests::{model, recorded};
use crate::identify::model::{ModelEffect, SignalScales};
use crate::plant::effects::entry;

/// The paper's table without its zero, whose phase would bear any gain.
const TRUTH: [f64; 4] = [0.0, 138.0, 57.65, 0.242];
const KP: f64 = 30.0;

/// A proportional loop around that table, 200 Hz.
fn pattern() -> Run {
    Run { law: SimulatedLaw::Pi { kp: KP, ki: 0.0 }, ..recorded(&model(TRUTH), 1) }
}

fn with(id: &str, values: &[f64]) -> Model {
    let mut placed = ModelEffect::start(entry(id).unwrap(), 0, &SignalScales::TYPICAL).unwrap();
    placed.values.iter_mut().zip(values).for_each(|(slot, &value)| slot.value = value);
    model(TRUTH).with(placed)
}

/// The factor at which the sampled loop loses its stability: both roots of its characteristic polynomial within the unit
/// circle (Jury), the plant's two states taken exactly over a held command.
fn jury(dt: f64) -> f64 {
    let [b1, b0, a1, _] = TRUTH;
    let (e, g) = ((-a1 * dt).exp(), b0 - b1 * a1);
    let (bx, bz) = (b1 * dt + g / a1 * (dt - (1.0 - e) / a1), g / a1 * (1.0 - e));
    let stable = |k: f64| {
        let (trace, det) = (1.0 - k * bx + e, e + k * (bz * (1.0 - e) / a1 - bx * e));
        det.abs() < 1.0 && trace.abs() < 1.0 + det
    };
    (1..100_000).map(|i| 1e-3 * f64::from(i)).take_while(|f| stable(KP * f)).fold(0.0, f64::max)
}

#[test]
fn a_sampled_loop_settles_as_far_as_its_roots_are_within_the_circle() {
    let run = pattern();
    let limit = jury(run.dt);
    assert!((1.2..9.0).contains(&limit), "{limit} is among the factors tried");
    let found = margin(&model(TRUTH), &run, 0.1).unwrap().unwrap();
    assert!((limit / FACTORS.1.powi(2)..limit).contains(&found), "{found} of {limit}");
    let times = |factor: f64| settles(&model(TRUTH), &run, factor, 5e-3).unwrap();
    assert!(times(limit / 1.1) && !times(limit * 1.05));
}

#[test]
fn a_delay_eats_the_margin_and_a_lost_limit_slows_one_side() {
    let run = pattern();
    let late = margin(&with("command_delay", &[0.02]), &run, 0.1).unwrap().unwrap();
    let prompt = margin(&model(TRUTH), &run, 0.1).unwrap().unwrap();
    assert!(late < 0.5 * prompt, "{late} of {prompt}");
    let one_sided = with("asymmetric_limit", &[0.20, 0.15]);
    let [up, down] = [1.0, -1.0].map(|u| speed(&one_sided, &run, u, 0.1).unwrap());
    assert!((up - 0.20).abs() < 1e-3 && (down - 0.15).abs() < 1e-3, "{up} and {down} m/s");
    let both = [1.0, -1.0].map(|u| speed(&model(TRUTH), &run, u, 0.1).unwrap());
    assert!(both.iter().all(|v| (v - TRUTH[3]).abs() < 1e-3), "{both:?} m/s");
}

#[test]
fn a_drift_is_no_oscillation() {
    let drift: Vec<f64> = (0..100).map(|k| 0.1 + 0.02 * f64::from(k)).collect();
    assert!(rms(about_trend(&drift).into_iter()) < 1e-12);
    let swing: Vec<f64> = (0..100).map(|k| f64::from(k % 2)).collect();
    assert!((rms(about_trend(&swing).into_iter()) - 0.5).abs() < 1e-2);
}
