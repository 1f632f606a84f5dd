use super::super::decide::tests::{judged, weighing};
use super::grammar::Term;
use super::writing::stated;
use super::*;
use crate::identify::data::Run;
use crate::identify::fit::tests::{TRUTH, model, recorded};
use crate::identify::model::{Model, ModelEffect, Value};
use crate::plant::effects::Stage;
use crate::plant::effects::own::{Own, Stated, StatedParameter, register};
use crate::plant::model::Kind;
use std::collections::BTreeSet;

/// Every term of the grammar, alone and as it is screened, has an expression whose units give what its place asks for, and a
/// name of its own.
#[test]
fn every_term_is_a_sound_effect_with_a_name_of_its_own() {
    for kind in [Kind::Servo, Kind::RigidMass, Kind::ForceBalance] {
        let mut terms = Term::plain(kind);
        terms.extend(terms.clone().into_iter().flat_map(Term::richer));
        let mut ids = BTreeSet::new();
        let mut seen: Vec<Term> = Vec::new();
        for term in terms {
            if seen.contains(&term) {
                continue;
            }
            seen.push(term);
            for screening in [None, Some(0)] {
                let stated = stated(&[term], screening).unwrap();
                let (id, expression) = (stated.id.clone(), stated.expression.clone());
                let wrong = Own::new(stated).err();
                assert!(wrong.is_none(), "{id}: {expression}: {wrong:?}");
                ids.insert(id);
            }
        }
        assert!(ids.len() >= seen.len(), "{} names for {} terms", ids.len(), seen.len());
    }
}

/// An effect of a test, with its values.
pub(in super::super) fn placed(
    id: &str,
    stage: Stage,
    states: &[&str],
    expression: &str,
    parameters: &[(&str, &str, f64)],
) -> ModelEffect {
    let parameter = |&(name, unit, value): &(&str, &str, f64)| StatedParameter {
        name: name.into(),
        unit: unit.into(),
        low: 0.5 * value,
        high: 2.0 * value,
        start: value,
        meaning: String::new(),
    };
    let stated = Stated {
        id: id.into(),
        stage,
        states: states.iter().map(|s| (*s).to_owned()).collect(),
        expression: expression.into(),
        parameters: parameters.iter().map(parameter).collect(),
        mistaken_for: Vec::new(),
    };
    let entry = register(Own::new(stated).unwrap()).unwrap();
    ModelEffect { entry, values: parameters.iter().map(|&(.., value)| Value::fixed(value)).collect() }
}

/// What is said of a truth that the stated model lacks something of.
fn said_of(truth: &Model) -> (ScoredModel, Option<Modelled>) {
    let runs: Vec<Run> = (1..4).map(|seed| recorded(truth, seed)).collect();
    let before = judged(model(TRUTH), &runs);
    let modelled = unlisted(&weighing(&runs), &before, &before).unwrap();
    (before, modelled)
}

fn removed(before: &ScoredModel, modelled: &Modelled) -> f64 {
    1.0 - (modelled.judged.hold.chi2 - 1.0) / (before.hold.chi2 - 1.0)
}

#[test]
fn a_drag_is_found_as_an_equation_at_the_table() {
    let drag =
        placed("term_test_drag", Stage::Table, &["velocity"], "drag*velocity*abs(velocity)", &[("drag", "1/m", 60.0)]);
    let (before, modelled) = said_of(&model(TRUTH).with(drag));
    let modelled = modelled.expect("something is proposed");
    let share = removed(&before, &modelled);
    let term = modelled.term.expect("an equation");
    assert_eq!(term.place, "table", "{}", term.id);
    assert!(term.id.contains("_v_") && share > 0.9, "{} removes {share} of {}", term.id, before.hold.chi2);
}

/// A hysteresis between command and spool has memory: no curve through the present state explains it.
#[test]
fn a_hysteresis_is_found_as_an_equation_with_memory_at_the_command() {
    let torque_motor = placed(
        "term_test_hysteresis",
        Stage::Command,
        &["command"],
        "play(command, width) - command",
        &[("width", "u", 0.01)],
    );
    let (before, modelled) = said_of(&model(TRUTH).with(torque_motor));
    let modelled = modelled.expect("something is proposed");
    let share = removed(&before, &modelled);
    let term = modelled.term.expect("an equation");
    assert_eq!(term.place, "command", "{}", term.id);
    assert!(share > 0.7, "{} removes {share} of {}", term.id, before.hold.chi2);
}

#[test]
fn where_nothing_is_missing_no_equation_is_proposed() {
    let (before, modelled) = said_of(&model(TRUTH));
    assert!(before.hold.chi2 < 1.2, "{}", before.hold.chi2);
    assert!(modelled.is_none_or(|m| m.term.is_none()));
}
