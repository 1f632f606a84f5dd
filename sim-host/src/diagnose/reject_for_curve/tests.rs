use super::super::decide::tests::{judged, viscous, weighing};
use super::*;
use crate::identify::data::Run;
use crate::identify::fit::tests::{TRUTH, model, recorded};
use crate::identify::model::{Model, ModelEffect, SignalScales};
use crate::plant::effects::entry;

/// The same with viscous friction named.
fn named(truth: &Model) -> (Weighing, Decision) {
    decided_for(truth, viscous(90.0, 0.0, (-0.2, 2.0)))
}

/// Runs of a truth, the stated model and one that names an effect on them, decided for the name.
pub(in super::super) fn decided_for(truth: &Model, name: ModelEffect) -> (Weighing, Decision) {
    let runs: Vec<Run> = (1..4).map(|seed| recorded(truth, seed)).collect();
    let (before, after) = (judged(model(TRUTH), &runs), judged(model(TRUTH).with(name), &runs));
    let candidates: Vec<ScoredModel> = vec![ScoredModel { probability: 0.8, ..after.clone() }];
    let decision = Decision {
        stated: before,
        accepted: after,
        candidates,
        ties: Vec::new(),
        unlisted: false,
        partial: None,
        unlisted_probability: 0.2,
        more_missing: false,
        noise: Vec::new(),
        in_full: None,
        one_of_many: false,
    };
    (weighing(&runs), decision)
}

/// A drag that grows with the square of speed is bent to by an equation of friction, up to a point. A curve has no such point.
#[test]
fn a_name_that_a_curve_outdoes_is_taken_back() {
    let (weighing, mut decision) = named(&model(TRUTH).with(viscous(120.0, -0.6, (-2.0, 2.0))));
    let left = decision.accepted.hold.chi2;
    assert!(left > DOUBTFUL, "the equation of friction leaves chi2 {left}");
    let curve = reject_for_curve(&weighing, &mut decision).unwrap().expect("an equation of velocity");
    let [placed] = &curve.judged.fit.model.effects[..] else { panic!("one effect stands for it") };
    let entry = placed.entry;
    assert!(
        entry.id.ends_with("by_velocity") || entry.equation.contains("velocity"),
        "{}: {}",
        entry.id,
        entry.equation
    );
    assert!(curve.judged.hold.chi2 - 1.0 < OUTDONE * (left - 1.0), "{} of {left}", curve.judged.hold.chi2);
    assert!(decision.unlisted && decision.accepted.added.is_empty());
    assert_eq!(decision.partial.unwrap().added, ["viscous_friction"]);
    assert!((decision.candidates[0].probability + decision.unlisted_probability - 1.0).abs() < 1e-9);
}

/// What the name leaves is in nobody's coordinate: a curve in the name's place leaves it too.
#[test]
fn a_name_beside_which_something_else_is_left_stands() {
    let mut hum = ModelEffect::start(entry("mains_hum").unwrap(), 0, &SignalScales::TYPICAL).unwrap();
    hum.values.iter_mut().zip([50.0, 0.0, 0.2, 0.0]).for_each(|(slot, value)| slot.value = value);
    let (weighing, mut decision) = named(&model(TRUTH).with(viscous(90.0, 0.0, (-0.2, 2.0))).with(hum));
    assert!(decision.accepted.hold.chi2 > DOUBTFUL, "hum is left: chi2 {}", decision.accepted.hold.chi2);
    assert!(reject_for_curve(&weighing, &mut decision).unwrap().is_none() && !decision.unlisted);
}
