use super::super::decide::tests::viscous;
use super::super::split::{Weighing, split};
use super::super::structure::Structure;
use super::refusal::is_needed;
use super::refusal::tests::SURE_NAMES;
use super::*;
use crate::identify::data::Channel;
use crate::identify::fit::tests::{TRUTH, model, recorded};
use crate::identify::model::{Model, ModelEffect, SignalScales};
use crate::plant::effects::entry;

/// Two runs of `fitted_truth` to fit and one of `held_truth` to judge.
fn prepared(fitted_truth: &Model, held_truth: &Model) -> Prepared {
    let fit: Vec<Run> = (1..3).map(|seed| recorded(fitted_truth, seed)).collect();
    let signal_scales = SignalScales::of(&fit, 1.0);
    Prepared { model: model(TRUTH), fit, holdout: vec![recorded(held_truth, 3)], signal_scales }
}

/// What is selected of two runs of `fitted_truth` where `named` is named, judged on a run of `held_truth`.
pub(in super::super) fn concluded(fitted_truth: &Model, held_truth: &Model, named: Model) -> Conclusion {
    judged_on(prepared(fitted_truth, held_truth), None, named, |decision| decision)
}

/// The same of what was prepared, searched on an excerpt of it.
fn judged_on(
    whole: Prepared,
    excerpt: Option<Prepared>,
    named: Model,
    decided: impl Fn(Decision) -> Decision,
) -> Conclusion {
    let cut = split(whole, excerpt);
    let judged = |model: Model, weighing: &Weighing| {
        let mut fit = Fit::begin(model, weighing.fitted()).unwrap();
        fit.improve(weighing.fitted(), Effort::FULL).unwrap();
        ScoredModel::of(fit, weighing).unwrap()
    };
    let (before, after) = (judged(model(TRUTH), &cut.weighing), judged(named, &cut.weighing));
    let candidates = vec![ScoredModel { probability: 0.98, ..after.clone() }];
    let decision = Decision {
        stated: before,
        accepted: ScoredModel { probability: 0.98, ..after },
        candidates,
        ties: Vec::new(),
        unlisted: false,
        partial: None,
        unlisted_probability: 0.02,
        more_missing: false,
        noise: Vec::new(),
        in_full: None,
        one_of_many: false,
    };
    verdict(&cut.whole, cut.weighing.fitted(), decided(decision), None, cut.test).unwrap()
}

pub(in super::super) fn with_viscous(coefficient: f64) -> Model {
    model(TRUTH).with(viscous(coefficient, 0.0, (-0.2, 2.0)))
}

/// What is there on every run is confirmed on the one held out.
#[test]
fn a_name_that_holds_on_the_test_stands() {
    let truth = with_viscous(90.0);
    let conclusion = concluded(&truth, &truth, with_viscous(50.0));
    assert!(conclusion.refusal.is_none() && !conclusion.unlisted && conclusion.held_out);
    assert_eq!(conclusion.accepted.added, ["viscous_friction"]);
    assert!(
        conclusion.accepted.hold.chi2 < 1.1 && conclusion.stated.hold.chi2 > 2.0,
        "{}",
        conclusion.stated.hold.chi2
    );
}

/// What was there on the runs fitted and is not on the run held out makes that one worse than the stated model does: the
/// name is taken back, and belief goes where no name is.
#[test]
fn a_name_that_the_test_contradicts_is_taken_back() {
    let conclusion = concluded(&with_viscous(90.0), &model(TRUTH), with_viscous(50.0));
    assert!(
        matches!(conclusion.refusal, Some(Refusal::Worse { .. } | Refusal::NoGain { .. })),
        "{:?}",
        conclusion.refusal
    );
    assert!(conclusion.unlisted && conclusion.partial.is_some());
    assert!(
        conclusion.decision.unlisted_probability >= 0.9 && conclusion.decision.candidates[0].probability <= 0.1 + 1e-9
    );
}

/// A name that the run held out refuses is no mismatch where the stated model leaves nothing, there and of the runs fitted.
#[test]
fn a_name_that_is_refused_where_nothing_is_missing_is_no_mismatch() {
    let Conclusion { stated, .. } = concluded(&model(TRUTH), &model(TRUTH), model(TRUTH));
    let worse = Refusal::Worse { channel: "displacement", ratio: 1.2 };
    assert!(leaves_nothing(&stated, &worse));
    let mut missed = stated.clone();
    missed.fit.squares = 1.2 * missed.fit.rows as f64;
    assert!(!leaves_nothing(&missed, &worse), "the runs fitted show something");
}

/// This and dry friction, so many times the library's start.
fn beside_friction(model: &Model, times: f64) -> Model {
    let mut friction = ModelEffect::start(entry("coulomb_friction").unwrap(), 0, &SignalScales::TYPICAL).unwrap();
    friction.values[0].value *= times;
    model.with(friction)
}

/// Names that leave a rest which is no noise may be something that looks like them: what is said of them is less sure.
#[test]
fn a_rest_beyond_the_noise_takes_a_share_of_the_belief() {
    let with_rest = |truth: &Model| {
        let conclusion = concluded(truth, truth, with_viscous(50.0));
        (conclusion.accepted.hold.chi2, conclusion.decision.candidates[0].probability)
    };
    let truth = with_viscous(90.0);
    let (left, sure) = with_rest(&truth);
    assert!(left < 1.06 && sure >= 0.9, "{left} {sure}");
    let (left, less) = with_rest(&beside_friction(&truth, 30.0));
    assert!(left > 1.2 && less < sure, "{left} {less}");
}

/// A misfit of the run held out that is no noise and ten times that of the runs fitted is looked at anew, beside whatever name.
#[test]
fn a_rest_that_only_the_test_shows_is_unforeseen() {
    let truth = with_viscous(90.0);
    let conclusion = concluded(&truth, &beside_friction(&truth, 20.0), with_viscous(50.0));
    let (fit, held) = (conclusion.accepted.fit.chi2(), conclusion.accepted.hold.chi2);
    assert!(fit < 1.1 && held > 2.5, "{fit} {held}");
    assert!(conclusion.unforeseen());
    assert!(!concluded(&truth, &truth, with_viscous(50.0)).unforeseen());
}

/// Where nothing was selected and the run held out shows something, the verdict is not that all is well.
#[test]
fn what_only_the_test_shows_is_no_agreement() {
    let conclusion = concluded(&model(TRUTH), &with_viscous(90.0), model(TRUTH));
    assert!(conclusion.unlisted && !conclusion.consistent() && conclusion.unforeseen());
}

/// A name that was taken back because others stand as well is given where it explains the runs held out whole, and not where these show
/// something else.
#[test]
fn one_of_many_is_given_where_it_explains_all() {
    let taken_back = |decision: Decision| {
        let mut decision = Decision {
            partial: Some(decision.accepted),
            accepted: decision.stated.clone(),
            unlisted: true,
            one_of_many: true,
            ..decision
        };
        decision.take_back(0.7);
        decision
    };
    let truth = with_viscous(90.0);
    let given = |held: &Model| judged_on(prepared(&truth, held), None, with_viscous(50.0), taken_back);
    let named = given(&truth);
    assert_eq!(named.accepted.added, ["viscous_friction"]);
    assert!(!named.unlisted && named.partial.is_none() && named.decision.unlisted_probability == 0.0);
    assert!((named.decision.candidates[0].probability - 1.0).abs() < 1e-12);
    assert!(given(&with_viscous(50.0)).unlisted, "half of it is no explanation of the whole");
}

/// The part of a run from one sample on, as a run of its own.
fn tail(run: &Run, first: usize) -> Run {
    let mut tail = run.clone();
    tail.input.drain(..first);
    for measured in &mut tail.measured {
        measured.values.drain(..first);
    }
    Run { from: run.from + first as f64 * run.dt, moving_start: true, ..tail }
}

/// Of a run of which some stretches were fitted the others are predicted from where the fit says that it starts: its first sample may
/// be among those of neither.
#[test]
fn stretches_of_a_run_that_was_fitted_start_where_it_does() {
    let truth = with_viscous(90.0);
    let run = Run { moving_start: true, ..recorded(&truth, 1) };
    let of = |kept: std::ops::Range<usize>| {
        let mut run = run.clone();
        for measured in &mut run.measured {
            let out = measured.values.iter_mut().enumerate().filter(|(k, _)| !kept.contains(k));
            out.for_each(|(_, value)| *value = f64::NAN);
        }
        run
    };
    let (fitted, judging) = ([of(0..1500)], [of(1500..3000)]);
    let mut known = truth;
    known.values_mut().for_each(|value| value.free = false);
    let mut fit = Fit::begin(known, &fitted).unwrap();
    fit.improve(&fitted, Effort::FULL).unwrap();
    let beside = score_beside(&fit, &fitted, &judging).unwrap().chi2;
    assert!(beside < 1.2, "{beside}");
    let anew = score(&fit.model, &judging).unwrap().chi2;
    assert!(anew > 2.0 * beside, "{anew}");
}

/// What predicts one channel far better may be a little worse of another; what is worse in all is not.
#[test]
fn each_channel_has_its_say_in_what_is_worse() {
    let truth = with_viscous(90.0);
    let Conclusion { stated: before, accepted: after, judging, .. } = concluded(&truth, &truth, with_viscous(50.0));
    let refused = |displacement: f64, acceleration: f64| {
        let mut named = after.clone();
        for (channel, nrmse) in &mut named.hold.nrmse {
            let stated = before.hold.nrmse.iter().find(|(c, _)| c == channel).unwrap().1;
            *nrmse = stated * if *channel == Channel::Displacement { displacement } else { acceleration };
        }
        matches!(refusal(&before, &named, &judging, SURE_NAMES), Some(Refusal::Worse { .. }))
    };
    assert!(!refused(0.1, 1.2));
    assert!(refused(0.95, 1.2));
}

/// What was searched on an excerpt is fitted to the whole from where the whole begins: an excerpt's start is another place.
#[test]
fn an_excerpt_begins_elsewhere_than_its_run() {
    let truth = with_viscous(90.0);
    let fit: Vec<Run> = (1..3).map(|seed| recorded(&truth, seed)).collect();
    let signal_scales = SignalScales::of(&fit, 1.0);
    let excerpt = fit.iter().map(|run| tail(run, 1300)).collect();
    let with = |fit, holdout| Prepared { model: model(TRUTH), fit, holdout, signal_scales };
    let (whole, excerpt) = (with(fit, vec![recorded(&truth, 3)]), with(excerpt, Vec::new()));
    let conclusion = judged_on(whole, Some(excerpt), with_viscous(50.0), |decision| decision);
    assert_eq!(conclusion.accepted.added, ["viscous_friction"]);
    assert!(conclusion.accepted.fit.chi2() < 1.1, "{}", conclusion.accepted.fit.chi2());
    assert!(conclusion.accepted.hold.chi2 < 1.1, "{}", conclusion.accepted.hold.chi2);
}

/// Where nothing is missing and a name's size is nothing, the verdict is that nothing is missing: not that what is has no name.
#[test]
fn a_name_of_no_size_leaves_the_stated_model_standing() {
    let mut bias = ModelEffect::start(entry("null_bias").unwrap(), 0, &SignalScales::TYPICAL).unwrap();
    bias.values[0].value = 1e-5;
    let conclusion = concluded(&model(TRUTH), &model(TRUTH), model(TRUTH).with(bias));
    assert_eq!(conclusion.refusal, Some(Refusal::NotTold { id: "null_bias" }));
    assert!(conclusion.consistent());
    let none = conclusion.decision.candidates.iter().filter(|c| c.added.is_empty());
    assert!(none.map(|c| c.probability).all(|p| p > 0.5) && conclusion.decision.unlisted_probability < 0.05);
}

/// Of two names the one whose size is nothing is taken back, and the other stands.
#[test]
fn a_name_of_no_size_beside_another_is_taken_back_alone() {
    let mut bias = ModelEffect::start(entry("null_bias").unwrap(), 0, &SignalScales::TYPICAL).unwrap();
    bias.values[0].value = 1e-5;
    let truth = with_viscous(90.0);
    let conclusion = concluded(&truth, &truth, with_viscous(50.0).with(bias));
    assert_eq!(conclusion.accepted.added, ["viscous_friction"]);
    assert!(conclusion.refusal.is_none() && !conclusion.unlisted && !conclusion.more_missing);
    assert!(conclusion.accepted.hold.chi2 < 1.1, "{}", conclusion.accepted.hold.chi2);
}

/// However its values lean on each other, an effect is needed where the runs that judge are predicted better with it.
#[test]
fn what_the_judging_runs_need_is_there() {
    let truth = with_viscous(20.0);
    let conclusion = concluded(&truth, &truth, with_viscous(10.0));
    assert!(is_needed(&conclusion.stated, &conclusion.accepted), "{}", conclusion.stated.hold.chi2);
    assert!(
        !is_needed(&conclusion.accepted, &conclusion.stated) && !is_needed(&conclusion.accepted, &conclusion.accepted)
    );
}

/// A displacement that is explained does not hide an acceleration that is not, where that follows the motion and is beyond any noise.
#[test]
fn a_channel_that_is_hardly_explained_is_more_that_is_missing() {
    let truth = with_viscous(90.0);
    let done = concluded(&truth, &truth, with_viscous(50.0)).accepted;
    let with = |acceleration: f64, displacement: f64| {
        let mut judged = done.clone();
        judged.hold.channels =
            vec![(Channel::Acceleration, acceleration, 1000), (Channel::Displacement, displacement, 1000)];
        judged
    };
    let certain = Structure { foretold: 1.0, certainty: 9.0 };
    let follows = |of: Structure| Followed {
        structures: vec![(Channel::Acceleration, of)],
        estimated: Vec::new(),
        fitted: Vec::new(),
    };
    let (before, after) = (with(5.8, 56.5), with(5.2, 1.0));
    assert!(follows(certain).leaves_a_channel(&before, &after));
    assert!(!follows(Structure::default()).leaves_a_channel(&before, &after));
    assert!(!follows(certain).leaves_a_channel(&with(50.0, 56.5), &after), "nine tenths are explained");
    assert!(!follows(certain).leaves_a_channel(&with(2.4, 56.5), &with(2.2, 1.0)), "noise may be as large");
}
