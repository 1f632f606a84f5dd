use super::super::clock;
use super::super::decide::tests::viscous;
use super::super::split::{Split, split};
use super::super::{decide, search};
use super::*;
use crate::diagnose::Options;
use crate::identify::data::Run;
use crate::identify::fit::tests::{TRUTH, model, recorded};
use crate::identify::model::Yardsticks;
use crate::identify::prepare::Prepared;
use crate::plant::effects::regional;

/// Three runs of a truth, of which the stated model with no value free is doubted.
fn prepared(truth: &Model) -> Prepared {
    let mut stated = model(TRUTH);
    stated.own.iter_mut().for_each(|value| value.free = false);
    let fit: Vec<Run> = (1..4).map(|seed| recorded(truth, seed)).collect();
    let yardsticks = Yardsticks::of(&fit, 1.0);
    Prepared { model: stated, fit, holdout: Vec::new(), yardsticks }
}

fn decided(prepared: Prepared) -> Decision {
    let Split { weighing, .. } = split(prepared, None);
    let search = search::search(&weighing, &Options::default()).unwrap();
    let decision = decide::decide(&weighing, &search).unwrap();
    region(&weighing, &search, decision).unwrap()
}

/// A dashpot that acts from the fourth to the tenth second of every run, and nowhere else.
#[test]
fn an_effect_that_acts_in_a_part_of_the_runs_is_named_with_its_window() {
    let plain = viscous(30.0, 0.0, (-0.2, 2.0));
    let whole: Vec<f64> = (0..=PARTS).map(|i| 15.0 * i as f64 / PARTS as f64).collect();
    let truth = model(TRUTH).with(window(&plain, Along::Time, (4.0, 10.0), &whole).unwrap());
    let decision = decided(prepared(&truth));
    assert_eq!(decision.after.added, ["viscous_friction"], "{:?}", decision.unlisted);
    let placed = &decision.after.fit.model.effects[0];
    let values: Vec<f64> = placed.values.iter().map(|v| v.value).collect();
    let (along, from, to) = regional::window(placed.entry, &values).expect("a window");
    assert!(along == Along::Time && (from - 4.0).abs() < 0.2 && (to - 10.0).abs() < 0.2, "{from} to {to}");
}

/// One that acts everywhere is named without a region.
#[test]
fn an_effect_that_acts_everywhere_has_no_region() {
    let truth = model(TRUTH).with(viscous(30.0, 0.0, (-0.2, 2.0)));
    let decision = decided(prepared(&truth));
    let plain = viscous(30.0, 0.0, (-0.2, 2.0)).entry.parameters.len();
    assert_eq!(decision.after.added, ["viscous_friction"]);
    assert_eq!(decision.after.fit.model.effects[0].values.len(), plain);
}

/// Stamps that are half a per cent apart from the truth: the clock is found, and nothing else.
#[test]
fn a_clock_at_another_rate_is_found_and_corrected() {
    let mut off = prepared(&model(TRUTH));
    off.fit.iter_mut().for_each(|run| run.dt /= 1.005);
    clock::doubt(&mut off);
    let decision = decided(off.clone());
    let finding = clock::found(&decision.after.fit, off.fit[0].dt).expect("a clock");
    assert!((finding.found / finding.stated.unwrap() - 1.005).abs() < 5e-4, "{finding:?}");
    clock::settle(&mut off, Some(&finding));
    let corrected = decided(off);
    assert!(corrected.after.added.is_empty() && !corrected.unlisted, "{:?}", corrected.after.added);
}
