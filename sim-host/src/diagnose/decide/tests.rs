use super::super::departure::Departure;
use super::super::judged::explains_a_channel;
use super::super::standing::{at_bound, outside, sound};
use super::*;
use crate::identify::data::{Channel, Run};
use crate::identify::fit::Effort;
use crate::identify::fit::tests::{TRUTH, model, recorded};
use crate::identify::judge::score;
use crate::identify::model::{Model, ModelEffect, SignalScales, Value};
use crate::identify::prepare::Prepared;
use crate::plant::effects::entry;

/// Viscous friction whose coefficient goes up or down with speed, fitted within the given range of what speed takes.
pub(crate) fn viscous(coefficient: f64, thinning: f64, range: (f64, f64)) -> ModelEffect {
    let mut placed = ModelEffect::start(entry("viscous_friction").unwrap(), 1, &SignalScales::TYPICAL).unwrap();
    placed.values[0].value = coefficient;
    let speed = &mut placed.values[1];
    (speed.value, speed.low, speed.high, speed.free) = (thinning, range.0, range.1, true);
    placed
}

/// Judges `model`, fitted to the first two runs, on the third.
pub(crate) fn judged(model: Model, runs: &[Run]) -> ScoredModel {
    let (fitted, held_back) = runs.split_at(2);
    let mut fit = Fit::begin(model, fitted).unwrap();
    fit.improve(fitted, Effort::FULL).unwrap();
    let added = fit.model.ids_beside(&[]);
    ScoredModel {
        hold: score(&fit.model, held_back).unwrap(),
        fit,
        added,
        probability: 0.0,
        plainer: None,
        departure: Departure::none(),
    }
}

/// The first two runs to fit to and the others to weigh on, with nothing but the stated model.
pub(crate) fn weighing(runs: &[Run]) -> Weighing {
    let (fit, weighs) = runs.split_at(2);
    let signal_scales = SignalScales::of(fit, 1.0);
    let training = Prepared { model: model(TRUTH), fit: fit.to_vec(), holdout: Vec::new(), signal_scales };
    Weighing::of(training, weighs.to_vec())
}

/// A judged model of which so much is left on both kinds of stretches.
pub(crate) fn leaving(chi2: f64, template: &ScoredModel) -> ScoredModel {
    let mut judged = template.clone();
    judged.fit.squares = chi2 * judged.fit.rows as f64;
    let share = chi2 * judged.hold.rows as f64 / judged.hold.blocks.len() as f64;
    judged.hold.blocks.iter_mut().for_each(|block| *block = share);
    (judged.hold.chi2, judged.hold.colour) = (chi2, 1.0);
    judged
}

/// The same with other shares left on the runs fitted and on those that judge.
pub(crate) fn leaving_on(fitted: f64, held: f64, template: &ScoredModel) -> ScoredModel {
    let mut judged = leaving(held, template);
    judged.fit.squares = fitted * judged.fit.rows as f64;
    judged
}

/// A drag that grows faster than speed bends an equation of friction to the end of what makes sense. That explains most of
/// it, and is not what it is.
#[test]
fn what_fits_only_at_an_end_that_means_nothing_is_outside_the_library() {
    let drag = model(TRUTH).with(viscous(90.0, -0.28, (-2.0, 2.0)));
    let runs: Vec<Run> = (1..4).map(|seed| recorded(&drag, seed)).collect();
    let before = judged(model(TRUTH), &runs);
    let bounded = judged(model(TRUTH).with(viscous(90.0, 0.0, (-0.2, 2.0))), &runs);
    let explained = 1.0 - (bounded.hold.chi2 - 1.0) / (before.hold.chi2 - 1.0);
    assert!(
        explained > CALIBRATION.explained && bounded.hold.chi2 > 1.2,
        "{explained}, {} of {}",
        bounded.hold.chi2,
        before.hold.chi2
    );
    assert!(at_bound(&bounded) && outside(&before, &bounded).0 && !sound(&before, &bounded));
    // The same equation, free to be what is there, is at no end and explains it all.
    let free = judged(model(TRUTH).with(viscous(90.0, -0.2, (-2.0, 2.0))), &runs);
    assert!(!at_bound(&free) && sound(&before, &free), "chi2 {} of {}", free.hold.chi2, before.hold.chi2);
}

/// None of an effect is an end of its range that means something; as much of it as makes sense is not.
#[test]
fn the_end_at_which_an_effect_vanishes_strains_nothing() {
    let within = |low: f64, high: f64| {
        let mut placed = viscous(low, 0.0, (-0.2, 2.0));
        (placed.values[0].low, placed.values[0].high, placed.values[1].free) = (low, high, false);
        placed
    };
    let strained_on = |truth: &Model| {
        let runs: Vec<Run> = (1..4).map(|seed| recorded(truth, seed)).collect();
        at_bound(&judged(model(TRUTH).with(within(1e-2, 1.0)), &runs))
    };
    assert!(strained_on(&model(TRUTH).with(viscous(8.0, 0.0, (-0.2, 2.0)))), "an eighth of what is there");
    assert!(!strained_on(&model(TRUTH)), "where there is none");
}

/// A hum is all that the accelerometer lacks, however much more the displacement lacks of something else: a share of the whole does not
/// show that.
#[test]
fn an_effect_that_explains_one_channel_is_seen_in_it() {
    let mut hum = ModelEffect::start(entry("mains_hum").unwrap(), 0, &SignalScales::TYPICAL).unwrap();
    hum.values.iter_mut().zip([50.0, 0.0, 1.0, 0.0]).for_each(|(slot, value)| slot.value = value);
    let truth = model(TRUTH).with(viscous(120.0, -0.6, (-2.0, 2.0))).with(hum.clone());
    let runs: Vec<Run> = (1..4).map(|seed| recorded(&truth, seed)).collect();
    let (stated, humming) = (judged(model(TRUTH), &runs), judged(model(TRUTH).with(hum), &runs));
    let share = (humming.hold.chi2 - 1.0) / (stated.hold.chi2 - 1.0);
    assert!(share > 0.4, "of all that is lacking {share} is left");
    let (channel, left) = explains_a_channel(&stated, &humming)
        .unwrap_or_else(|| panic!("{:?} to {:?}", stated.hold.channels, humming.hold.channels));
    assert!(channel == Channel::Acceleration && left < 0.1, "{channel:?}: {left}");
    assert_eq!(explains_a_channel(&humming, &stated), None);
}

/// Beneath a noise that was stated too large an effect is seen by what it gains; a line stands in any noise, and what gains next to
/// nothing is the noise's own colour.
#[test]
fn what_is_named_beneath_a_noise_follows_the_motion() {
    let mut hum = ModelEffect::start(entry("mains_hum").unwrap(), 0, &SignalScales::TYPICAL).unwrap();
    hum.values.iter_mut().zip([50.0, 0.0, 0.02, 0.0]).for_each(|(slot, value)| slot.value = value);
    let drag = viscous(6.0, 0.0, (-0.2, 2.0));
    let truth = model(TRUTH).with(drag.clone()).with(hum.clone());
    let mut runs: Vec<Run> = (1..4).map(|seed| recorded(&truth, seed)).collect();
    runs.iter_mut().flat_map(|run| &mut run.measured).for_each(|measured| measured.noise *= 2.0);
    let [stated, dragged, humming] =
        [model(TRUTH), model(TRUTH).with(drag), model(TRUTH).with(hum)].map(|model| judged(model, &runs));
    assert!(stated.hold.chi2 < 1.0, "{}", stated.hold.chi2);
    assert!(follows_motion(&stated, &dragged), "{} to {}", stated.hold.chi2, dragged.hold.chi2);
    assert!(!follows_motion(&stated, &humming) && !follows_motion(&stated, &stated));
}

/// A stop explains half of a mismatch on the runs fitted and nothing on the others; lost motion, ranked behind it, stands, and with it the
/// triple that explains all. Of what is no more than noise the best alone is asked.
#[test]
fn what_is_ranked_behind_a_model_that_does_not_stand_is_asked() {
    let runs: Vec<Run> = (1..4).map(|seed| recorded(&model(TRUTH), seed)).collect();
    let template = judged(model(TRUTH), &runs);
    let of = |added: &[&'static str], fitted: f64, held: f64| ScoredModel {
        added: added.to_vec(),
        ..leaving_on(fitted, held, &template)
    };
    let alone = Alone::of_shares(&[("end_stop", 0.6), ("backlash", 0.4), ("tilt_coupling", 0.2)]);
    let chosen = |before: f64, sizes: &[Vec<ScoredModel>]| choose(&of(&[], before, before), sizes, &alone).added;
    let first = of(&["end_stop"], 6.5, 13.9);
    let sizes = [
        vec![first.clone(), of(&["backlash"], 11.0, 3.5)],
        vec![of(&["end_stop", "acceleration_gain"], 5.5, 13.8), of(&["backlash", "tilt_coupling"], 8.0, 1.3)],
        vec![of(&["backlash", "end_stop", "tilt_coupling"], 1.02, 1.02)],
    ];
    assert_eq!(chosen(14.0, &sizes), ["backlash", "end_stop", "tilt_coupling"]);
    assert!(chosen(14.0, &[vec![first]]).is_empty(), "it does not stand");
    let noise = [vec![of(&["end_stop"], 1.3, 2.0), of(&["backlash"], 1.2, 1.2)]];
    assert!(chosen(2.0, &noise).is_empty(), "noise");
}

/// A command that arrives 40 ms late looks much like `b1` of the other sign. Fitted from there it stays there; fitted near what was stated
/// it is found, and leaves no more.
#[test]
fn a_hollow_far_from_what_was_stated_is_not_the_last_word() {
    let late = |time: f64| {
        let mut placed = ModelEffect::start(entry("command_delay").unwrap(), 0, &SignalScales::TYPICAL).unwrap();
        placed.values[0].value = time;
        placed
    };
    let with = |b1: f64, free: bool| {
        let mut model = model(TRUTH);
        model.own[0] = Value { value: b1, low: -50.0, high: 50.0, positive: false, free, prior: None };
        model
    };
    let runs: Vec<Run> = (1..4).map(|seed| recorded(&with(TRUTH[0], false).with(late(0.04)), seed)).collect();
    let (fitted, weighs) = runs.split_at(2);
    let stated = with(1.1 * TRUTH[0], true);
    let prepared =
        Prepared { model: stated, fit: fitted.to_vec(), holdout: Vec::new(), signal_scales: SignalScales::TYPICAL };
    let weighing = Weighing::of(prepared, weighs.to_vec());
    let mut fit = Fit::begin(with(-3.0, true).with(late(0.004)), fitted).unwrap();
    fit.improve(fitted, Effort::FULL).unwrap();
    let bent = ScoredModel::of(fit, &weighing).unwrap();
    assert!(bent.departure.disbelief() > CHANCE, "{}", bent.departure.disbelief());
    let near = unbent(std::slice::from_ref(&bent), &weighing).unwrap();
    let [near] = &near[..] else { panic!("{} models", near.len()) };
    let time = near.fit.model.effects[0].values[0].value;
    assert!((time - 0.04).abs() < 0.002 && near.departure.disbelief() < CHANCE, "{time}");
    assert!(near.fit.squares < bent.fit.squares, "{} {}", near.fit.chi2(), bent.fit.chi2());
}

/// Of several names that stand as well none is given. Where they stand for more than noise something is missing that these data do not
/// name; where they stand for no more, nothing is.
#[test]
fn one_of_many_names_for_next_to_nothing_is_no_mismatch() {
    let runs: Vec<Run> = (1..4).map(|seed| recorded(&model(TRUTH), seed)).collect();
    let template = judged(model(TRUTH), &runs);
    let strangers = ["gain_drift", "spring", "tilt_coupling", "mains_hum"];
    let (little, more) = (scattered(strangers, 1.05, &template), scattered(strangers, 1.12, &template));
    assert!(!little.unlisted && little.accepted.added.is_empty() && little.partial.is_none());
    assert!(more.unlisted && more.partial.is_some_and(|partial| partial.added == ["gain_drift"]));
}

/// What explains a mismatch that is next to nothing is named where those that stand as well are what it is mistaken for: it is one of these.
#[test]
fn one_of_those_that_it_is_mistaken_for_is_given() {
    let runs: Vec<Run> = (1..4).map(|seed| recorded(&model(TRUTH), seed)).collect();
    let template = judged(model(TRUTH), &runs);
    let lags = ["command_delay", "valve_lag", "displacement_lag", "leakage"];
    let others = ["command_delay", "spring", "tilt_coupling", "mains_hum"];
    assert!(!scattered(lags, 1.05, &template).accepted.added.is_empty());
    assert!(scattered(others, 1.05, &template).accepted.added.is_empty());
}

/// Of a mismatch of which both leave next to nothing, one that leaves as much more as a simple form does is not told apart; one that leaves
/// more of it is, and one that leaves more than the noise is known by.
#[test]
fn what_a_simple_form_leaves_tells_nothing_apart() {
    let runs: Vec<Run> = (1..4).map(|seed| recorded(&model(TRUTH), seed)).collect();
    let template = judged(model(TRUTH), &runs);
    let of = |id: &'static str, chi2: f64| ScoredModel { added: vec![id], ..leaving(chi2, &template) };
    let tied = |stated: f64, other: f64| {
        let names = vec![of("command_delay", 1.0), of("valve_lag", other)];
        let mut decision = Decision { ties: Vec::new(), ..named(names, leaving(stated, &template)) };
        as_exact_as_its_form(&mut decision);
        decision.ties
    };
    assert_eq!(tied(1.1, 1.02), [["command_delay", "valve_lag"]]);
    assert!(tied(1.1, 1.04).is_empty(), "two fifths are left");
    assert!(tied(2.0, 1.1).is_empty(), "no noise is known that badly");
}

/// What an effect takes away from one channel is a share of what is left there, however large the noise of another.
#[test]
fn a_gain_is_a_share_of_its_own_channel() {
    let runs: Vec<Run> = (1..4).map(|seed| recorded(&model(TRUTH), seed)).collect();
    let template = judged(model(TRUTH), &runs);
    let of = |displacement: f64, acceleration: f64| {
        let mut judged = leaving(0.5 * (displacement + acceleration), &template);
        let channels = [(Channel::Displacement, displacement), (Channel::Acceleration, acceleration)];
        judged.hold.channels = channels.map(|(channel, chi2)| (channel, chi2, 1000)).to_vec();
        judged
    };
    let gained = |acceleration: f64| gained_of_a_channel(&of(0.99, 0.75), &of(0.99, acceleration));
    assert!(gained(0.735) > LEAST_GAIN && gained(0.745) < LEAST_GAIN);
}

/// What is said of names that explain nine tenths of a mismatch and stand as well as each other.
fn scattered(names: [&'static str; 4], chi2: f64, template: &ScoredModel) -> Decision {
    let with = |id: &'static str| {
        let left = leaving(0.9 + 0.1 * chi2, template);
        ScoredModel { added: vec![id], probability: 0.25, ..left }
    };
    let stated = ScoredModel { added: Vec::new(), probability: 0.25, ..leaving(chi2, template) };
    let mut decision = named(names.map(with).to_vec(), stated);
    scatter(&mut decision, 0.0);
    decision
}

/// A decision for the first of some models that stand as well as it.
fn named(models: Vec<ScoredModel>, stated: ScoredModel) -> Decision {
    let accepted = models[0].clone();
    let ties = models[1..].iter().map(|other| differing(&accepted.added, &other.added)).collect();
    Decision {
        accepted,
        ties,
        candidates: models.into_iter().chain([stated.clone()]).collect(),
        stated,
        unlisted: false,
        partial: None,
        unlisted_probability: 0.0,
        more_missing: false,
        noise: Vec::new(),
        in_full: None,
        one_of_many: false,
    }
}
