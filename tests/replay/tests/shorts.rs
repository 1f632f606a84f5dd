//! A wire of +/-10 V that is shorted carries zero volts, which is a command like any other: what the image and the table do with it.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use crate::common::{image, near_field, seen::Mischief, seen::Seen, setup};
use shakedown_core::link::{Setup, Source, StopCause};
use shakedown_core::settings::InnerLoop;
use shakedown_core::{Mode, Trip};

/// When the fault begins: in the middle of a run, the table at speed.
const AT: usize = 9000;
/// Code of zero volts on a line of +/-10 V.
const MIDDLE: u16 = 32768;
/// Ticks that are watched after it.
const WATCHED: usize = 3000;

/// The trip, after how many ms the relay opened, and where the table was when the fault began and at the end, m.
type Outcome = (Option<StopCause>, Option<usize>, [f32; 2]);

fn outcome(setup: Setup, mut seen: Seen) -> Outcome {
    seen.limit = AT + WATCHED;
    let seen = shakedown_replay::run(&image(), seen).unwrap().world;
    assert!(seen.codes[AT - 1].relay, "the fault met no run: {:?}", seen.progress);
    let opened = seen.codes[AT..seen.codes.len() - 1].iter().position(|codes| !codes.relay);
    let places = [AT, seen.codes.len() - 1].map(|at| setup.wiring.displacement.to_si(seen.codes[at].inputs[1]));
    (seen.cause(), opened, places)
}

/// The wire from the output to the valve's amplifier is shorted.
fn output_shorted(mode: Mode, inner_loop: InnerLoop) -> Outcome {
    let mut setup = setup(mode);
    setup.control.inner_loop = inner_loop;
    let mut seen = Seen::new(setup, near_field(16));
    seen.shorted = Some((AT, MIDDLE));
    outcome(setup, seen)
}

/// The reference at the converter is shorted, its zero at the code `zero`.
fn reference_shorted(mode: Mode, zero: f32, shorted: u16) -> Outcome {
    let mut setup = setup(mode);
    setup.wiring.source = Source::Analog;
    setup.wiring.reference.zero = zero;
    let (record, scale) = (near_field(16), setup.wiring.reference);
    let reference: Mischief = Box::new(move |tick, _| {
        let now = tick.index as usize;
        let moved = record.get(now).copied().unwrap_or(0.0);
        tick.inputs[0] = if now < AT { (moved / scale.per_code + scale.zero) as u16 } else { shorted };
    });
    let mut seen = Seen::new(setup, near_field(16));
    seen.mischief = Some(reference);
    outcome(setup, seen)
}

/// The valve's amplifier gets zero whatever the device puts out: the table does not go where the command says, in any mode. A loop that
/// subtracts the LVDT takes it to its middle meanwhile.
#[test]
fn an_output_that_is_shorted_trips() {
    let wired = [
        (Mode::Controller, InnerLoop::Absent, 250),
        (Mode::Guard, InnerLoop::Absent, 250),
        (Mode::Controller, InnerLoop::Hardwired, 900),
        (Mode::Guard, InnerLoop::Hardwired, 900),
        (Mode::Modifier, InnerLoop::Absent, 900),
    ];
    for (mode, inner_loop, within) in wired {
        let (cause, opened, [from, to]) = output_shorted(mode, inner_loop);
        assert_eq!(cause, Some(StopCause::Guard(Trip::ValveStuck)), "{mode:?} {inner_loop:?}");
        assert!(opened.is_some_and(|after| after <= within), "{mode:?} {inner_loop:?}: {opened:?} ms");
        assert!((-0.001..=from + 0.001).contains(&to), "{mode:?} {inner_loop:?}: from {from} m to {to} m");
    }
}

/// A reference that is shorted is one of zero: the table goes to its middle and nothing trips.
#[test]
fn a_reference_that_is_shorted_takes_the_table_to_its_middle() {
    for mode in [Mode::Controller, Mode::Modifier] {
        let (cause, opened, [from, to]) = reference_shorted(mode, f32::from(MIDDLE), MIDDLE);
        assert_eq!((cause, opened), (None, None), "{mode:?}");
        assert!(from > 0.02 && to.abs() < 0.001, "{mode:?}: from {from} m to {to} m");
    }
}

/// With a live zero a short ends below the bottom rail, as a sensor's does.
#[test]
fn a_reference_with_a_live_zero_that_is_shorted_trips() {
    let (cause, opened, _) = reference_shorted(Mode::Controller, 32568.0, 0);
    assert_eq!(cause, Some(StopCause::Guard(Trip::SensorLost)));
    assert!(opened.is_some_and(|after| after <= 70), "{opened:?} ms");
}
