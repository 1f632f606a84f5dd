//! What the examiner promises: a null is one, strengths are what they say, the same seed deals the same cases, answers
//! stay sealed until the examinee has written its own.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use shakedown_truth::answer::SealError;
use shakedown_truth::baseline::predict;
use shakedown_truth::case;
use shakedown_truth::closed_loop::simulate;
use shakedown_truth::corrupt::Corruption;
use shakedown_truth::effect::{Draw, Effect};
use shakedown_truth::plan::{Stratum, stratum};
use shakedown_truth::plant::Physics;
use shakedown_truth::rng::Stream;
use shakedown_truth::scene::{Kind, Scene, Size, Wish};
use shakedown_truth::strength::{measure, seek};
use shakedown_truth::unlisted::Unlisted;

fn scene(kind: Kind, size: Size, number: u64) -> Scene {
    let wish = Wish { size, ..Wish::plain(kind) };
    Scene::draw(wish, number, &mut Stream::new(99, number, 1))
}

#[test]
fn without_a_flaw_the_truth_is_the_stated_model_solved_exactly() {
    for (i, kind) in [Kind::Servo, Kind::Servo, Kind::Rigid, Kind::Axis].into_iter().enumerate() {
        let scene = scene(kind, if i == 1 { Size::Saturating } else { Size::Any }, i as u64);
        let run = &scene.runs[1];
        let traces = simulate(&Physics::baseline(scene.truth), run, None).unwrap();
        let model = predict(&scene.truth, run);
        let worst = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let (d, a) =
            (worst(&traces.displacement, &model.displacement), worst(&traces.acceleration, &model.acceleration));
        let sigma = (scene.sigma.displacement, scene.sigma.acceleration.unwrap_or(0.03));
        assert!(d < 0.02 * sigma.0 && a < 0.02 * sigma.1, "{kind:?}: {d} m, {a} m/s2");
        assert!(i != 1 || model.saturated > 0.005, "the second run should meet the limit: {}", model.saturated);
    }
}

#[test]
fn a_null_is_one_to_within_its_noise() {
    for number in 0..6 {
        let kind = [Kind::Servo, Kind::Rigid, Kind::Axis][number as usize % 3];
        let scene = scene(kind, Size::Any, number);
        let run = scene.runs.last().unwrap();
        let traces = simulate(&Physics::baseline(scene.truth), run, Some(&scene.noise)).unwrap();
        let model = predict(&scene.truth, run);
        let n = run.reference.len() as f64;
        let chi2 = |x: &[f64], y: &[f64], s: f64| x.iter().zip(y).map(|(a, b)| ((a - b) / s).powi(2)).sum::<f64>() / n;
        // The fed-back part of the noise is coloured: six standard errors of white noise.
        let margin = 6.0 * (2.0 / n).sqrt();
        let d = chi2(&traces.displacement, &model.displacement, scene.sigma.displacement);
        assert!((d - 1.0).abs() < margin, "{kind:?} displacement: {d}");
        if let Some(sigma) = scene.sigma.acceleration {
            let a = chi2(&traces.acceleration, &model.acceleration, sigma);
            assert!((a - 1.0).abs() < margin, "{kind:?} acceleration: {a}");
        }
    }
}

#[test]
fn every_effect_moves_the_recordings_and_more_of_it_moves_them_more() {
    for effect in Effect::ALL {
        let size = if effect.needs_saturation() { Size::Saturating } else { Size::Any };
        let wish = Wish { size, damping_known: effect == Effect::ViscousFriction, ..Wish::plain(Kind::Servo) };
        let scene = Scene::draw(wish, 5, &mut Stream::new(99, 5, 1));
        let draw = Draw::new(&mut Stream::new(1, 2, 3));
        let excess = |strength: f64| {
            let mut physics = Physics::baseline(scene.truth);
            effect.apply(strength, &draw, &scene.scales, &mut physics);
            measure(&scene, &physics).unwrap_or_else(|| panic!("{effect:?} ran away at {strength}")).excess
        };
        let (little, much) = (excess(0.03), excess(0.09));
        assert!(much > 1e-3 && much > 1.5 * little, "{effect:?}: {little} at 0.03, {much} at 0.09");
    }
}

#[test]
fn every_unlisted_flaw_can_be_made_clear() {
    for flaw in Unlisted::ALL {
        let size = if flaw.needs_saturation() { Size::Saturating } else { Size::Any };
        let wish = Wish { size, quiet: flaw.needs_accelerometer(), ..Wish::plain(Kind::Servo) };
        let scene = Scene::draw(wish, 6, &mut Stream::new(99, 6, 1));
        let draw = Draw::new(&mut Stream::new(1, 2, 3));
        let apply = |s: f64, physics: &mut Physics| flaw.apply(s, &draw, &scene.scales, physics);
        let (strength, sized) = seek(&scene, 15.0, &apply).unwrap_or_else(|| panic!("{flaw:?} ran away"));
        assert!(sized.excess > 5.0, "{flaw:?}: {} at {strength}", sized.excess);
    }
}

#[test]
fn every_fault_spoils_the_files_and_says_where() {
    let null = (0..140).find(|n| stratum(3, *n) == Stratum::Null).unwrap();
    let sound = case(3, null).experiment;
    for kind in Corruption::ALL {
        let mut spoilt = sound.clone();
        let fault = kind.spoil(&mut spoilt, &mut Stream::new(1, 2, 3));
        assert_ne!(spoilt, sound, "{kind:?}");
        let changed = |i: usize| spoilt.sheets[i] != sound.sheets[i];
        if let Some(file) = &fault.run {
            for (i, sheet) in sound.sheets.iter().enumerate() {
                assert_eq!(changed(i), sheet.file == *file, "{kind:?} says {file}, and {} changed", sheet.file);
            }
        }
    }
}

#[test]
fn the_same_seed_deals_the_same_case_and_another_seed_another_one() {
    let null = (0..140).find(|n| stratum(3, *n) == Stratum::Null).unwrap();
    let (one, again, other) = (case(3, null), case(3, null), case(4, null));
    assert_eq!(one.experiment, again.experiment);
    assert_eq!(one.sealed.seal, again.sealed.seal);
    assert_ne!(one.experiment, other.experiment);
    assert_ne!(one.sealed.seal, other.sealed.seal);
}

#[test]
fn an_answer_stays_sealed_until_the_examinee_has_written_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let mine = folder.path().join("case.json");
    let null = (0..140).find(|n| stratum(3, *n) == Stratum::Null).unwrap();
    let dealt = case(3, null);
    let seal = dealt.sealed.seal.clone();
    assert!(matches!(dealt.sealed.clone().open_after(&mine), Err(SealError::NotAnswered { .. })));
    std::fs::write(&mine, "").unwrap();
    assert!(matches!(dealt.sealed.clone().open_after(&mine), Err(SealError::Empty(_))));
    std::fs::write(&mine, "{}").unwrap();
    let mut opened = dealt.sealed.open_after(&mine).unwrap();
    assert_eq!(opened.seal(), seal);
    // A changed answer does not fit its seal.
    opened.answer.baseline_chi2 += 1.0;
    assert_ne!(opened.seal(), seal);
}

#[test]
fn the_experiment_tells_nothing_of_the_answer() {
    let single = (0..140).find(|n| matches!(stratum(3, *n), Stratum::Single(..))).unwrap();
    let dealt = case(3, single);
    let text = dealt.experiment.toml();
    for effect in Effect::ALL {
        assert!(!text.contains(effect.id()), "{text}");
    }
    assert!(text.contains("case-"));
}
