use super::super::decide::tests::{judged, leaving, viscous, weighing};
use super::*;
use crate::identify::data::Run;
use crate::identify::fit::tests::{TRUTH, model, recorded};

/// Friction of which speed takes nothing and friction of which speed takes much, each fitted with that detail free.
fn with_detail(truth: f64) -> (Vec<Run>, ScoredModel) {
    let runs: Vec<Run> =
        (1..4).map(|seed| recorded(&model(TRUTH).with(viscous(90.0, truth, (-0.2, 30.0))), seed)).collect();
    let fitted = judged(model(TRUTH).with(viscous(60.0, 0.1, (-0.2, 30.0))), &runs);
    (runs, fitted)
}

/// A detail that explains nothing is put back, and what is left is as good; one that is there stays.
#[test]
fn details_that_explain_nothing_are_put_back() {
    for (truth, free) in [(0.0, 0), (5.0, 1)] {
        let (runs, fitted) = with_detail(truth);
        let weighing = weighing(&runs);
        let before = judged(model(TRUTH), &runs);
        assert_eq!(fitted.fit.model.plain(&fitted.added).1, 1);
        let mut models = vec![fitted.clone()];
        simplify(&before, &mut models, &weighing).unwrap();
        assert_eq!(models[0].fit.model.plain(&models[0].added).1, free, "thinning {truth}");
        assert!(models[0].hold.chi2 < 1.1, "chi2 {} is left", models[0].hold.chi2);
    }
}

/// A name is weighed at the better of its forms: details that were fitted last to predict better do not count against it.
#[test]
fn a_name_is_weighed_at_the_better_of_its_forms() {
    let (runs, fitted) = with_detail(0.0);
    let before = judged(model(TRUTH), &runs);
    let plain = ScoredModel::of(
        Fit::resume(fitted.fit.model.plain(&fitted.added).0, fitted.fit.locals.clone(), &runs[..2]).unwrap(),
        &weighing(&runs),
    );
    let plain = plain.unwrap();
    let ranking = Ranking::new(&before, [&fitted, &plain]);
    let both = ScoredModel { plainer: Some(Box::new(plain.clone())), ..fitted.clone() };
    let least = ranking.cost(&plain).min(ranking.cost(&fitted));
    assert!(ranking.cost(&plain) < ranking.cost(&fitted) && ranking.cost(&both) <= least);
}

/// A value at an end that means nothing speaks against a name, but not where that name alone explains the mismatch to the noise.
#[test]
fn what_alone_explains_to_the_noise_comes_first_at_an_end_too() {
    let drag = model(TRUTH).with(viscous(90.0, -0.28, (-2.0, 2.0)));
    let runs: Vec<Run> = (1..4).map(|seed| recorded(&drag, seed)).collect();
    let bounded = judged(model(TRUTH).with(viscous(90.0, 0.0, (-0.2, 2.0))), &runs);
    let within =
        ScoredModel { added: vec!["spring"], ..judged(model(TRUTH).with(viscous(90.0, 0.0, (-2.0, 2.0))), &runs) };
    assert!(at_bound(&bounded) && !at_bound(&within));
    let leaves = |chi2: f64, template: &ScoredModel| {
        let mut model = leaving(chi2, template);
        model.hold.channels.iter_mut().for_each(|(_, left, _)| *left = chi2);
        model
    };
    let before = leaves(300.0, &judged(model(TRUTH), &runs));
    let first = |at_end: f64, sensible: f64| {
        best_of(&before, leaves(at_end, &bounded), vec![leaves(sensible, &within)]).0.added == bounded.added
    };
    assert!(first(1.0, 3.0), "alone within the noise");
    assert!(!first(1.0, 1.05), "both within the noise");
    assert!(!first(2.0, 3.0), "neither within the noise");
}
