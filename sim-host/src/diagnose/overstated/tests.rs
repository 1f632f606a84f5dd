use super::super::Options;
use super::super::decide::tests::viscous;
use super::super::passes::{select, with_noise_as_left};
use super::super::reach::Reach;
use super::super::split::split;
use super::*;
use crate::identify::data::Run;
use crate::identify::fit::tests::{TRUTH, model, recorded};
use crate::identify::model::{ModelEffect, SignalScales};
use crate::plant::effects::entry;

/// Two runs of a truth, the noise of whose displacement is stated so many times too large.
fn prepared(truth: &crate::identify::model::Model, times: f64) -> Prepared {
    let mut fit: Vec<Run> = (1..3).map(|seed| recorded(truth, seed)).collect();
    for measured in fit.iter_mut().flat_map(|run| &mut run.measured) {
        measured.noise *= times;
        measured.stated = Some(measured.noise);
    }
    let signal_scales = SignalScales::of(&fit, 1.0);
    let mut stated = model(TRUTH);
    stated.own.iter_mut().for_each(|value| value.free = false);
    Prepared { model: stated, fit, holdout: Vec::new(), signal_scales }
}

/// What a noise that was stated too large hides beneath the first name is found, and the noise is what is left.
#[test]
fn what_hides_beneath_an_overstated_noise_is_found() {
    let mut friction = ModelEffect::start(entry("coulomb_friction").unwrap(), 0, &SignalScales::TYPICAL).unwrap();
    friction.values[0].value *= 80.0;
    let truth = model(TRUTH).with(viscous(2.5, 0.0, (-0.2, 2.0))).with(friction);
    let prepared = prepared(&truth, 3.0);
    let options = Options::default();
    let weighing = split(prepared.clone(), None).weighing;
    let first = select(&weighing, &options, Reach::Fitted).unwrap();
    assert_eq!(first.decision.accepted.added, ["viscous_friction"]);
    let (mut whole, mut seen) = (prepared.clone(), prepared);
    let left = by_names(&weighing, &first.decision);
    let (_, second) = with_noise_as_left(&mut whole, &mut seen, &options, Reach::Fitted).unwrap();
    assert_eq!(second.decision.accepted.added, ["viscous_friction", "coulomb_friction"], "{left:?}");
    for (measured, made) in whole.fit[0].measured.iter().zip(&recorded(&truth, 1).measured) {
        assert!((measured.noise / made.noise - 1.0).abs() < 0.1, "{}", measured.noise / made.noise);
    }
}

/// What was raised and comes down to what was stated hides nothing.
#[test]
fn a_noise_as_it_was_stated_is_not_looked_beneath() {
    let mut prepared = prepared(&model(TRUTH), 1.0);
    let left = vec![(Channel::Displacement, 1.3_f64.powi(-2))];
    assert!(!as_stated(&left, &prepared.fit), "a noise that was stated too large");
    prepared.fit.iter_mut().flat_map(|run| &mut run.measured).for_each(|m| m.noise *= 1.3);
    assert!(as_stated(&left, &prepared.fit));
    assert!(!as_stated(&vec![(Channel::Displacement, 0.8)], &prepared.fit), "more than what was stated");
}

/// Where nothing hides, names and noise stay as they were.
#[test]
fn where_nothing_hides_nothing_changes() {
    let prepared = prepared(&model(TRUTH).with(viscous(2.5, 0.0, (-0.2, 2.0))), 3.0);
    let (mut whole, mut seen) = (prepared.clone(), prepared.clone());
    let (_, selected) = with_noise_as_left(&mut whole, &mut seen, &Options::default(), Reach::Fitted).unwrap();
    assert_eq!(selected.decision.accepted.added, ["viscous_friction"]);
    assert_eq!(whole.fit[0].measured[0].noise, prepared.fit[0].measured[0].noise);
}
