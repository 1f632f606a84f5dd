use super::super::decide::tests::{judged, weighing};
use super::super::term::tests::placed;
use super::super::term::{Modelled, unlisted};
use super::*;
use crate::identify::data::Run;
use crate::identify::fit::tests::{TRUTH, model, recorded};
use crate::identify::model::{Model, ModelEffect, SignalScales};
use crate::plant::effects::{Stage, entry};

/// The effect named beside what models a drag that the library does not hold, and all that was decided.
fn said_of(truth: &Model) -> (Option<Modelled>, Decision) {
    let runs: Vec<Run> = (1..4).map(|seed| recorded(truth, seed)).collect();
    let stated = judged(model(TRUTH), &runs);
    let weighing = weighing(&runs);
    let modelled = unlisted(&weighing, &stated, &stated).unwrap().expect("something is proposed");
    let mut decision = Decision {
        stated: stated.clone(),
        accepted: stated,
        candidates: Vec::new(),
        ties: Vec::new(),
        unlisted: true,
        partial: None,
        unlisted_probability: 1.0,
        more_missing: false,
        noise: Vec::new(),
        in_full: None,
        one_of_many: false,
    };
    let named = name_beside(&weighing, &mut decision, &modelled).unwrap();
    (named, decision)
}

fn drag() -> ModelEffect {
    placed("beside_test_drag", Stage::Table, &["velocity"], "drag*velocity*abs(velocity)", &[("drag", "1/m", 120.0)])
}

/// Beside the equation of a drag an offset of the valve explains what is left, and nothing else does.
#[test]
fn an_effect_beneath_what_is_unlisted_is_named_beside_it() {
    let mut bias = ModelEffect::start(entry("null_bias").unwrap(), 0, &SignalScales::TYPICAL).unwrap();
    bias.values[0].value = 0.02;
    let (named, decision) = said_of(&model(TRUTH).with(drag()).with(bias));
    let named = named.expect("an offset");
    assert!(named.names_needed && named.judged.added == ["null_bias"]);
    assert!(named.judged.hold.chi2 < 1.1, "chi2 {} is left", named.judged.hold.chi2);
    assert!(decision.explain_a_part(&named.judged.added));
}

/// What an equation leaves of the one flaw that it stands for is no second effect.
#[test]
fn nothing_is_named_beside_what_is_unlisted_alone() {
    let (named, decision) = said_of(&model(TRUTH).with(drag()));
    assert!(named.is_none() && decision.candidates.is_empty());
}
