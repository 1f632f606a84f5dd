//! The accelerometer as a second witness of displacement: what its bound is made of, and what it says at it.

use shakedown_core::blocks::filter::MotionState;
use shakedown_core::blocks::guard::{DisplacementWitness, WitnessState};
use shakedown_core::settings::{GuardSettings, InnerLoop, WitnessSettings};
use shakedown_core::{Controller, Mode, OperatorRequest, Refused, Relay, Sample, Settings, Trip};

const DT: f32 = 1e-3;
/// Frequency of the witness, rad/s, of the settings' 0.5 Hz.
const P: f32 = std::f32::consts::PI;

fn witness(settings: &WitnessSettings) -> DisplacementWitness {
    DisplacementWitness::new(settings, 0.242, DT).unwrap()
}

/// A witness that states no error at all.
fn strict() -> DisplacementWitness {
    witness(&WitnessSettings { scale: 0.0, delay: 0.0, bias: 0.0, noise: 0.0, ..WitnessSettings::default() })
}

/// Sensors that agree to the last bit contradict each other under no settings; an LVDT that leaps contradicts an accelerometer that shows
/// nothing, however much of the leap the scales explain.
#[test]
fn sensors_that_agree_are_believed_and_a_leap_is_not() {
    let mut state = WitnessState::default();
    assert!((0..100).all(|_| !strict().advance(&mut state, 0.0, 0.0)));
    for leap in [0.05, -0.05] {
        let mut state = WitnessState::default();
        let witness = witness(&WitnessSettings::default());
        assert!((0..500).any(|_| witness.advance(&mut state, leap, 0.0)), "{leap}");
    }
}

/// What two scales explain is a share of the largest motion of late, which is forgotten at a fifth of the witness's own rate.
#[test]
fn the_largest_motion_of_late_widens_the_bound() {
    let (scale, leap) = (0.05, 0.1);
    let witness = witness(&WitnessSettings { scale, ..WitnessSettings::default() });
    let mut state = WitnessState::default();
    let fixed = witness.bound(&state);
    for tick in 0..3000_u16 {
        witness.advance(&mut state, leap, 0.0);
        let expected = scale * leap * libm::expf(-0.2 * P * DT * f32::from(tick));
        let found = witness.bound(&state) - fixed;
        assert!((found - expected).abs() < 0.01 * expected, "{tick}: {found} m for {expected} m");
    }
}

/// A tick without a reading widens the bound by what a table makes of it that may have been accelerated by twice what was last read and
/// 1 m/s2, 0.231 / p of a change of its velocity; that is forgotten as the largest motion is.
#[test]
fn missed_readings_widen_the_bound_for_a_while() {
    for acceleration in [0.0_f32, 3.0, -3.0] {
        let witness = strict();
        let mut state = WitnessState::default();
        for missed in 1..=10_u8 {
            witness.coast(&mut state, acceleration);
            let expected = 0.231 / P * f32::from(missed) * DT * (2.0 * acceleration.abs() + 1.0);
            let found = witness.bound(&state);
            assert!((found - expected).abs() < 1e-3 * expected, "{missed}: {found} m for {expected} m");
        }
        let widest = witness.bound(&state);
        for tick in 1..=3000_u16 {
            witness.advance(&mut state, 0.0, 0.0);
            let expected = widest * libm::expf(-0.2 * P * DT * f32::from(tick));
            let found = witness.bound(&state);
            assert!((found - expected).abs() < 0.01 * expected, "{tick}: {found} m for {expected} m");
        }
    }
}

/// Where the table stood before it was moved is no motion: a test that begins away from the middle begins with the bound of one that
/// begins there.
#[test]
fn a_test_may_begin_anywhere() {
    let witness = witness(&WitnessSettings::default());
    let fixed = witness.bound(&WitnessState::default());
    for x in [0.1, -0.1] {
        let mut state = WitnessState::default();
        // What was before is forgotten as well.
        witness.coast(&mut state, 30.0);
        witness.follow(&mut state, &MotionState::at(x), x);
        for _ in 0..1000 {
            assert!(!witness.advance(&mut state, x, 0.0));
            assert!((witness.bound(&state) - fixed).abs() < 1e-6, "{x} m: {} m", witness.bound(&state) - fixed);
        }
    }
}

/// A witness may be as fast as an observer: a twentieth of the rate, whatever the rate.
#[test]
fn the_highest_frequency_is_a_twentieth_of_the_rate() {
    for rate in [200.0_f32, 1000.0, 8000.0] {
        let refused = |frequency: f32| {
            let settings = WitnessSettings { frequency, ..WitnessSettings::default() };
            DisplacementWitness::new(&settings, 0.242, 1.0 / rate).err().map(|error| error.field)
        };
        assert_eq!(refused(0.0499 * rate), None);
        assert_eq!(refused(0.0501 * rate), Some("guard.witness.frequency"));
    }
}

/// A table without oil stands. One whose reading moves evenly before it is armed would be followed by the witness, which sees the onset of a
/// drift and not the drift; so it is not armed, and is as soon as the reading stands.
#[test]
fn a_reading_that_moves_without_oil_refuses_arming() {
    let settings = Settings { guard: Some(GuardSettings::default()), ..Settings::default() };
    for speed in [0.02, -0.113] {
        let mut controller = Controller::new(&settings).unwrap();
        let mut reading = 0.0;
        let mut rest = |controller: &mut Controller, ticks: u16, speed: f32| {
            for _ in 0..ticks {
                reading += speed * DT;
                controller.step(&Sample::new(0.0, reading, 0.0));
            }
            controller.request(OperatorRequest::Arm)
        };
        assert_eq!(rest(&mut controller, 200, speed), Err(Refused::Cause(Trip::SensorsDisagree)), "{speed} m/s");
        assert_eq!(rest(&mut controller, 1000, 0.0), Ok(()));
    }
}

/// Zero flow of a loop that subtracts the LVDT follows it, spikes and all: with an LVDT that is not believed only the relay stops the
/// table, at the tick of the trip. Where nothing subtracts it, the safe ramp comes first.
#[test]
fn an_lvdt_that_is_doubted_opens_the_relay_of_a_loop_that_subtracts_it() {
    let of =
        |mode, inner_loop| Settings { mode, inner_loop, guard: Some(GuardSettings::default()), ..Settings::default() };
    let wirings = [
        (of(Mode::Modifier, InnerLoop::Absent), Relay::Open),
        (of(Mode::Controller, InnerLoop::Hardwired), Relay::Open),
        (of(Mode::Controller, InnerLoop::Absent), Relay::Closed),
    ];
    let faults: [(Trip, fn(u8) -> f32); 2] = [
        (Trip::SensorsDisagree, |_| 0.08),
        (Trip::DisplacementNoisy, |tick| if tick.is_multiple_of(2) { 0.004 } else { -0.004 }),
    ];
    for (settings, relay) in wirings {
        for (cause, reading) in faults {
            let mut controller = Controller::new(&settings).unwrap();
            (0..100).for_each(|_| _ = controller.step(&Sample::default()));
            controller.request(OperatorRequest::Arm).unwrap();
            // An accelerometer that reads the same to the last bit would be stuck.
            let sample = |tick: u8| Sample::new(0.0, reading(tick), if tick.is_multiple_of(2) { 0.05 } else { -0.05 });
            let mut ticks = (0..200).map(|tick| controller.step(&sample(tick)).status);
            let tripped = ticks.find(|status| status.trip.is_some()).unwrap();
            assert_eq!((tripped.trip, tripped.relay), (Some(cause), relay), "{:?}", settings.mode);
        }
    }
}
