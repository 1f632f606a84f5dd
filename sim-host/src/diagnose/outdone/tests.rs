use super::super::reject_for_curve::OUTDONE;
use super::super::reject_for_curve::tests::decided_for;
use super::super::term::tests::placed;
use super::*;
use crate::identify::fit::tests::{TRUTH, model};
use crate::identify::model::{ModelEffect, SignalScales};

fn curvature() -> ModelEffect {
    ModelEffect::start(entry("displacement_nonlinearity").unwrap(), 0, &SignalScales::TYPICAL).unwrap()
}

/// Behind a loop a sensor's curvature asks for the commands that a gain asks for which depends on place; but not for all of them.
#[test]
fn a_curved_sensor_gives_way_to_a_gain_that_depends_on_place() {
    let gain = placed(
        "test_gain_by_place",
        Stage::Flow,
        &["displacement"],
        "1 - depth*(1 - cos(displacement/length))",
        &[("depth", "1", 0.2), ("length", "m", 0.03)],
    );
    let (weighing, mut decision) = decided_for(&model(TRUTH).with(gain), curvature());
    let (stated, named) = (decision.stated.hold.chi2, decision.accepted.hold.chi2);
    assert!(named < 0.9 * stated && named > 1.5, "of {stated} the name leaves {named}");
    let modelled = reject_for_valve(&weighing, &mut decision).unwrap().expect("an equation");
    assert!(modelled.judged.hold.chi2 - 1.0 < OUTDONE * (named - 1.0), "{}", modelled.judged.hold.chi2);
    assert!(decision.unlisted && decision.accepted.added.is_empty() && !modelled.names_needed);
}

/// A sensor that is curved stands, whatever its equation leaves.
#[test]
fn a_curved_sensor_stands_where_it_is_one() {
    let mut bent = curvature();
    let keys = bent.entry.parameters.iter().map(|p| p.key);
    for (key, value) in keys.zip(&mut bent.values) {
        match key {
            "cubic" => value.value = 5.0,
            "centre" => value.value = 0.02,
            _ => {}
        }
    }
    let (weighing, mut decision) = decided_for(&model(TRUTH).with(bent), curvature());
    assert!(decision.accepted.hold.chi2 > 1.5, "its centre is left: {}", decision.accepted.hold.chi2);
    assert!(reject_for_valve(&weighing, &mut decision).unwrap().is_none() && !decision.unlisted);
}
