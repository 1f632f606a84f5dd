//! A sample of the fault campaign on the image: the same cases as `shakedown faults` deals, their faults put on the
//! converters' codes, the image's own answer held to the same promises. What needs a broken table stays on the host.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use crate::common::{image, near_field, seen::Mischief, seen::Seen, setup};
use shakedown::blocks::device::{DriveError, Progress};
use shakedown::blocks::faults::class::Channel;
use shakedown::blocks::faults::spoil::Spoiled;
use shakedown::blocks::faults::{Case, Clock, Fault, Motions, Promise};
use shakedown_core::Mode;
use shakedown_core::link::{Setup, StopCause};
use std::sync::{Arc, Mutex};

const SEED: u64 = 1;
/// Runs of the sample.
const SAMPLE: usize = 16;
/// When the fault begins, and when a run ends in any case, ticks.
const AT: u64 = 9000;
const END: usize = 14_000;
/// From a trip to the relay: the safe ramp, and a tick on the way in and out.
const RAMP: f64 = 0.053;

/// Where a channel's code stands among the inputs, and its scale; none for one that no board reads.
fn place(channel: Channel, setup: &Setup) -> Option<(usize, shakedown_core::link::Scale)> {
    match channel {
        Channel::Displacement => Some((1, setup.wiring.displacement)),
        Channel::Second => None,
        Channel::Acceleration => Some((2, setup.wiring.acceleration)),
        Channel::Command => Some((3, setup.wiring.external)),
    }
}

/// The mode in which a case's fault can be put on the codes; none where it cannot.
fn mode(case: &Case) -> Option<Mode> {
    match case.fault {
        // One fault at a time: a second one is a class of its own on the host.
        _ if case.second.is_some() => None,
        // No board reads a second displacement sensor.
        Fault::Signal(Channel::Second, _) => None,
        // A streamed reference has no code; an existing controller's command has.
        Fault::Signal(Channel::Command, _) => Some(Mode::Guard),
        Fault::Signal(..) if case.settings.mode == Mode::Guard => Some(Mode::Guard),
        Fault::Signal(..) | Fault::LinkCut | Fault::LinkGarbled(_) => Some(Mode::Controller),
        _ => None,
    }
}

/// The fault of `case` on codes and line; the truth, m, goes to `truth`.
fn mischief(case: &Case, setup: Setup, truth: Arc<Mutex<Vec<f32>>>) -> Mischief {
    let (fault, mut dice) = (case.fault, case.dice.clone());
    let mut spoiled = match fault {
        Fault::Signal(_, how) => Some(Spoiled::new(how, 1.0 / f64::from(setup.control.rate))),
        _ => None,
    };
    Box::new(move |tick, _| {
        truth.lock().unwrap().push(setup.wiring.displacement.to_si(tick.inputs[1]));
        if tick.index < AT {
            return;
        }
        match (fault, &mut spoiled) {
            (Fault::Signal(channel, _), Some(spoiled)) => {
                let Some((at, scale)) = place(channel, &setup) else { return };
                let arrives = spoiled.pass(f64::from(scale.to_si(tick.inputs[at])), &mut dice);
                let code = arrives / f64::from(scale.per_code) + f64::from(scale.zero);
                // An open wire ends at a rail.
                tick.inputs[at] =
                    if code.is_nan() { 0 } else { code.round().clamp(0.0, f64::from(setup.wiring.full_scale)) as u16 };
            }
            (Fault::LinkCut, _) => tick.line.to_device.clear(),
            (Fault::LinkGarbled(share), _) => {
                for byte in &mut tick.line.to_device {
                    if dice.chance(share) {
                        *byte ^= 1 << dice.below(8);
                    }
                }
            }
            _ => {}
        }
    })
}

/// Runs `case` on the image; what was broken, in words.
fn broken(case: &Case, mode: Mode) -> Vec<String> {
    let setup = setup(mode);
    let truth = Arc::new(Mutex::new(Vec::new()));
    let mut seen = Seen::new(setup, near_field(END / 1000));
    seen.mischief = Some(mischief(case, setup, Arc::clone(&truth)));
    seen.limit = END;
    let seen = shakedown_replay::run(&image(), seen).unwrap().world;
    let mut broken = Vec::new();
    let farthest = truth.lock().unwrap().iter().fold(0.0_f32, |most, x| most.max(x.abs()));
    if farthest > setup.control.stroke {
        broken.push(format!("{farthest} m from the middle"));
    }
    let opened = seen.codes[AT as usize..].iter().position(|codes| !codes.relay);
    if let Promise::Reported(Clock::Onset, within) = case.class.promise
        && !matches!(case.fault, Fault::LinkCut)
        && opened.is_none_or(|ticks| ticks as f64 * 1e-3 > within + RAMP)
    {
        broken.push(format!("the relay opened after {opened:?} ms"));
    }
    let faded = matches!(seen.progress, Progress::Failed(DriveError::Stopped { cause: StopCause::Underrun, .. }));
    if matches!(case.fault, Fault::LinkCut) && !faded {
        broken.push(format!("a cut link ended in {:?}", seen.progress));
    }
    let telemetry = seen.drive.telemetry();
    let missing: u32 = telemetry.gaps().iter().map(|gap| gap.records).sum();
    if missing != telemetry.dropped() {
        broken.push(format!("{missing} records are missing, {} are accounted for", telemetry.dropped()));
    }
    broken
}

#[test]
fn a_sample_of_the_campaign_keeps_its_promises_on_the_image() {
    let motions = Motions::new(None).unwrap();
    let cases = (0..).map(|number| Case::deal(SEED, number, None, &motions));
    let sample = cases.filter_map(|case| mode(&case).map(|mode| (case, mode))).take(SAMPLE);
    for (case, mode) in sample {
        let broken = broken(&case, mode);
        assert!(broken.is_empty(), "run {} of seed {SEED}, {} in {mode:?}: {broken:?}", case.number, case.class.id);
    }
}
