use super::super::clock;
use super::super::decide::tests::viscous;
use super::super::reach::Reach;
use super::super::split::{Split, split};
use super::super::{decide, search};
use super::ends::{PARTS, in_region_of, window};
use super::finish::after;
use super::promised::{either_sign, strengthened};
use super::*;
use crate::diagnose::Options;
use crate::identify::data::Run;
use crate::identify::fit::tests::{TRUTH, model, recorded};
use crate::identify::model::Model;
use crate::identify::model::SignalScales;
use crate::identify::prepare::Prepared;
use crate::plant::effects::regional::Along;
use crate::plant::effects::{entry, regional};

/// Three runs of a truth, of which the stated model with no value free is doubted.
fn prepared(truth: &Model) -> Prepared {
    let mut stated = model(TRUTH);
    stated.own.iter_mut().for_each(|value| value.free = false);
    let fit: Vec<Run> = (1..4).map(|seed| recorded(truth, seed)).collect();
    let signal_scales = SignalScales::of(&fit, 1.0);
    Prepared { model: stated, fit, holdout: Vec::new(), signal_scales }
}

fn decided(prepared: Prepared) -> Decision {
    let Split { weighing, .. } = split(prepared, None);
    let search = search::search(&weighing, &Options::default()).unwrap();
    let decision = decide::decide(&weighing, &search, Reach::Fitted).unwrap();
    region(&weighing, &search, decision).unwrap()
}

/// A dashpot that acts from the fourth to the tenth second of every run, and nowhere else.
#[test]
fn an_effect_that_acts_in_a_part_of_the_runs_is_named_with_its_window() {
    let plain = viscous(30.0, 0.0, (-0.2, 2.0));
    let whole: Vec<f64> = (0..=PARTS).map(|i| 15.0 * i as f64 / PARTS as f64).collect();
    let truth = model(TRUTH).with(window(&plain, Along::Time, (4.0, 10.0), &whole).unwrap());
    let decision = decided(prepared(&truth));
    assert_eq!(decision.accepted.added, ["viscous_friction"], "{:?}", decision.unlisted);
    let placed = &decision.accepted.fit.model.effects[0];
    let values = placed.numbers();
    let (along, from, to) = regional::window(placed.entry, &values).expect("a window");
    assert!(along == Along::Time && (from - 4.0).abs() < 0.2 && (to - 10.0).abs() < 0.2, "{from} to {to}");
}

/// A dashpot that acts one way is found as such, and not as the bias or the unequal gains that it resembles.
#[test]
fn an_effect_of_one_direction_is_found_along_the_velocity() {
    let plain = viscous(60.0, 0.0, (-0.2, 2.0));
    let whole: Vec<f64> = (0..=PARTS).map(|i| i as f64 / PARTS as f64 - 0.5).collect();
    let truth = model(TRUTH).with(window(&plain, Along::Velocity, (0.03, 0.6), &whole).unwrap());
    let decision = decided(prepared(&truth));
    assert_eq!(decision.accepted.added, ["viscous_friction"]);
    let placed = &decision.accepted.fit.model.effects[0];
    let (along, from, to) = regional::window(placed.entry, &placed.numbers()).expect("a window");
    assert!(along == Along::Velocity && (from - 0.03).abs() < 0.003, "from {from} along {along:?}");
    assert!(to > 1.0, "what was seen ends at the limit, and the dashpot does not: {to}");
}

/// Beneath one name a region is looked for where that leaves more than another effect could hide beneath, and takes its place where it
/// leaves nearly nothing of that.
#[test]
fn a_region_is_looked_for_beneath_a_name_that_leaves_more_than_the_noise() {
    let truth = model(TRUTH).with(viscous(30.0, 0.0, (-0.2, 2.0)));
    let mut decision = decided(prepared(&truth));
    let mut leaving = |chi2: f64| {
        decision.accepted.hold.chi2 = chi2;
        (stands(&decision), is_open(&decision))
    };
    assert_eq!([leaving(1.1), leaving(1.3)], [(true, false), (true, true)]);
    decision.accepted.added.push("leakage");
    let mismatch = decision.stated.hold.chi2 - 1.0;
    let mut leaving = |share: f64| {
        decision.accepted.hold.chi2 = 1.0 + share * mismatch;
        (stands(&decision), is_open(&decision))
    };
    assert_eq!(leaving(0.006), (false, true), "several names may be a region of one");
    assert_eq!(leaving(0.004), (false, false), "and none that leave next to nothing");
}

/// Turned round, and what is of its unit with it: alone over whole runs an effect is found with the sign that helps there.
#[test]
fn a_strength_grows_with_what_is_of_its_unit_and_may_turn_round() {
    let start = |id| ModelEffect::start(entry(id).unwrap(), 0, &SignalScales::TYPICAL).unwrap();
    let mut bias = start("null_bias");
    bias.values[0].value = 2.0;
    let friction = start("stribeck_friction");
    assert!(either_sign(&bias) && !either_sign(&friction));
    assert_eq!(strengthened(&bias, -3.0).values[0].value, -6.0);
    let ratio = |placed: &ModelEffect| placed.values[1].value / placed.values[0].value;
    let stronger = strengthened(&friction, 2.0);
    assert!(stronger.values[0].value > 1.9 * friction.values[0].value);
    assert!((ratio(&stronger) - ratio(&friction)).abs() < 1e-9, "standstill's friction grows with the sliding one");
}

/// One that acts everywhere is named without a region.
#[test]
fn an_effect_that_acts_everywhere_has_no_region() {
    let truth = model(TRUTH).with(viscous(30.0, 0.0, (-0.2, 2.0)));
    let decision = decided(prepared(&truth));
    let plain = viscous(30.0, 0.0, (-0.2, 2.0)).entry.parameters.len();
    assert_eq!(decision.accepted.added, ["viscous_friction"]);
    assert_eq!(decision.accepted.fit.model.effects[0].values.len(), plain);
}

/// Stamps that are half a per cent apart from the truth: the clock is found, and nothing else.
#[test]
fn a_clock_at_another_rate_is_found_and_corrected() {
    let mut off = prepared(&model(TRUTH));
    off.fit.iter_mut().for_each(|run| run.dt /= 1.005);
    clock::doubt(&mut off, None);
    let decision = decided(off.clone());
    let finding = clock::found(&decision.accepted.fit, off.fit[0].dt).expect("a clock");
    assert!((finding.found / finding.stated.unwrap() - 1.005).abs() < 5e-4, "{finding:?}");
    clock::settle(&mut off);
    off.fit.iter_mut().for_each(|run| run.dt *= finding.found / finding.stated.unwrap());
    let corrected = decided(off);
    assert!(corrected.accepted.added.is_empty() && !corrected.unlisted, "{:?}", corrected.accepted.added);
}

/// Only the accelerometer was recorded, and the region ends within the outermost tenth of what the runs reach.
#[test]
fn a_region_of_a_displacement_that_was_not_recorded_is_found() {
    let plain = viscous(60.0, 0.0, (-0.2, 2.0));
    let whole: Vec<f64> = (0..=PARTS).map(|i| 0.2 * i as f64 / PARTS as f64 - 0.1).collect();
    let truth = model(TRUTH).with(window(&plain, Along::Displacement, (0.004, 0.08), &whole).unwrap());
    let mut prepared = prepared(&truth);
    let highest = prepared.fit.iter().flat_map(|run| run.measured[0].values.iter()).copied().fold(0.0, f64::max);
    assert!(highest > 0.09, "{highest}");
    for run in &mut prepared.fit {
        run.measured.retain(|m| m.channel == crate::identify::data::Channel::Acceleration);
    }
    let decision = decided(prepared);
    assert_eq!(decision.accepted.added, ["viscous_friction"], "{:?}", decision.unlisted);
    let placed = &decision.accepted.fit.model.effects[0];
    let values = placed.numbers();
    let (along, from, to) = regional::window(placed.entry, &values).expect("a window");
    assert_eq!(along, Along::Displacement);
    assert!((from - 0.004).abs() < 0.001 && (to - 0.08).abs() < 0.002, "{from} to {to} of {highest}");
}

/// Another law of the same thing keeps the region, and has the values that it starts from elsewhere.
#[test]
fn a_double_is_put_into_the_same_region() {
    let start = |id, i| ModelEffect::start(entry(id).unwrap(), i, &SignalScales::TYPICAL).unwrap();
    let whole: Vec<f64> = (0..=PARTS).map(|i| i as f64).collect();
    let coulomb = window(&start("coulomb_friction", 0), Along::Time, (2.5, 6.5), &whole).unwrap();
    let plain = start("stribeck_friction", 1);
    let double = in_region_of(&coulomb, plain.clone()).unwrap();
    assert_eq!(regional::window(double.entry, &double.numbers()), Some((Along::Time, 2.5, 6.5)));
    assert_eq!(double.numbers()[..plain.values.len()], plain.numbers());
    assert!(in_region_of(&start("coulomb_friction", 0), plain).is_none(), "no region to be put into");
}

/// A law that holds another begins near it: with its peak far above the other's force it may not find back, and without a peak nothing
/// says how large that is to be.
#[test]
fn a_law_that_holds_another_begins_near_it() {
    let start = |id| ModelEffect::start(entry(id).unwrap(), 0, &SignalScales::TYPICAL).unwrap();
    let mut coulomb = start("coulomb_friction");
    coulomb.values[0].value = 3.0;
    let starts = after(&coulomb, entry("stribeck_friction").unwrap(), &SignalScales::TYPICAL);
    assert_eq!(starts.len(), 3);
    for stribeck in &starts {
        assert_eq!((stribeck.values[0].value, stribeck.values[3].value), (3.0, coulomb.values[1].value));
        assert!((stribeck.values[1].value - 3.3).abs() < 1e-9, "a tenth of the way to twice as much");
    }
    assert!((starts[2].values[2].value / starts[0].values[2].value - 10.0).abs() < 1e-9, "speeds over a decade");
    let back = after(&starts[0], entry("coulomb_friction").unwrap(), &SignalScales::TYPICAL);
    assert_eq!(back.len(), 1, "what is all known is begun once");
    assert_eq!(back[0].numbers(), coulomb.numbers());
}
