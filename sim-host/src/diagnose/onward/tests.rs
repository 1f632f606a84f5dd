use super::super::decide::tests::{judged, viscous, weighing};
use super::*;
use crate::identify::data::Run;
use crate::identify::fit::tests::{TRUTH, model, recorded};
use crate::identify::model::{Model, ModelEffect};
use crate::plant::effects::entry;

/// Friction with a drifting gain, of size `rate`.
fn truth(weighing: &Weighing, rate: f64) -> Model {
    let drift = entry("gain_drift").unwrap();
    let mut drift = ModelEffect::start(drift, 0, &weighing.signal_scales()).unwrap();
    drift.values[0].value = rate;
    model(TRUTH).with(viscous(400.0, 0.0, (-0.2, 30.0))).with(drift)
}

/// Where the search grew nothing from what judging put first, one effect more that takes away most of the rest is grown, though not always
/// the true one; where the search knows such a model, nothing is.
#[test]
fn what_no_search_grew_is_grown_on() {
    let plain: Vec<Run> = (1..4).map(|seed| recorded(&model(TRUTH), seed)).collect();
    let truth = truth(&weighing(&plain), -0.0015);
    let runs: Vec<Run> = (1..4).map(|seed| recorded(&truth, seed)).collect();
    let weighing = weighing(&runs);
    let before = judged(model(TRUTH), &runs);
    let after = judged(model(TRUTH).with(viscous(60.0, 0.0, (-0.2, 30.0))), &runs);
    let signal_scales = weighing.signal_scales();
    let mut search =
        Search { baseline: before.fit.clone(), grown: vec![vec![after.fit.clone()], Vec::new()], signal_scales };
    let larger = onward(&weighing, &search, &before, &after, 6).unwrap();
    let left = [before.hold.chi2, after.hold.chi2, before.fit.chi2(), after.fit.chi2()];
    assert!(!larger.is_empty(), "nothing is grown: {left:?}");
    let best = &larger[0];
    assert!(best.added.len() == 2 && best.added.contains(&"viscous_friction"), "{:?}", best.added);
    assert!(best.hold.chi2 - 1.0 < 0.5 * (after.hold.chi2 - 1.0), "{} of {}", best.hold.chi2, after.hold.chi2);
    search.grown[1].push(best.fit.clone());
    assert!(onward(&weighing, &search, &before, &after, 6).unwrap().is_empty(), "the search has grown it");
}
