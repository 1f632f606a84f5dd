//! The guard's parts one by one, to the tick and to the last digit that a limit has: what a random run would pass by.

#![allow(clippy::unwrap_used, reason = "the lint knows test functions, not helpers")]

use shakedown_core::blocks::filter::{MotionObserver, MotionState};
use shakedown_core::blocks::guard::{
    Creep, DebouncedSignals, Envelope, EnvelopeState, InputGate, InputMonitor, InputState, NoiseMonitor, NoiseState,
    Plausibility, PlausibilityState, Ramps, Supervisor, ValveMonitor, ValveMonitorState,
};
use shakedown_core::settings::{
    EnvelopeSettings, ForceSettings, InputSettings, PlausibilitySettings, RampSettings, ReferenceRates,
    ValveMonitorSettings, VelocitySource,
};
use shakedown_core::{Channels, Mode, OperatorRequest, Refused, Relay, Sample, Settings, State, Trip};

const DT: f32 = 0.003;

fn envelope() -> Envelope {
    let settings = EnvelopeSettings {
        margin: 0.02,
        stopping_latency: 0.1,
        stopping_deceleration: 2.0,
        velocity: 0.4,
        acceleration: 5.0,
        jerk: 1000.0,
        force: Some(ForceSettings { limit: 1000.0, piston_area: 0.01 }),
        tracking: 0.05,
        persistence: 0.0091,
    };
    Envelope::new(&settings, 0.12, DT).unwrap()
}

#[test]
fn the_stopping_distance_is_latency_and_braking() {
    for v in [-0.4_f32, -0.1, 0.0, 0.1, 0.4] {
        let expected = v * 0.1 + v * v.abs() / 4.0;
        assert!((envelope().stopping_distance(v) - expected).abs() < 1e-7, "{v}");
    }
}

#[test]
fn the_envelope_is_left_where_the_table_could_not_stop() {
    let envelope = envelope();
    let room = 0.12_f32 - 0.02;
    // Room 0.1 m; at 0.2 m/s it takes 0.03 m to stand. At a limit nothing is said.
    for (x, v, cause) in [
        (room, 0.0, None),
        (room, -0.2, None),
        (room, -0.401, Some(Trip::Velocity)),
        (0.0, 0.4, None),
        (0.069, 0.2, None),
        (0.071, 0.2, Some(Trip::Displacement)),
        (-0.069, -0.2, None),
        (-0.071, -0.2, Some(Trip::Displacement)),
        (0.071, -0.2, None),
        (0.0999, 0.0, None),
        (0.1001, 0.0, Some(Trip::Displacement)),
        (-0.1001, 0.0, Some(Trip::Displacement)),
        // Beyond its room, on the way back.
        (0.101, -0.2, Some(Trip::Displacement)),
        (-0.101, 0.2, Some(Trip::Displacement)),
        (0.0, 0.399, None),
        (0.0, 0.401, Some(Trip::Velocity)),
        (0.0, -0.401, Some(Trip::Velocity)),
        // Both at once, on the way back: where it is counts for more than how fast.
        (0.12, -0.401, Some(Trip::Displacement)),
    ] {
        assert_eq!(envelope.left_by(x, v), cause, "at {x} m with {v} m/s");
    }
}

#[test]
fn what_may_last_trips_one_tick_after_its_time() {
    let quiet = DebouncedSignals { acceleration: 0.0, pressure_difference: 0.0, error: 0.0 };
    for (motion, cause) in [
        (DebouncedSignals { pressure_difference: 100_100.0, ..quiet }, Trip::Force),
        (DebouncedSignals { pressure_difference: -100_100.0, ..quiet }, Trip::Force),
        (DebouncedSignals { error: 0.0501, ..quiet }, Trip::Tracking),
        (DebouncedSignals { error: -0.0501, ..quiet }, Trip::Tracking),
    ] {
        let mut state = EnvelopeState::default();
        // 9.1 ms are three turns of 3 ms: the fourth trips.
        let told: Vec<_> = (0..4).map(|_| envelope().advance(&mut state, &motion)).collect();
        assert_eq!(told, [None, None, None, Some(cause)]);
        // One good turn, and the time begins anew.
        assert_eq!(envelope().advance(&mut state, &quiet), None);
        assert_eq!(envelope().advance(&mut state, &motion), None);
    }
    for good in [100_000.0, -100_000.0] {
        let mut state = EnvelopeState::default();
        let motion = DebouncedSignals { pressure_difference: good, error: 0.05, ..quiet };
        assert!((0..20).all(|_| envelope().advance(&mut state, &motion).is_none()));
    }
}

#[test]
fn acceleration_and_its_steps_are_told_apart() {
    let run = |accelerations: &[f32]| {
        let mut state = EnvelopeState::default();
        let motion = |a: &f32| DebouncedSignals { acceleration: *a, pressure_difference: 0.0, error: 0.0 };
        accelerations.iter().filter_map(|a| envelope().advance(&mut state, &motion(a))).collect::<Vec<_>>()
    };
    // 1000 m/s3 are 3 m/s2 from turn to turn.
    assert_eq!(run(&[2.9, 4.9, 4.9, 4.9, 4.9, 4.9]), []);
    assert_eq!(run(&[2.9, 5.1, 5.1, 5.1, 5.1]), [Trip::Acceleration]);
    assert_eq!(run(&[-2.9, -5.1, -5.1, -5.1, -5.1]), [Trip::Acceleration]);
    assert_eq!(run(&[1.6, -1.6, 1.6, -1.6, 1.6]), [Trip::Jerk]);
    assert_eq!(run(&[1.4, -1.4, 1.4, -1.4, 1.4]), []);
    // At the limit nothing is said.
    assert_eq!(run(&[2.5, 5.0, 5.0, 5.0, 5.0, 5.0]), []);
    assert_eq!(run(&[1.5, -1.5, 1.5, -1.5, 1.5]), []);
}

#[test]
fn fields_of_the_envelope_are_refused_by_name() {
    let refused = |settings: EnvelopeSettings| Envelope::new(&settings, 0.12, DT).unwrap_err().field;
    let good = EnvelopeSettings::default();
    assert_eq!(refused(EnvelopeSettings { margin: 0.109, ..good }), "guard.envelope.margin");
    assert_eq!(refused(EnvelopeSettings { velocity: f32::NAN, ..good }), "guard.envelope.velocity");
    let force = Some(ForceSettings { limit: 0.0, piston_area: 0.01 });
    assert_eq!(refused(EnvelopeSettings { force, ..good }), "guard.envelope.force.limit");
}

/// What a monitor at 3 ms says of readings given turn by turn, and at which.
fn plausible(readings: impl Iterator<Item = (f32, f32, MotionState)>) -> Option<(usize, Trip)> {
    let settings = PlausibilitySettings { stuck: 0.0301, disagreement: 2e-3, offset: 3.0, ..Default::default() };
    let monitor = Plausibility::new(&settings, DT).unwrap();
    let mut state = PlausibilityState::default();
    readings.enumerate().find_map(|(k, (x, a, seen))| Some((k, monitor.advance(&mut state, x, a, &seen)?)))
}

fn innovation(size: f32) -> MotionState {
    MotionState { innovation: size, ..MotionState::default() }
}

#[test]
fn a_sensor_is_stuck_after_its_time_if_the_other_moves() {
    // Ten turns without a change are 30 ms; a quarter of the disagreement is reached meanwhile.
    let stuck_x = plausible((0..400).map(|k| (0.01, 0.1 * (k % 7) as f32, innovation(1.5e-3))));
    assert_eq!(stuck_x, Some((11, Trip::DisplacementStuck)));
    let stuck_a = plausible((0..400).map(|k| (1e-4 * (k % 7) as f32, 0.3, innovation(-1.5e-3))));
    assert_eq!(stuck_a, Some((11, Trip::AccelerationStuck)));
    // Below a quarter it is rest.
    assert_eq!(plausible((0..400).map(|_| (0.01, 0.3, innovation(0.49e-3)))), None);
    // A reading that changes now and then is not stuck.
    assert_eq!(plausible((0..400).map(|k| (1e-4 * (k / 9) as f32, (k / 9) as f32 * 0.1, innovation(1.5e-3)))), None);
}

#[test]
fn sensors_that_disagree_are_told_from_a_noisy_one() {
    let moving = |k: usize| (1e-4 * (k % 7) as f32, 0.1 * (k % 5) as f32);
    let with = |size: &dyn Fn(usize) -> f32| {
        plausible((0..400).map(|k| (moving(k).0, moving(k).1, innovation(size(k))))).map(|(_, trip)| trip)
    };
    assert_eq!(with(&|_| 2.1e-3), Some(Trip::SensorsDisagree));
    assert_eq!(with(&|_| -2.1e-3), Some(Trip::SensorsDisagree));
    assert_eq!(with(&|_| 1.9e-3), None);
    assert_eq!(with(&|k| if k % 2 == 0 { 3e-3 } else { -3e-3 }), Some(Trip::DisplacementNoisy));
    let off = |offset: f32| {
        let seen = MotionState { offset, ..MotionState::default() };
        plausible((0..10).map(|k| (moving(k).0, moving(k).1, seen))).map(|(_, trip)| trip)
    };
    assert_eq!((off(3.1), off(-3.1)), (Some(Trip::SensorsDisagree), Some(Trip::SensorsDisagree)));
    assert_eq!((off(3.0), off(-3.0)), (None, None));
}

/// What a monitor of noise at 1 ms says of accelerations (m/s2) given tick by tick, with a limit of 3 m/s2 beside motion.
fn noisy(accelerations: impl Iterator<Item = f32>) -> Option<Trip> {
    let (settings, envelope) = (PlausibilitySettings::default(), EnvelopeSettings::default());
    let monitor = NoiseMonitor::new(&settings, &envelope, true, 0.001).unwrap();
    let mut state = NoiseState::default();
    accelerations.into_iter().find_map(|a| monitor.advance(&mut state, 0.0, a))
}

#[test]
fn an_accelerometer_is_noisy_when_its_roughness_lasts() {
    // An alternating reading of size s has third differences of 8 s: 8 / sqrt(10) s beside 3 m/s2 and what a sine of 100 Hz
    // and 5000 m/s3 makes of it: 0.37 m/s2.
    let limit = 3.0 + 2.0 / std::f32::consts::PI * (5000.0 / 628.3) * 0.236 * 0.316_23;
    let rough = |step: f32| noisy((0..2000).map(|k| if k % 2 == 0 { step } else { -step }));
    assert_eq!(rough(1.01 * limit * 0.395_28), Some(Trip::AccelerationNoisy));
    assert_eq!(rough(0.99 * limit * 0.395_28), None);
    // One spike, however high, counts for no more than twice the limit; nor is the first reading a change.
    assert_eq!(noisy((0..400).map(|k| if k == 50 { 500.0 } else { 0.0 })), None);
    assert_eq!(noisy((0..400).map(|_| 500.0)), None);
    // Any sine within 30 m/s2 and 5000 m/s3 is motion.
    for frequency in [1.0_f32, 5.0, 15.0, 30.0, 60.0, 100.0] {
        let w = std::f32::consts::TAU * frequency;
        let size = 30.0_f32.min(5000.0 / w);
        assert_eq!(noisy((0..2000).map(|k| size * libm::sinf(w * 1e-3 * k as f32))), None, "{frequency} Hz");
    }
}

#[test]
fn an_lvdt_is_noisy_by_itself() {
    let noisy = |step: f32| {
        let monitor =
            NoiseMonitor::new(&PlausibilitySettings::default(), &EnvelopeSettings::default(), false, 0.001).unwrap();
        let mut state = NoiseState::default();
        // Without an accelerometer its channel may say anything.
        (0..2000)
            .find_map(|k| monitor.advance(&mut state, if k % 2 == 0 { step } else { -step }, 100.0 * (k % 3) as f32))
    };
    // 2 mm of noise are an alternating 0.79 mm.
    assert_eq!((noisy(0.82e-3), noisy(0.76e-3)), (Some(Trip::DisplacementNoisy), None));
}

#[test]
fn at_a_limit_nothing_is_said() {
    // Turns of a second: the means over 50 ms are the readings themselves, to the last bit.
    let settings = PlausibilitySettings { stuck: 0.0, disagreement: 2e-3, ..Default::default() };
    let monitor = Plausibility::new(&settings, 1.0).unwrap();
    let told = |steps: [(f32, f32, f32); 2]| {
        let mut state = PlausibilityState::default();
        steps.map(|(x, a, e)| monitor.advance(&mut state, x, a, &innovation(e)))
    };
    assert_eq!(told([(0.1, 0.0, 0.0), (0.1, 0.1, 5e-4)]), [None, None]);
    assert_eq!(told([(0.1, 0.0, 0.0), (0.1, 0.1, 5.1e-4)]), [None, Some(Trip::DisplacementStuck)]);
    assert_eq!(told([(0.1, 0.0, 0.0), (0.2, 0.1, 2e-3)]), [None, None]);
    assert_eq!(told([(0.1, 0.0, 0.0), (0.2, 0.1, 2.1e-3)]), [None, Some(Trip::SensorsDisagree)]);
    let first = |mismatch: f32, asked: f32, velocity: f32| {
        let monitor = ValveMonitor::new(&ValveMonitorSettings { mismatch, memory: 100.0 }, 0.0, 0.242, DT).unwrap();
        monitor.advance(&mut ValveMonitorState::default(), asked, 10.0, velocity, 0.0)
    };
    assert!(!first(DT, 0.0, 1.0) && first(DT, 0.0, 1.01));
    assert!(!first(2.0 * DT, 1.0, 1.0) && first(2.0 * DT, 1.01, 1.01));
}

/// Turns until a valve monitor trips, of at most 10,000; `told` gives speed asked for, limit, velocity, displacement.
fn valve(told: impl Fn(f32) -> [f32; 4]) -> Option<usize> {
    let monitor = ValveMonitor::new(&ValveMonitorSettings { mismatch: 0.02, memory: 0.2 }, 0.0, 0.242, DT).unwrap();
    let mut state = ValveMonitorState::default();
    (0..10_000).find(|&k| {
        let [asked, limit, velocity, x] = told(k as f32 * DT);
        monitor.advance(&mut state, asked, limit, velocity, x) || monitor.creep(&state) == Creep::Certain
    })
}

#[test]
fn a_valve_is_stuck_when_the_way_is_not_explained() {
    // 0.2 m/s that nobody asked for: 20 mm of a way forgotten over 0.2 s takes 0.2 ln 2 = 139 ms.
    let over = valve(|t| [0.0, 0.242, 0.2, 0.2 * t]).unwrap();
    assert!((45..=48).contains(&over), "{over}");
    assert_eq!(valve(|t| [0.0, 0.242, -0.2, -0.2 * t]), Some(over));
    // Below 0.1 m/s it takes longer: 40 mm beyond what a null of 4 mm/s makes, 0.04 / (v - 0.004).
    for (v, seconds) in [(0.099_f32, 0.421_f32), (0.03, 1.538), (0.01, 6.667), (-0.01, 6.667)] {
        let turns = valve(|t| [0.0, 0.242, v, v * t]).unwrap();
        assert!((turns as f32 * DT - seconds).abs() < 0.01, "{v} m/s after {turns} turns");
    }
    // Below 4 mm/s it may be the null.
    assert_eq!(valve(|t| [0.0, 0.242, 0.0039, 0.0039 * t]), None);
    // What is asked for explains what happens, and no more than the limit is expected.
    assert_eq!(valve(|t| [0.2, 0.242, 0.2, 0.2 * t]), None);
    assert_eq!(valve(|t| [5.0, 0.242, 0.242, 0.242 * t]), None);
    assert!(valve(|t| [5.0, 0.242, 0.1, 0.1 * t]).is_some());
}

/// Turns until an LVDT that creeps by `creep` (m/s) under a null of `null` (m/s) may be beyond the command, and how far the table may be
/// from it then, m: a loop that is closed over the LVDT holds it where it is, so the command makes the creep. The table's gain of 1 was
/// `learned` before, or not.
fn possible(creep: f32, null: f32, learned: bool) -> Option<(usize, f32)> {
    let monitor = ValveMonitor::new(&ValveMonitorSettings { mismatch: 0.02, memory: 0.2 }, 0.0, 0.242, DT).unwrap();
    let mut state = ValveMonitorState::default();
    let mut x = 0.05;
    for _ in 0..if learned { 3000 } else { 0 } {
        x += 0.1 * DT;
        monitor.advance(&mut state, 0.1, 0.242, 0.1, x);
    }
    (1..10_000).find_map(|turn| {
        monitor.advance(&mut state, null - creep, 0.242, 0.0, x);
        match monitor.creep(&state) {
            Creep::Possible { below, above } => Some((turn, below - above)),
            _ => None,
        }
    })
}

#[test]
fn a_table_is_nowhere_beyond_what_a_creep_may_be() {
    for learned in [true, false] {
        for creep in [0.012_f32, 0.015, 0.02, -0.012, -0.02] {
            for null in [-0.004_f32, -0.002, 0.0, 0.001, -0.001] {
                // 10 mm beyond a null of 4 mm/s and the command, as it is if the gain is known, at 0.65 of it if not.
                let asked = (creep - null).abs();
                let (least, hidden) = if learned { (asked, 0.0) } else { (0.65 * asked, 0.35 * asked) };
                if least < 0.005 {
                    continue;
                }
                let (turn, way) = possible(creep, null, learned).unwrap();
                let seconds = 0.01 / (least - 0.004);
                assert!((turn as f32 * DT - seconds).abs() < 0.01 * seconds + 0.02, "{creep} {null}: {turn}");
                // It has crept so far, and what it may have crept is no less, and by two nulls and the gain no more than that.
                let crept = creep * turn as f32 * DT;
                let beyond = (way - crept) * creep.signum();
                let most = (0.0081 + hidden) * turn as f32 * DT + 1e-4;
                assert!(beyond > -1e-4 && beyond < most, "{creep} {null}: {way} for {crept}");
            }
        }
    }
    // What two nulls may hide is not seen; nor, while the gain is not known, what two nulls and a gain of 0.65 may.
    assert_eq!(possible(0.0079, 0.004, true), None);
    assert_eq!(possible(0.0101, 0.004, false), None);
    assert!(possible(0.0101, 0.004, true).is_some());
}

/// What a valve monitor says of a table of `gain` that is asked for each of these speeds (m/s) for so long (s), and goes at most 0.232 m/s.
fn of_a_healthy(gain: f32, asked: &[(f32, f32)]) -> Creep {
    let monitor = ValveMonitor::new(&ValveMonitorSettings { mismatch: 0.02, memory: 0.2 }, 0.0, 0.242, DT).unwrap();
    let mut state = ValveMonitorState::default();
    let mut x = 0.0;
    for &(speed, time) in asked {
        for _ in 0..(time / DT) as usize {
            let velocity = (gain * speed).clamp(-0.232, 0.232);
            x += velocity * DT;
            monitor.advance(&mut state, speed, 0.242, velocity, x);
            if monitor.creep(&state) != Creep::None {
                return monitor.creep(&state);
            }
        }
    }
    Creep::None
}

#[test]
fn a_table_of_another_gain_does_not_creep() {
    for gain in [0.7, 0.85, 1.0, 1.3] {
        // Near the limit from the first tick: its gain is not learned there, and stays unknown.
        assert_eq!(of_a_healthy(gain, &[(0.24, 0.6), (-0.24, 0.6)]), Creep::None, "{gain}");
    }
    for gain in [1.15, 1.3] {
        // Learned, and then at a limit beyond which no gain carries it.
        assert_eq!(of_a_healthy(gain, &[(0.1, 3.0), (0.5, 0.8), (-0.5, 0.8)]), Creep::None, "{gain}");
    }
    // What no gain explains does: a table that goes the other way.
    assert!(matches!(of_a_healthy(-0.3, &[(0.1, 1.0)]), Creep::Possible { .. }));
}

#[test]
fn a_table_that_stands_while_it_is_told_to_move_is_seen() {
    // The velocity agrees, as an observer's does that believes a stuck LVDT and is not contradicted.
    let even = |speed: f32| valve(move |_| [speed, 0.242, speed, 0.03]);
    // 10 mm at 50 mm/s, forgotten over a second: ln(1 / 0.8) = 223 ms, and one turn to find where it stands.
    let turns = even(0.05).unwrap();
    assert!((73..=77).contains(&turns), "{turns}");
    assert_eq!(even(-0.05), Some(turns));
    // The same where it stands in the middle, and where it ends up after a way.
    assert_eq!(valve(|_| [0.05, 0.242, 0.05, 0.0]), Some(turns - 1));
    // At the edge of what counts as standing it stands.
    assert_eq!(valve(|_| [0.05, 0.242, 0.05, 0.05 * 0.02]), Some(turns - 1));
    let stops = valve(|t| [0.05, 0.242, 0.05, 0.05 * t.min(1.0)]).unwrap();
    assert!((333 + 60..333 + 80).contains(&stops), "{stops}");
    // Below 4 mm/s it may be the null; above, what is told over the longer time is not what is read.
    assert_eq!(even(0.0039), None);
    assert!(even(0.0085).is_some_and(|turns| turns > 2000));
    // A millimetre of motion, and it does not stand.
    assert_eq!(valve(|t| [0.05, 0.242, 0.05, 0.05 * t]), None);
}

#[test]
fn an_observer_that_coasts_finds_the_table_where_it_is() {
    let observer = MotionObserver::crossover(2.0, 0.001).unwrap();
    let mut state = MotionState::default();
    let at = |k: i32| 2e-4 * k as f32;
    for k in 0..5000 {
        observer.advance(&mut state, at(k), 0.0);
    }
    for _ in 5000..5009 {
        observer.coast(&mut state);
        assert_eq!(state.innovation, 0.0);
    }
    observer.advance(&mut state, at(5009), 0.0);
    assert!(state.innovation.abs() < 1e-5, "{}", state.innovation);
    assert!((state.velocity - 0.2).abs() < 1e-3, "{}", state.velocity);
}

#[test]
fn a_supervisor_ramps_in_as_many_ticks_as_its_time_has() {
    let ramps = Ramps::new(&RampSettings { test: 0.01, safe: 0.005 }, 0.001).unwrap();
    let mut supervisor = Supervisor::off();
    assert_eq!((supervisor.state(), supervisor.relay(), supervisor.moves()), (State::Off, Relay::Open, false));
    supervisor.request(OperatorRequest::Arm).unwrap();
    assert_eq!((supervisor.relay(), supervisor.moves()), (Relay::Closed, true));
    supervisor.request(OperatorRequest::Start).unwrap();
    let ticks = (1..100).find(|&k| {
        supervisor.advance(ramps);
        let p = (0.1 * k as f32).min(1.0);
        let smooth = p * p * (3.0 - 2.0 * p);
        assert!((supervisor.test_weight() - smooth).abs() < 1e-6, "{k}: {}", supervisor.test_weight());
        assert_eq!(supervisor.whole(), k >= 10);
        supervisor.steady()
    });
    assert_eq!(ticks, Some(10));
    // Held, it falls as it rose, and resumed it rises again once it is out.
    supervisor.request(OperatorRequest::Hold).unwrap();
    supervisor.advance(ramps);
    assert!(!supervisor.steady() && (supervisor.test_weight() - 0.972).abs() < 1e-6, "{}", supervisor.test_weight());
    supervisor.request(OperatorRequest::Resume).unwrap();
    let mut before = supervisor.test_weight();
    for k in 2..=20 {
        supervisor.advance(ramps);
        let weight = supervisor.test_weight();
        assert!(if k <= 10 { weight < before } else { weight > before }, "{k}: {weight} after {before}");
        before = weight;
    }
    assert!(supervisor.steady() && supervisor.test_weight() == 1.0);
    let changes = supervisor.changes();
    supervisor.doubt(Trip::Velocity);
    assert_eq!((supervisor.changes(), supervisor.command()), (changes.wrapping_add(1), 1.0));
    // The first cause stands.
    supervisor.trip(Trip::Jerk);
    assert_eq!(supervisor.cause(), Some(Trip::Velocity));
    assert_eq!(supervisor.request(OperatorRequest::Reset), Err(Refused::StillMoving(Trip::Velocity)));
    let left: Vec<f32> = (0..5)
        .map(|_| {
            assert_eq!(supervisor.relay(), Relay::Closed);
            supervisor.advance(ramps);
            supervisor.command()
        })
        .collect();
    for (left, expected) in left.iter().zip([0.8, 0.6, 0.4, 0.2, 0.0]) {
        assert!((left - expected).abs() < 1e-6, "{left} {expected}");
    }
    assert_eq!(supervisor.relay(), Relay::Open);
    supervisor.request(OperatorRequest::Reset).unwrap();
    assert_eq!((supervisor.state(), supervisor.cause()), (State::Off, None));
    // What monitors say of a table without oil is no reason; an order is.
    supervisor.doubt(Trip::Velocity);
    assert_eq!(supervisor.state(), State::Off);
    supervisor.request(OperatorRequest::Trip).unwrap();
    assert_eq!((supervisor.state(), supervisor.command()), (State::Tripped, 0.0));
}

/// A stop while the test fades in does not turn the fade around: the weight's slope changes no faster than that of two smooth steps.
#[test]
fn a_fade_never_turns_back() {
    let ramps = Ramps::new(&RampSettings { test: 0.1, safe: 0.005 }, 0.001).unwrap();
    for moment in 1..120 {
        let mut supervisor = Supervisor::off();
        supervisor.request(OperatorRequest::Arm).unwrap();
        supervisor.request(OperatorRequest::Start).unwrap();
        let mut weights = [0.0; 2];
        let ended = (0..500).find(|&k| {
            if k == moment {
                supervisor.request(OperatorRequest::Stop).unwrap();
            }
            supervisor.advance(ramps);
            let weight = supervisor.test_weight();
            let [before, last] = weights;
            weights = [last, weight];
            // 6 / T^2 of each step, and twice 1.5 / T by 1.5 / T, of which 3 / T was the jump of a fade turned around.
            assert!((weight - 2.0 * last + before).abs() < 1e-4 * (2.0 * 6.0 + 4.5), "{moment}, {k}");
            supervisor.state() == State::Ready
        });
        assert_eq!(ended, Some(moment + 99), "{moment}");
    }
}

/// At 5 kHz a table behind a 12-bit command steps by 0.9 mm/s within a tick, every second or third tick: its acceleration is rough and
/// its sensor is not. White noise of 8 m/s2 is seen as at 1 kHz.
#[test]
fn steps_of_a_command_are_no_noise_at_any_rate() {
    for rate in [1000.0, 2000.0, 5000.0_f32] {
        let monitor = |tick: f32| {
            NoiseMonitor::new(&PlausibilitySettings::default(), &EnvelopeSettings::default(), true, tick).unwrap()
        };
        let (monitor, ticks) = (monitor(1.0 / rate), (0.5 * rate) as u32);
        let mut state = NoiseState::default();
        let steps = (0..ticks).find_map(|k| {
            let stepped = (f32::from((k % 1000) as u16) * 0.43).fract() < 0.43;
            monitor.advance(&mut state, 0.0, if stepped { 0.9e-3 * rate } else { 0.0 })
        });
        assert_eq!(steps, None, "{rate}");
        let (mut state, mut seed) = (NoiseState::default(), 1_u32);
        let noisy = (0..ticks).find_map(|_| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Of a standard deviation of 1 / sqrt(12).
            let uniform = (seed >> 8) as f32 / 16_777_216.0 - 0.5;
            monitor.advance(&mut state, 0.0, 8.0 * 3.464_1 * uniform)
        });
        assert_eq!(noisy, Some(Trip::AccelerationNoisy), "{rate}");
    }
}

#[test]
fn no_length_of_a_ramp_costs_a_tick_to_rounding() {
    for ticks in 2..300_u16 {
        let time = 0.001 * f32::from(ticks);
        let ramps = Ramps::new(&RampSettings { test: time, safe: time }, 0.001).unwrap();
        let mut supervisor = Supervisor::off();
        supervisor.request(OperatorRequest::Arm).unwrap();
        supervisor.request(OperatorRequest::Start).unwrap();
        let count = |supervisor: &mut Supervisor, done: fn(&Supervisor) -> bool| {
            (1..1000).find(|_| {
                supervisor.advance(ramps);
                done(supervisor)
            })
        };
        assert_eq!(count(&mut supervisor, Supervisor::whole), Some(ticks));
        supervisor.request(OperatorRequest::Stop).unwrap();
        assert_eq!(count(&mut supervisor, |s| s.state() == State::Ready), Some(ticks));
        assert_eq!(supervisor.test_weight(), 0.0);
        supervisor.trip(Trip::External);
        assert_eq!(count(&mut supervisor, |s| s.relay() == Relay::Open), Some(ticks));
    }
}

#[test]
fn a_trip_of_the_valve_opens_the_relay_at_the_same_tick() {
    let mut supervisor = Supervisor::off();
    supervisor.request(OperatorRequest::Arm).unwrap();
    supervisor.trip(Trip::ValveStuck);
    assert_eq!((supervisor.relay(), supervisor.command()), (Relay::Open, 1.0));
}

#[test]
fn walls_let_through_what_is_within_and_name_what_is_not() {
    let mut settings = Settings { mode: Mode::Controller, ..Settings::default() };
    settings.ranges.reference = 0.2;
    settings.ranges.displacement = 0.3;
    settings.ranges.acceleration = 5.0;
    settings.ranges.velocity = 1.0;
    let take = |settings: &Settings, sample: &Sample| {
        let mut readings = Sample { reference: 0.01, displacement: 0.02, acceleration: 0.03, ..Sample::default() };
        let missing = InputGate::new(settings).take(sample, &mut readings);
        (missing, readings)
    };
    let edge = Sample::new(-0.2, 0.3, -5.0);
    assert_eq!(take(&settings, &edge), (Channels::NONE, edge));
    let beyond = Sample::new(0.21, -0.31, 5.1);
    let all = Channels::REFERENCE.union(Channels::DISPLACEMENT).union(Channels::ACCELERATION);
    let (missing, kept) = take(&settings, &beyond);
    assert_eq!((missing, kept.reference, kept.displacement, kept.acceleration), (all, 0.01, 0.02, 0.03));
    // Guard mode reads the other's command and no reference; what is not fitted is not read.
    let guard = Settings { mode: Mode::Guard, ..settings };
    let (missing, kept) = take(&guard, &Sample { external: 7.0, ..beyond });
    assert_eq!((missing, kept.external), (Channels::DISPLACEMENT.union(Channels::ACCELERATION), 7.0));
    settings.observer.accelerometer = false;
    settings.velocity_source = VelocitySource::Sensor;
    settings.reference_rates = ReferenceRates::Supplied;
    let odd = Sample { velocity: 1.1, reference_velocity: 0.5, reference_acceleration: f32::NAN, ..edge };
    let (missing, kept) = take(&settings, &Sample { acceleration: f32::NAN, ..odd });
    assert_eq!(missing, Channels::VELOCITY.union(Channels::REFERENCE_RATES));
    assert_eq!((kept.velocity, kept.reference_velocity), (0.0, 0.5));
    // Two readings of one channel, both lost, are one channel lost.
    let none = Sample { reference_velocity: f32::NAN, reference_acceleration: f32::NAN, velocity: 0.5, ..edge };
    assert_eq!(take(&settings, &none).0, Channels::REFERENCE_RATES);
}

#[test]
fn the_inputs_are_late_by_a_tick_and_no_more() {
    let settings =
        InputSettings { second_displacement: Some(0.002), limit_switches: true, relay_feedback: Some(0.015) };
    let monitor = InputMonitor::new(&settings, 0.012, DT).unwrap();
    let rest = Sample { relay_closed: true, ..Sample::default() };
    let first = |readings: Sample, told: Relay| {
        let mut state = InputState::default();
        (1..20).find_map(|tick| monitor.advance(&mut state, &readings, told).map(|trip| (tick, trip)))
    };
    assert_eq!(first(rest, Relay::Closed), None);
    assert_eq!(first(Sample { limit_switch: true, ..rest }, Relay::Closed), Some((1, Trip::LimitSwitch)));
    // Five ticks and four are what may be.
    assert_eq!(first(rest, Relay::Open), Some((6, Trip::RelayAstray)));
    assert_eq!(first(Sample { second_displacement: 0.002, ..rest }, Relay::Closed), None);
    let apart = Sample { second_displacement: -0.0021, ..rest };
    assert_eq!(first(apart, Relay::Closed), Some((5, Trip::SensorsDisagree)));
    // Once right, they begin anew.
    let mut state = InputState::default();
    let seen = [apart, apart, apart, apart, rest, apart].map(|s| monitor.advance(&mut state, &s, Relay::Closed));
    assert_eq!(seen, [None; 6]);
}

/// When a valve monitor trips (s, of 12) of a table whose gain by its LVDT is `before` and from 6 s on `after`, under 0.1 m/s to and fro.
fn of_a_gain(before: f32, after: f32) -> Option<f32> {
    let gain = |t: f32| if t < 6.0 { before } else { after };
    let asked = |t: f32| 0.1 * shakedown_core::blocks::math::sin(2.0 * t);
    let mut x = 0.0;
    let monitor = ValveMonitor::new(&ValveMonitorSettings { mismatch: 0.05, memory: 0.2 }, 0.0, 0.242, DT).unwrap();
    let mut state = ValveMonitorState::default();
    (0..4000).map(|k| k as f32 * DT).find(|&t| {
        let velocity = gain(t) * asked(t);
        x += velocity * DT;
        monitor.advance(&mut state, asked(t), 0.242, velocity, x)
    })
}

#[test]
fn a_gain_that_changes_by_a_quarter_is_seen_whatever_it_was() {
    for before in [0.8_f32, 1.0, 1.2] {
        assert_eq!(of_a_gain(before, before), None, "{before}");
        for share in [0.78, 1.22] {
            assert_eq!(of_a_gain(before, share * before), None, "{before} {share}");
        }
        for share in [0.5, 1.5] {
            // The mean has taken on half of the change after 2 s ln 2 of motion that counts.
            let seen = of_a_gain(before, share * before).unwrap() - 6.0;
            assert!((1.2..2.6).contains(&seen), "{before} {share}: {seen}");
        }
    }
}
