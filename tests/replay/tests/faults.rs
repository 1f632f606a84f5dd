//! Faults in the loop: each ends in the state that `docs/commissioning.md` says, with the relay open in the time it says,
//! and with every record of telemetry accounted for.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use crate::common::{image, near_field, seen::Mischief, seen::Seen, setup};
use shakedown::blocks::device::{DriveError, Progress};
use shakedown::blocks::faults::limit_switches;
use shakedown_core::link::{HostRequest, Scale, Setup, Source, StopCause};
use shakedown_core::settings::{FlowSettings, NotchSettings, TrackingSettings};
use shakedown_core::{Mode, State, Trip};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// When the fault begins: in the middle of a run.
const AT: usize = 9000;
/// Code at zero of every input.
const MIDDLE: u16 = 32768;

struct Outcome {
    seen: Seen,
    /// Time from the fault to the relay's opening, ms.
    opened_after: Option<usize>,
}

fn run(mischief: Mischief, dead_from: Option<usize>) -> Outcome {
    run_under(setup(Mode::Controller), mischief, dead_from)
}

fn run_under(setup: Setup, mischief: Mischief, dead_from: Option<usize>) -> Outcome {
    let mut seen = Seen::new(setup, near_field(12));
    seen.mischief = Some(mischief);
    // A tenth of a second.
    seen.after = (setup.control.rate / 10.0) as u32;
    seen.dead_from = dead_from;
    outcome(seen)
}

fn outcome(mut seen: Seen) -> Outcome {
    seen.limit = 16_000;
    let seen = shakedown_replay::run(&image(), seen).unwrap().world;
    assert!(seen.codes.get(AT - 1).is_some_and(|codes| codes.relay), "the fault met no run: {:?}", seen.progress);
    let opened_after = seen.codes[AT..].iter().position(|codes| !codes.relay);
    // By the clock, for a reset stops the ticks.
    let opened_after = opened_after.map(|ticks| ((seen.times[AT + ticks] - seen.times[AT]) / 1_000_000) as usize);
    Outcome { seen, opened_after }
}

/// A setup whose control takes long to work out: everything that the core has, and a soft limit's table.
fn elaborate(mut setup: Setup) -> Setup {
    let flow = FlowSettings { sharpness: 4.0, ..FlowSettings::default() };
    let tracking = TrackingSettings {
        flow,
        notch: Some(NotchSettings { frequency: 20.0, damping: 0.1 }),
        // Two ticks, as far apart as they are at the usual rate.
        spacing: 2.0 / setup.control.rate,
        ..TrackingSettings::default()
    };
    setup.control.tracking = Some(tracking);
    setup
}

/// From tick [`AT`] on, `change` acts on the input codes.
fn inputs(mut change: impl FnMut(&mut [u16; 4]) + Send + 'static) -> Mischief {
    Box::new(move |tick, _| {
        if tick.index as usize >= AT {
            change(tick.inputs);
        }
    })
}

/// Records missing between batches are those that the device says it dropped.
fn accounted_for(outcome: &Outcome) {
    let telemetry = outcome.seen.drive.telemetry();
    let missing: u32 = telemetry.gaps().iter().map(|gap| gap.records).sum();
    assert_eq!(missing, telemetry.dropped());
}

fn trips(mischief: Mischief, expected: &[StopCause], within: usize) {
    tripped(&run(mischief, None), expected, within);
}

fn tripped(outcome: &Outcome, expected: &[StopCause], within: usize) {
    assert!(outcome.seen.cause().is_some_and(|cause| expected.contains(&cause)), "{:?}", outcome.seen.progress);
    let opened = outcome.opened_after.expect("the relay stayed closed");
    assert!(opened <= within, "the relay opened after {opened} ms");
    assert_eq!(outcome.seen.codes.iter().rev().nth(1).map(|codes| codes.output), Some(MIDDLE));
    accounted_for(outcome);
}

#[test]
fn an_open_lvdt_wire_trips() {
    trips(inputs(|codes| codes[1] = 0), &[StopCause::Guard(Trip::SensorLost)], 70);
}

#[test]
fn a_saturated_lvdt_amplifier_trips() {
    trips(inputs(|codes| codes[1] = 65520), &[StopCause::Guard(Trip::SensorLost)], 70);
}

/// With a live zero (`firmware/front-end/sensor.toml`) a broken wire ends at the upper rail, a short at the lower one.
#[test]
fn an_accelerometer_at_a_rail_trips() {
    for rail in [0, 65520] {
        trips(inputs(move |codes| codes[2] = rail), &[StopCause::Guard(Trip::SensorLost)], 70);
    }
}

/// Without one a short reads zero for ever.
#[test]
fn an_accelerometer_that_is_shorted_trips() {
    trips(inputs(|codes| codes[2] = MIDDLE), &[StopCause::Guard(Trip::AccelerationStuck)], 300);
}

/// A command that is shorted is one of zero, whatever the circuit: the table stands.
#[test]
fn an_existing_command_that_is_shorted_lets_the_table_stand() {
    let outcome = run_under(setup(Mode::Guard), inputs(|codes| codes[3] = MIDDLE), None);
    assert_eq!((outcome.seen.cause(), outcome.seen.resets), (None, 0));
    assert!(outcome.seen.codes[AT - 50..AT].iter().any(|codes| codes.output != MIDDLE), "the table stood before");
    assert!(outcome.seen.codes[AT..AT + 3000].iter().all(|codes| codes.output == MIDDLE));
}

#[test]
fn a_stuck_converter_trips() {
    let mut held = None;
    let expected = [StopCause::Guard(Trip::DisplacementStuck), StopCause::Guard(Trip::SensorsDisagree)];
    trips(inputs(move |codes| codes[1] = *held.get_or_insert(codes[1])), &expected, 300);
}

#[test]
fn an_accelerometer_that_contradicts_the_lvdt_trips() {
    let half_gravity = |scale: &Scale| (0.5 * 9.81 / scale.per_code) as u16;
    let tilt = half_gravity(&setup(Mode::Controller).wiring.acceleration);
    let expected = [StopCause::Guard(Trip::SensorsDisagree)];
    trips(inputs(move |codes| codes[2] = codes[2].saturating_add(tilt).min(65_000)), &expected, 1500);
}

/// What the firmware touches and the emulator has no model for: the converter's output and the timer of its scans, which the driver
/// watches instead, and the generator of random numbers, which draws none.
#[test]
fn the_emulator_is_blind_to_the_dac_the_scans_and_the_generator_alone() {
    let ran = shakedown_replay::run(&image(), Seen::new(setup(Mode::Controller), near_field(2))).unwrap();
    let blind = |spot: &&String| !["DAC.", "TIM1.", "RNG."].iter().any(|known| spot.starts_with(known));
    assert_eq!(ran.blind_spots.iter().filter(blind).count(), 0, "{:?}", ran.blind_spots);
}

/// The DMA's stream is off for one conversion: the converter overruns, is set up again, and the test goes on.
#[test]
fn a_lost_sample_is_coasted_over() {
    let mut seen = Seen::new(setup(Mode::Controller), near_field(12));
    seen.lost_at = Some(AT);
    let seen = shakedown_replay::run(&image(), seen).unwrap().world;
    assert_eq!((seen.progress, seen.resets), (Progress::Done, 0));
    assert!(seen.codes[1000..12_000].iter().all(|codes| codes.relay));
}

#[test]
fn the_emergency_stop_trips() {
    let stop: Mischief = Box::new(|tick, _| *tick.circuit_closed = (tick.index as usize) < AT);
    trips(stop, &[StopCause::EmergencyStop], 60);
}

/// An LVDT that creeps more slowly than an unknown null lets the table drift: the loop carries the table along until a limit switch
/// opens the circuit, and it stands inside the stroke less the margin.
#[test]
fn a_limit_switch_stops_a_table_whose_lvdt_creeps() {
    let setup = setup(Mode::Controller);
    let (from, lvdt) = (limit_switches(&setup.control).unwrap(), setup.wiring.displacement);
    let margin = setup.control.guard.unwrap().envelope.margin;
    let opened_at = Arc::new(AtomicUsize::new(usize::MAX));
    let opened = Arc::clone(&opened_at);
    let creep: Mischief = Box::new(move |tick, _| {
        if lvdt.to_si(tick.inputs[1]).abs() > from as f32 {
            *tick.circuit_closed = false;
            opened.fetch_min(tick.index as usize, Ordering::Relaxed);
        }
        let crept = 0.0038 * (tick.index as f32 - AT as f32).max(0.0) / setup.control.rate;
        tick.inputs[1] -= (crept / lvdt.per_code) as u16;
    });
    let mut seen = Seen::new(setup, near_field(44));
    seen.mischief = Some(creep);
    let seen = shakedown_replay::run(&image(), seen).unwrap().world;
    let stopped =
        matches!(seen.progress, Progress::Failed(DriveError::Stopped { cause: StopCause::EmergencyStop, .. }));
    assert!(stopped, "{:?}", seen.progress);
    let opened_at = opened_at.load(Ordering::Relaxed);
    assert!(seen.codes[opened_at + 60..].iter().all(|codes| !codes.relay));
    let rests = seen.bench.displacement();
    assert!((from..f64::from(setup.control.stroke - margin)).contains(&rests), "{rests} m");
}

/// A tick that is not done when the next one comes is late, which is what an overrun is. One that takes half its period is not.
#[test]
fn a_tick_that_takes_longer_than_its_period_trips() {
    for (periods, overruns) in [(1.5, true), (0.5, false)] {
        let setup = setup(Mode::Controller);
        let mut seen = Seen::new(setup, near_field(12));
        seen.stands = Some((AT + 1, (periods * 1e9 / setup.control.rate) as u64));
        let outcome = outcome(seen);
        if overruns {
            // 50 ms of safe ramp.
            tripped(&outcome, &[StopCause::Overrun], 60);
        } else {
            assert_eq!(outcome.seen.cause(), None, "{:?}", outcome.seen.progress);
        }
    }
}

/// A setup that takes long to work out is worked out beside the ticks, at the board's highest rate as at the usual one.
#[test]
fn an_elaborate_setup_costs_no_tick() {
    for rate in [5000.0, 1000.0] {
        let mut setup = setup(Mode::Controller);
        setup.control.rate = rate;
        setup.telemetry_every = (rate / 1000.0) as u16;
        // A reference from the converter: at this rate the line is too slow for a stream.
        setup.wiring.source = Source::Analog;
        let tuned = elaborate(setup);
        assert_eq!(tuned.validate(), Ok(()));
        let mut said = false;
        let write: Mischief = Box::new(move |tick, talker| {
            if tick.index as usize >= AT && !said {
                said = true;
                talker.say(&HostRequest::WriteSetup(tuned));
            }
        });
        let outcome = run_under(setup, write, None);
        assert_eq!(outcome.seen.cause(), None, "{:?}", outcome.seen.progress);
    }
}

#[test]
fn a_link_cut_in_mid_record_fades_the_test_out() {
    let cut: Mischief = Box::new(|tick, _| {
        if tick.index as usize >= AT {
            tick.line.to_device.clear();
        }
    });
    let outcome = run(cut, None);
    assert_eq!(outcome.seen.cause(), Some(StopCause::Underrun));
    let rows = outcome.seen.drive.telemetry().rows();
    assert!(rows.iter().any(|row| row.state == State::RampDown));
    assert_eq!(rows.last().map(|row| row.state), Some(State::Ready));
    assert!(outcome.seen.codes.iter().rev().nth(1).is_some_and(|codes| codes.relay), "the table is held, not dropped");
    accounted_for(&outcome);
}

#[test]
fn garbled_frames_cost_time_and_no_point() {
    let mut bytes = 0_u32;
    let garble: Mischief = Box::new(move |tick, _| {
        for byte in &mut tick.line.to_device {
            bytes += 1;
            if bytes.is_multiple_of(997) {
                *byte ^= 0x10;
            }
        }
    });
    let outcome = run(garble, None);
    assert_eq!(outcome.seen.progress, Progress::Done);
    let played: Vec<f32> = outcome.seen.drive.telemetry().run().map(|row| row.record.reference).collect();
    assert_eq!(played[..12_000], near_field(12)[..]);
    accounted_for(&outcome);
}

#[test]
fn a_dead_converter_ends_in_a_reset_and_a_trip() {
    let outcome = run(Box::new(|_, _| {}), Some(AT));
    assert_eq!(outcome.seen.resets, 1);
    let opened = outcome.opened_after.expect("the relay stayed closed");
    assert!(opened <= 70, "the relay opened after {opened} ms");
    assert_eq!(outcome.seen.cause(), Some(StopCause::Restarted));
    assert!(
        outcome.seen.codes.iter().skip(AT + opened + 10).all(|codes| !codes.relay),
        "only an order closes it again"
    );
}
