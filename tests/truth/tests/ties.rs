//! Ties: a slow test does not tell a late valve from a late sensor, a quick one does, and what is dealt is clear and tied.

use shakedown_truth::effect::Draw;
use shakedown_truth::lab::answer::Answer;
use shakedown_truth::lab::engine::{replay, simulate};
use shakedown_truth::lab::forms::{self, Dial, Form};
use shakedown_truth::lab::plant::Plant;
use shakedown_truth::lab::scene::test::{Motion, Test};
use shakedown_truth::lab::scene::{Kind, Scene, Wish};
use shakedown_truth::lab::ties::likelihood::Recordings;
use shakedown_truth::lab::ties::rival::{left_by, left_by_none};
use shakedown_truth::lab::{case, plan};
use shakedown_truth::refit::Parameter;
use shakedown_truth::rng::Stream;

/// Twice the difference of log likelihoods below which two effects are a tie.
const TOLD: f64 = 4.0;

/// A slow test of which the displacement is recorded and the gain free.
fn slow() -> Option<Scene> {
    let test = Some(Test { motion: Motion::Slow, accelerometer: false, free: &[Parameter::B0] });
    let wish =
        Wish { kind: Kind::Servo, saturating: false, accelerometer: false, damping_known: true, perfect: true, test };
    (0..50).find_map(|attempt| Scene::draw(wish, (5, 1), &mut Stream::new(77, attempt, 5)))
}

fn form(effect: &str) -> Form {
    forms::of(effect).remove(0)
}

fn plant(scene: &Scene, form: &Form, s: f64) -> Plant {
    let mut plant = Plant::baseline(scene.truth);
    let dial = Dial { s, draw: Draw { sign: 1.0, u: [0.3; 4] }, scales: scene.scales };
    (form.build)(&mut plant, &dial);
    plant
}

/// What a rival leaves of a delay as strong as `s`, and what nothing leaves (sums of squares).
fn of_a_delay(s: f64, rival: &str) -> Option<(f64, f64)> {
    let scene = slow()?;
    let recordings = Recordings::of(&scene, &plant(&scene, &form("command_delay"), s))?;
    let left = left_by(&scene, &recordings, &form(rival), TOLD)?;
    Some((left, left_by_none(&scene, &recordings)?))
}

#[test]
fn the_commands_that_ran_bring_the_motion_that_ran() {
    let scene = slow().unwrap();
    let plant = plant(&scene, &form("valve_lag"), 0.05);
    let run = &scene.runs[0];
    let ran = simulate(&plant, run, None).unwrap();
    assert_eq!(replay(&plant, run, &ran.command).unwrap().displacement, ran.displacement);
}

#[test]
fn slow_motion_does_not_tell_a_late_command_from_a_late_sensor() {
    let (left, nothing) = of_a_delay(0.01, "displacement_lag").unwrap();
    println!("{left} left, {nothing} by nothing");
    assert!(left < TOLD && nothing > 1000.0 * TOLD, "{left} of {nothing}");
}

#[test]
fn a_longer_delay_is_told_from_a_lag_and_friction_from_both() {
    let (left, _) = of_a_delay(0.9, "displacement_lag").unwrap();
    assert!(left > TOLD, "{left}");
    let (left, nothing) = of_a_delay(0.01, "coulomb_friction").unwrap();
    assert!(left > 0.5 * nothing.min(1e3), "{left} of {nothing}");
}

#[test]
fn a_form_follows_its_own_recordings_from_another_strength() {
    let scene = slow().unwrap();
    for effect in ["valve_lag", "leakage", "displacement_lag"] {
        let recordings = Recordings::of(&scene, &plant(&scene, &form(effect), 0.015)).unwrap();
        let left = left_by(&scene, &recordings, &form(effect), TOLD).unwrap();
        assert!(left < TOLD, "{effect}: {left}");
    }
}

fn opened(seed: u64, number: u64) -> Option<(String, Answer)> {
    let stored = tempfile::NamedTempFile::new().ok()?;
    std::fs::write(stored.path(), "answered").ok()?;
    let dealt = case(seed, number);
    Some((dealt.sealed.seal.clone(), dealt.sealed.open_after(stored.path()).ok()?.answer))
}

#[test]
fn a_tie_that_is_dealt_is_clear_and_its_rivals_stay_within_two_standard_deviations() {
    let number = (0..400).filter(|n| plan::stratum(4711, *n) == plan::Stratum::Confounded).nth(1).unwrap();
    let (seal, answer) = opened(4711, number).unwrap();
    assert_eq!(answer.stratum, "confounded");
    assert!(answer.baseline_chi2 > 6.0, "chi2 {}", answer.baseline_chi2);
    assert!(answer.groups[0].contains(&answer.effects[0].id) && answer.groups[0].len() > 1, "{:?}", answer.groups);
    let tie = answer.tie.unwrap();
    assert!(tie.rivals.iter().all(|(_, apart)| *apart < 2.0), "{tie:?}");
    assert_eq!(seal, opened(4711, number).unwrap().0);
}
