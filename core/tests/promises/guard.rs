//! The guard: each hazard of docs/hazards.md made to happen to a table in a running test, and what must not happen.

use proptest::prelude::*;
use shakedown_core::settings::{
    Detection, EnvelopeSettings, Finding, ForceSettings, Gains, GuardSettings, InnerLoop, InputSettings,
    PlausibilitySettings, RampSettings, ValveMonitorSettings, WitnessSettings,
};
use shakedown_core::{
    Command, Controller, Mode, Modification, OperatorRequest, Refused, Relay, Sample, Settings, State, Trip,
};

use crate::table::Table;

/// From the relay opening to no oil at the valve, s: the hydraulic block's own latency.
const BLOCK: f64 = 0.03;

/// A controller in charge of a table, with the relay of its hydraulic block.
struct Rig {
    controller: Controller,
    table: Table,
    mode: Mode,
    t: f64,
    opened: Option<f64>,
    farthest: f64,
    tripped: Option<(f64, Trip)>,
}

fn settings(mode: Mode) -> Settings {
    Settings {
        mode,
        displacement: Gains::new(10.0, 1.0),
        saturation: Some(Detection::default()),
        anti_windup: true,
        modification: if mode == Mode::Guard { Modification::Off } else { Modification::Causal },
        guard: Some(GuardSettings { ramps: RampSettings { test: 0.5, safe: 0.05 }, ..GuardSettings::default() }),
        ..Settings::default()
    }
}

/// A reference whose speed stays within the table's: 0.15 m/s at most.
fn swing(t: f64) -> f64 {
    0.03 * (3.0 * t).sin() + 0.006 * (10.0 * t).sin()
}

impl Rig {
    /// Armed and started, at rest.
    fn running(settings: &Settings) -> Self {
        let mut rig = Self {
            controller: Controller::new(settings).unwrap(),
            table: Table::new(f64::from(settings.rate)).noisy(),
            mode: settings.mode,
            t: 0.0,
            opened: None,
            farthest: 0.0,
            tripped: None,
        };
        for _ in 0..50 {
            rig.tick(0.0, |_| ());
        }
        rig.controller.request(OperatorRequest::Arm).unwrap();
        rig.controller.request(OperatorRequest::Start).unwrap();
        rig
    }

    /// One tick; `fault` may change what the controller is told.
    fn tick(&mut self, reference: f64, fault: impl Fn(&mut Sample)) -> Command {
        let mut sample = self.table.sample(reference);
        sample.external = (10.0 * (reference - self.table.x)) as f32;
        fault(&mut sample);
        let command = self.controller.step(&sample);
        let valve = match self.mode {
            Mode::Modifier => 10.0 * (f64::from(command.valve) - self.table.lvdt()),
            _ => f64::from(command.valve),
        };
        if command.status.relay == Relay::Closed {
            self.opened = None;
            self.table.oil = true;
        } else if self.t - *self.opened.get_or_insert(self.t) >= BLOCK {
            self.table.oil = false;
        }
        self.table.advance(valve);
        self.t += self.table.dt;
        self.farthest = self.farthest.max(self.table.x.abs());
        if let (None, Some(cause)) = (self.tripped, command.status.trip) {
            self.tripped = Some((self.t, cause));
        }
        command
    }

    /// Runs the swing for `seconds`.
    fn swing(&mut self, seconds: f64, fault: impl Fn(&mut Sample)) -> Command {
        let end = self.t + seconds;
        let mut last = Command::default();
        while self.t < end {
            last = self.tick(swing(self.t), &fault);
        }
        last
    }

    /// Three seconds of healthy swing, then `fault` for up to two: what tripped, and after how long, s.
    fn hazard(mut self, fault: impl Fn(&mut Sample)) -> (Trip, f64, Self) {
        self.swing(3.0, |_| ());
        assert_eq!(self.tripped, None, "tripped while healthy");
        let from = self.t;
        let last = self.swing(2.0, fault);
        let (at, cause) = self.tripped.expect("the hazard was not seen");
        assert_eq!((last.status.state, last.status.relay), (State::Tripped, Relay::Open));
        assert!(self.table.v.abs() < 1e-3, "still moving at {} m/s", self.table.v);
        (cause, at - from, self)
    }
}

/// However far a reference goes, what is made of it is nowhere so near to the end of the stroke, at its speed, that the guard would stop
/// the table that follows it, whatever it takes to stop that table.
#[test]
fn a_modified_reference_leaves_what_the_guard_needs_to_stop() {
    let kinds = [Modification::Causal, Modification::Preview { seconds: 0.25 }];
    let stops = [(0.05, 5.0), (0.2, 5.0), (0.02, 0.8), (0.1, 0.5)];
    for (kind, (stopping_latency, stopping_deceleration)) in kinds.into_iter().flat_map(|k| stops.map(|s| (k, s))) {
        let envelope = EnvelopeSettings { stopping_latency, stopping_deceleration, ..EnvelopeSettings::default() };
        let guard = GuardSettings { envelope, ..settings(Mode::Controller).guard.unwrap() };
        let settings = Settings { modification: kind, guard: Some(guard), ..settings(Mode::Controller) };
        for (amplitude, omega) in [(0.3, 0.4), (0.2, 1.0), (0.13, 1.5), (0.1, 2.6), (0.4, 3.0)] {
            let mut rig = Rig::running(&settings);
            let mut reached = 0.0_f32;
            while rig.t < 12.0 {
                let way = amplitude * ((omega * rig.t).sin() + 0.3 * (2.7 * omega * rig.t).cos() - 0.3);
                reached = reached.max(rig.tick(way, |_| ()).reference.abs());
            }
            assert_eq!(rig.tripped, None, "{kind:?}, {envelope:?}, {amplitude} m at {omega} rad/s");
            assert!(reached < 0.115 && (amplitude < 0.15 || reached > 0.055), "{kind:?}, {envelope:?}: {reached} m");
        }
    }
}

/// Every hazard of the sensors in every mode: the causes that may be named, and the latency that the table states, s.
fn check(mode: Mode, causes: &[Trip], latency: f64, fault: impl Fn(&mut Sample)) {
    let (cause, after, rig) = Rig::running(&settings(mode)).hazard(fault);
    assert!(causes.contains(&cause), "{mode:?}: {cause:?}");
    assert!(after <= latency, "{mode:?}: {cause:?} after {after} s");
    assert!(rig.farthest < 0.12, "{mode:?}: {} m", rig.farthest);
}

fn check_all(causes: &[Trip], latency: f64, fault: impl Fn(&mut Sample)) {
    for mode in [Mode::Guard, Mode::Modifier, Mode::Controller] {
        check(mode, causes, latency, &fault);
    }
}

#[test]
fn open_lvdt() {
    check_all(&[Trip::SensorLost], 0.013, |s| s.displacement = f32::NAN);
}

/// A reading may be missing for as long as the settings say, at every rate, and not for a tick longer.
#[test]
fn a_reading_is_lost_after_the_same_time_at_every_rate() {
    for rate in [200.0_f32, 500.0, 1000.0, 2000.0, 4000.0, 5000.0, 8000.0] {
        let guard = GuardSettings::default();
        let allowed = (guard.plausibility.lost * rate + 0.5) as usize;
        let settings = Settings { rate, guard: Some(guard), ..Settings::default() };
        let mut controller = Controller::new(&settings).unwrap();
        controller.step(&Sample::new(0.0, 0.0, 0.0));
        controller.request(OperatorRequest::Arm).unwrap();
        let mut tripped = || controller.step(&Sample::new(0.0, f32::NAN, 0.0)).status.trip.is_some();
        assert_eq!((0..100).position(|_| tripped()), Some(allowed), "{rate} Hz");
    }
}

/// A table at rest at 110 mm whose only LVDT is cut, for the device and for the loop behind it, which sees its converter's
/// rail: where it ends up, m, and how long after the trip the relay opened, s.
fn lost_lvdt_behind(mut settings: Settings, hardwired: bool) -> (f64, f64) {
    settings.guard.as_mut().unwrap().envelope.margin = 0.005;
    let mut rig = Rig::running(&settings);
    rig.table.hardwired = hardwired;
    let to = |t: f64| 0.11 * (0.25 * t).min(1.0);
    while rig.t < 6.0 {
        let reference = to(rig.t);
        rig.tick(reference, |_| ());
    }
    assert!(rig.tripped.is_none() && rig.table.x > 0.108, "{:?} {}", rig.tripped, rig.table.x);
    rig.table.heard = Some(-0.16);
    let mut opened = None;
    while rig.t < 7.0 {
        if rig.tick(0.11, |s| s.displacement = f32::NAN).status.relay == Relay::Open {
            opened = opened.or(Some(rig.t));
        }
    }
    assert_eq!(rig.tripped.map(|(_, cause)| cause), Some(Trip::SensorLost));
    (rig.farthest, opened.unwrap() - rig.tripped.unwrap().0)
}

/// No command is zero flow for a loop that subtracts an LVDT that is lost: only the relay stops the table.
#[test]
fn open_lvdt_under_a_loop_that_subtracts_it() {
    let hardwired = Settings { inner_loop: InnerLoop::Hardwired, ..settings(Mode::Controller) };
    for (settings, hardwired) in [(hardwired, true), (settings(Mode::Modifier), false)] {
        let (farthest, after) = lost_lvdt_behind(settings, hardwired);
        assert!(farthest < 0.12, "{:?}: {farthest} m", settings.mode);
        assert!(after < 1e-9, "{:?}: the relay opened {after} s after the trip", settings.mode);
    }
}

/// A reading that is missing 4 ticks in 14 is missing no 10 ms in a row, and is lost all the same; one that is missing 9 once is not.
#[test]
fn a_loose_contact_is_a_lost_sensor() {
    let tripped = |missing: usize, period: usize| {
        let mut controller = Controller::new(&settings(Mode::Controller)).unwrap();
        let (mut tick, mut first) = (0, None);
        let step = |controller: &mut Controller, there: bool| {
            controller.step(&Sample::new(0.0, if there { 0.0 } else { f32::NAN }, 0.0));
        };
        (0..100).for_each(|_| step(&mut controller, true));
        controller.request(OperatorRequest::Arm).unwrap();
        while tick < 1000 && first.is_none() {
            step(&mut controller, tick % period >= missing);
            first = controller.trip().map(|trip| (trip, tick));
            tick += 1;
        }
        first
    };
    let (trip, tick) = tripped(4, 14).unwrap();
    assert!(trip == Trip::SensorLost && tick < 100, "{trip:?} after {tick} ticks");
    assert_eq!(tripped(9, 60), None);
}

#[test]
fn open_accelerometer() {
    check_all(&[Trip::SensorLost], 0.013, |s| s.acceleration = f32::INFINITY);
}

#[test]
fn saturated_amplifier() {
    check_all(&[Trip::SensorLost], 0.013, |s| s.displacement = 10.24);
}

#[test]
fn lost_reference() {
    for mode in [Mode::Modifier, Mode::Controller] {
        check(mode, &[Trip::SensorLost], 0.013, |s| s.reference = f32::NAN);
    }
}

#[test]
fn lost_external_command() {
    check(Mode::Guard, &[Trip::SensorLost], 0.013, |s| s.external = f32::NAN);
}

#[test]
fn stuck_lvdt() {
    check_all(&[Trip::DisplacementStuck], 0.1, |s| s.displacement = 0.011);
}

#[test]
fn stuck_accelerometer() {
    check_all(&[Trip::AccelerationStuck], 0.5, |s| s.acceleration = 0.03);
}

#[test]
fn stuck_accelerometer_off_zero() {
    check_all(&[Trip::AccelerationStuck], 0.1, |s| s.acceleration = 3.0);
}

#[test]
fn accelerometer_off_by_half_a_g() {
    check_all(&[Trip::SensorsDisagree], 0.1, |s| s.acceleration += 5.0);
}

#[test]
fn reversed_accelerometer() {
    // A polarity error is there from the start: it must not get past the first second of motion.
    for mode in [Mode::Guard, Mode::Modifier, Mode::Controller] {
        let mut rig = Rig::running(&settings(mode));
        rig.swing(4.0, |s| s.acceleration = -s.acceleration);
        let (_, cause) = rig.tripped.expect("not seen");
        assert_eq!(cause, Trip::SensorsDisagree);
    }
}

#[test]
fn noisy_lvdt() {
    let flip = std::cell::Cell::new(1.0_f32);
    check_all(&[Trip::DisplacementNoisy], 0.05, |s| {
        flip.set(-flip.get());
        s.displacement += 0.01 * flip.get();
    });
}

#[test]
fn noisy_accelerometer() {
    // Turns come at every third tick: noise that alternates is seen all the same.
    let flip = std::cell::Cell::new(1.0_f32);
    check_all(&[Trip::AccelerationNoisy], 0.1, |s| {
        flip.set(-flip.get());
        s.acceleration += 8.0 * flip.get();
    });
}

/// A healthy sine of `frequency` (Hz) and `acceleration` (m/s2) behind an existing controller: what tripped, and the largest
/// acceleration of the table, m/s2.
fn healthy_sine(rate: f32, frequency: f64, acceleration: f64) -> (Option<Trip>, f64) {
    let mut rig = Rig::running(&Settings { rate, ..settings(Mode::Guard) });
    let w = std::f64::consts::TAU * frequency;
    // Through Eq. 7: (b0 + b1 s) / (a1 + s) from command to velocity.
    let command = acceleration / w * (57.65_f64.hypot(w)) / (138.0_f64.hypot(0.69 * w));
    let mut largest = 0.0_f64;
    while rig.t < 6.0 {
        let external = command * (w * rig.t).cos();
        rig.tick(0.0, |s| s.external = external as f32);
        largest = largest.max(rig.table.a.abs());
    }
    (rig.tripped.map(|(_, cause)| cause), largest)
}

#[test]
fn healthy_sines_within_the_envelope_do_not_trip() {
    for rate in [500.0, 1000.0, 4000.0] {
        for (frequency, acceleration) in [(5.0, 6.0), (10.0, 13.0), (15.0, 21.0), (20.0, 27.0), (30.0, 26.0)] {
            let (tripped, largest) = healthy_sine(rate, frequency, acceleration);
            assert_eq!(tripped, None, "{frequency} Hz, {acceleration} m/s2 at {rate} Hz");
            assert!(largest > 0.9 * acceleration, "{frequency} Hz: only {largest} of {acceleration} m/s2");
        }
    }
}

/// A valve that goes on with `command` (m) from the third second on: what tripped, after how long, and the travel, m.
fn stuck_valve(mode: Mode, command: f64) -> (Trip, f64, f64) {
    let mut rig = Rig::running(&settings(mode));
    rig.swing(3.0, |_| ());
    let (from, x) = (rig.t, rig.table.x);
    rig.table.stuck = Some(command);
    let mut travel = 0.0_f64;
    while rig.t < from + 3.0 {
        rig.tick(swing(rig.t), |_| ());
        travel = travel.max((rig.table.x - x).abs());
    }
    let (at, cause) = rig.tripped.expect("not seen");
    assert!(!rig.table.oil);
    (cause, at - from, travel)
}

#[test]
fn valve_stuck_hard_over() {
    for (mode, command) in [(Mode::Guard, 5.0), (Mode::Controller, 5.0), (Mode::Controller, -5.0)] {
        let (cause, after, travel) = stuck_valve(mode, command);
        assert_eq!(cause, Trip::ValveStuck);
        assert!(after < 0.15, "{mode:?} {command} after {after} s");
        assert!(travel < 0.05, "{travel} m");
    }
}

/// An existing command of thirty times wide open moves the table no faster than wide open does, and must not be what the valve's lag
/// then has to forget before the table slows down.
#[test]
fn a_command_far_beyond_wide_open_stops_as_soon() {
    let stopped = |command: f32| {
        let mut settings = settings(Mode::Guard);
        settings.ranges.external = 3.0;
        let mut rig = Rig::running(&settings);
        rig.swing(3.0, |_| ());
        rig.swing(1.5, |sample| sample.external = command);
        assert_eq!(rig.tripped.map(|(_, cause)| cause), Some(Trip::Displacement));
        rig.farthest
    };
    let (open, beyond) = (stopped(0.2), stopped(3.0));
    assert!(beyond < open + 0.002, "{open} m and {beyond} m");
}

/// A guard bounds what a valve gets by the valve's model, here `(0.242 + 30 / 57.65) / 24` m. What a bare valve is asked for is passed
/// on, and so is a position to an existing loop.
#[test]
fn a_guard_bounds_the_command_of_a_valve_and_no_position() {
    let most_put_out = |mode: Mode, guarded: bool| {
        let mut settings = Settings { modification: Modification::Off, ..settings(mode) };
        settings.valve.gain = 24.0;
        settings.guard = settings.guard.filter(|_| guarded);
        if let Some(guard) = &mut settings.guard {
            guard.ramps.test = 0.01;
        }
        let mut controller = Controller::new(&settings).unwrap();
        controller.step(&Sample::new(0.0, 0.0, 0.0));
        if guarded {
            controller.request(OperatorRequest::Arm).unwrap();
            controller.request(OperatorRequest::Start).unwrap();
        }
        let asked = Sample { external: 0.1, ..Sample::new(0.1, 0.0, 0.0) };
        (0..20).map(|_| controller.step(&asked).valve).fold(0.0, f32::max)
    };
    let most = (0.242 + 30.0 / 57.65) / 24.0;
    assert!((most_put_out(Mode::Guard, true) - most).abs() < 1e-6, "{}", most_put_out(Mode::Guard, true));
    assert_eq!(most_put_out(Mode::Guard, false), 0.1);
    assert_eq!(most_put_out(Mode::Modifier, true), 0.1);
}

/// A valve that sticks hard over near the end of the stroke trips the envelope first. It is not believed soon after, and the relay does
/// not wait for the end of a ramp that nothing follows.
#[test]
fn a_valve_that_is_doubted_in_the_safe_ramp_opens_the_relay() {
    let mut rig = Rig::running(&settings(Mode::Guard));
    while rig.t < 3.0 {
        let reference = 0.09 * (0.5 * rig.t).min(1.0);
        rig.tick(reference, |_| ());
    }
    rig.table.stuck = Some(5.0);
    while rig.tick(0.09, |_| ()).status.relay == Relay::Closed {}
    let (tripped, cause) = rig.tripped.unwrap();
    assert_eq!(cause, Trip::Displacement);
    assert!(rig.t - tripped < 0.03, "the relay opened {} s after the trip", rig.t - tripped);
    rig.swing(0.2, |_| ());
    assert!(rig.farthest < 0.115, "{} m", rig.farthest);
}

#[test]
fn valve_stuck_shut() {
    for mode in [Mode::Guard, Mode::Controller] {
        let (cause, after, _) = stuck_valve(mode, 0.0);
        assert_eq!(cause, Trip::ValveStuck);
        assert!(after < 0.5, "{after} s");
    }
}

/// Guard mode with a valve monitor that believes any valve.
fn without_valve_monitor() -> Settings {
    let deaf =
        |guard: GuardSettings| GuardSettings { valve: ValveMonitorSettings { mismatch: 10.0, ..guard.valve }, ..guard };
    Settings { guard: settings(Mode::Guard).guard.map(deaf), ..settings(Mode::Guard) }
}

/// A table that goes evenly at `speed` (m/s) when its LVDT sticks: what tripped, and how far it went unseen, m.
fn stuck_while_even(settings: &Settings, speed: f64) -> (Option<Trip>, f64) {
    let mut rig = Rig::running(settings);
    let end = |t: f64| 0.06 - speed * (t - 2.0).clamp(0.0, 1.0);
    while rig.t < 3.0 {
        let t = rig.t;
        rig.tick(end(t) - 0.06, |_| ());
    }
    // From here on the existing controller, or ours, is told to go on and sees no way made.
    let (x, held) = (rig.table.x, rig.table.x as f32);
    while rig.t < 8.0 && rig.tripped.is_none() {
        let reference = rig.table.x - speed / 10.0 / 2.39;
        rig.tick(reference, |s| {
            s.displacement = held;
            s.reference = held - (speed / 10.0 / 2.39) as f32;
        });
    }
    (rig.tripped.map(|(_, cause)| cause), (rig.table.x - x).abs())
}

#[test]
fn stuck_lvdt_at_an_even_speed() {
    // The accelerometer sees nothing of an even motion.
    for mode in [Mode::Guard, Mode::Controller] {
        for speed in [0.02, 0.05, 0.1] {
            let (cause, way) = stuck_while_even(&settings(mode), speed);
            let named = [Some(Trip::ValveStuck), Some(Trip::DisplacementStuck)].contains(&cause);
            assert!(named, "{mode:?} at {speed} m/s after {way} m: {cause:?}");
            assert!(way < 0.03, "{mode:?} at {speed} m/s: {way} m");
        }
    }
    assert_eq!(stuck_while_even(&without_valve_monitor(), 0.02).0, None);
}

/// An LVDT that creeps away at `speed` (m/s) from the third second of a swing on: what tripped, and how far the table went
/// from its swing, m.
fn creeping_lvdt(settings: &Settings, speed: f64) -> (Option<Trip>, f64) {
    let mut rig = Rig::running(settings);
    rig.swing(3.0, |_| ());
    while rig.t < 11.0 && rig.tripped.is_none() {
        let crept = speed * (rig.t - 3.0);
        let reference = swing(rig.t);
        rig.tick(reference, |s| {
            s.displacement += crept as f32;
            s.external -= 10.0 * crept as f32;
        });
    }
    (rig.tripped.map(|(_, cause)| cause), speed.abs() * (rig.t - 3.0))
}

/// A shared LVDT whose reading is wrong by `error(t, x)` (m): device and existing loop read the same. Returns what tripped and
/// the farthest that the table went, m, in `seconds` of a sine of `amplitude` (m) and `frequency` (Hz).
fn wrong_lvdt(
    settings: &Settings,
    (amplitude, frequency): (f64, f64),
    seconds: f64,
    error: impl Fn(f64, f64) -> f64,
) -> (Option<Trip>, f64) {
    let mut rig = Rig::running(settings);
    let end = 8.0 + seconds;
    while rig.t < end {
        let reference = amplitude * (std::f64::consts::TAU * frequency * rig.t).sin();
        let off = if rig.t < 8.0 { 0.0 } else { error(rig.t - 8.0, rig.table.x) };
        rig.table.heard = Some(rig.table.x + off);
        rig.tick(reference, |s| {
            s.displacement += off as f32;
            s.external -= 10.0 * off as f32;
        });
        assert!(rig.t > 8.0 || rig.tripped.is_none(), "{:?} while healthy", rig.tripped);
    }
    (rig.tripped.map(|(_, cause)| cause), rig.farthest)
}

/// A loop that is closed over the LVDT carries the table along, so that LVDT and reference agree.
#[test]
fn a_shared_lvdt_that_drifts_is_contradicted() {
    for mode in [Mode::Guard, Mode::Modifier, Mode::Controller] {
        for speed in [0.1, -0.15, 0.3] {
            for motion in [(0.0, 1.0), (0.03, 0.5), (0.02, 1.0)] {
                let (cause, farthest) = wrong_lvdt(&settings(mode), motion, 10.0, |t, _| speed * t);
                assert!(cause.is_some(), "{mode:?} {speed} m/s {motion:?}: {farthest} m");
                assert!(farthest < 0.1, "{mode:?} {speed} m/s {motion:?}: {farthest} m, {cause:?}");
            }
        }
    }
}

/// An LVDT whose gain sinks from 1 to 0.5 over 20 s: the table goes ever farther, the readings do not.
#[test]
fn an_lvdt_whose_gain_sinks_is_contradicted() {
    let sinking = |t: f64, x: f64| -x * (0.025 * t).min(0.5);
    for (mode, slowest) in [(Mode::Guard, 0.1), (Mode::Controller, 0.1), (Mode::Modifier, 0.3)] {
        for frequency in [0.1, 0.3, 0.5, 1.0] {
            if frequency < slowest {
                continue;
            }
            for amplitude in [0.05, 0.067, 0.08] {
                let amplitude = f64::min(amplitude, 0.2 / (std::f64::consts::TAU * frequency));
                let (cause, farthest) = wrong_lvdt(&settings(mode), (amplitude, frequency), 25.0, sinking);
                println!("{mode:?} {amplitude} {frequency} Hz: {farthest} m, {cause:?}");
                assert!(cause.is_some(), "{mode:?} {frequency} Hz: {farthest} m");
                assert!(farthest < 0.115, "{mode:?} {frequency} Hz: {farthest} m, {cause:?}");
            }
        }
    }
}

#[test]
fn creeping_lvdt_in_a_closed_loop() {
    // The loop carries the table along, so that LVDT, accelerometer and reference agree: the valve is what knows.
    for mode in [Mode::Guard, Mode::Controller] {
        for speed in [0.02, -0.03, 0.1] {
            let (cause, way) = creeping_lvdt(&settings(mode), speed);
            let named = [Some(Trip::ValveStuck), Some(Trip::SensorsDisagree)].contains(&cause);
            assert!(named, "{mode:?} at {speed} m/s after {way} m: {cause:?}");
            assert!(way < 0.07, "{mode:?} at {speed} m/s: {way} m");
        }
        assert_eq!(creeping_lvdt(&settings(mode), 0.005).0, None);
    }
    assert_eq!(creeping_lvdt(&without_valve_monitor(), 0.02).0, None);
}

/// A table that swings 70 mm either way on an LVDT that creeps: by the time that the creep is certain it would be out. It trips
/// where the envelope would not let the table be if the command is right and the LVDT is not.
#[test]
fn a_creep_that_is_only_possible_trips_where_it_would_matter() {
    for mode in [Mode::Guard, Mode::Controller] {
        for speed in [0.02, -0.02, 0.025, -0.03, 0.03, 0.06] {
            let mut rig = Rig::running(&settings(mode));
            let mut from = None;
            while rig.t < 16.0 && rig.tripped.is_none_or(|(at, _)| rig.t < at + 0.3) {
                let swing = 0.07 * (0.9 * rig.t).sin();
                let since = rig.t - 4.0;
                rig.tick(swing, |s| {
                    if since > 0.0 {
                        s.displacement += (speed * since) as f32;
                        s.external = (10.0 * (swing - f64::from(s.displacement))) as f32;
                    }
                });
                from = from.or((since > 0.0).then_some(rig.tripped));
            }
            assert_eq!(from, Some(None), "tripped while healthy");
            assert!(rig.tripped.is_some() && rig.farthest < 0.12, "{mode:?} at {speed} m/s: {} m", rig.farthest);
        }
    }
}

/// How far an LVDT that creeps at `speed` (m/s) has crept when it trips a table that swings 30 mm about `hold` (m) in a loop over it, and
/// how far that table went, m.
fn crept_at(mode: Mode, hold: f64, speed: f64) -> (f64, f64) {
    let mut rig = Rig::running(&settings(mode));
    while rig.t < 12.0 && rig.tripped.is_none() {
        let reached = hold * (1.0 - (std::f64::consts::PI * ((rig.t - 3.0) / 3.0).clamp(0.0, 1.0)).cos()) / 2.0;
        let reference = reached + 0.03 * (3.0 * rig.t).sin();
        let crept = speed * (rig.t - 7.0).max(0.0);
        rig.tick(reference, |s| {
            s.displacement += crept as f32;
            s.external = (10.0 * (reference - f64::from(s.displacement))) as f32;
        });
        assert!(rig.t > 7.0 || rig.tripped.is_none(), "{:?} while healthy", rig.tripped);
    }
    assert_eq!(rig.tripped.map(|(_, cause)| cause), Some(Trip::ValveStuck), "{mode:?} {hold} m {speed} m/s");
    ((speed * (rig.t - 7.0)).abs(), rig.farthest)
}

/// A creep that is only possible trips where it carries the table toward the near end of its stroke, and not where it carries it away.
#[test]
fn a_possible_creep_is_judged_on_the_side_that_it_is_on() {
    for mode in [Mode::Guard, Mode::Controller] {
        for (hold, speed) in [(0.055, 0.03), (0.055, -0.03), (-0.055, 0.03), (-0.055, -0.03)] {
            let (crept, farthest) = crept_at(mode, hold, speed);
            // One that reads too low is carried up.
            let toward = (hold < 0.0) == (speed > 0.0);
            let right = if toward { farthest < 0.115 } else { farthest < 0.09 && crept > 0.055 };
            assert!(right, "{mode:?} {hold} {speed}: {crept} {farthest}");
        }
    }
}

/// A swing of which `length` ticks from the fourth second on lack `fault`'s reading: how far the modified reference strays, m.
fn strays(mode: Mode, length: u32, fault: impl Fn(&mut Sample)) -> f64 {
    let (mut whole, mut gapped) = (Rig::running(&settings(mode)), Rig::running(&settings(mode)));
    let mut strayed = 0.0_f64;
    for k in 0..8000 {
        let reference = swing(whole.t);
        let a = whole.tick(reference, |_| ());
        let b = gapped.tick(reference, |s| {
            if (4000..4000 + length).contains(&k) {
                fault(s);
            }
        });
        strayed = strayed.max(f64::from(a.reference - b.reference).abs());
    }
    assert_eq!((whole.tripped, gapped.tripped), (None, None));
    strayed
}

#[test]
fn a_gap_strays_no_farther_than_its_own_way() {
    for mode in [Mode::Modifier, Mode::Controller] {
        for length in [1, 3, 9] {
            // At 0.15 m/s at most, and a washout that may overshoot by half.
            let most = 0.15e-3 * f64::from(length) * 1.5 + 1e-4;
            let lost = [
                strays(mode, length, |s| s.reference = f32::NAN),
                strays(mode, length, |s| s.displacement = f32::NAN),
                strays(mode, length, |s| s.acceleration = f32::NAN),
            ];
            assert!(lost.iter().all(|&way| way < most), "{mode:?} {length}: {lost:?} of {most}");
        }
    }
}

#[test]
fn a_valve_trip_opens_the_relay_at_once() {
    let mut rig = Rig::running(&settings(Mode::Controller));
    rig.swing(3.0, |_| ());
    rig.table.stuck = Some(5.0);
    loop {
        let command = rig.tick(swing(rig.t), |_| ());
        if command.status.trip == Some(Trip::ValveStuck) {
            assert_eq!(command.status.relay, Relay::Open);
            break;
        }
        assert!(rig.t < 5.0 && command.status.trip.is_none(), "{command:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Another controller's command, or a bare reference, that would take the table through its stops.
    #[test]
    fn the_table_stops_inside_its_stroke(
        amplitude in 0.1..1.0f64, frequency in 0.05..3.0f64, start in -0.08..0.08f64, leap: bool, guard: bool,
    ) {
        let mode = if guard { Mode::Guard } else { Mode::Controller };
        let mut rig = Rig::running(&Settings { modification: Modification::Off, ..settings(mode) });
        for _ in 0..3000 {
            rig.tick(start, |_| ());
        }
        let from = rig.t;
        while rig.t < from + 4.0 && rig.tripped.is_none() {
            let s = (std::f64::consts::TAU * frequency * (rig.t - from)).sin();
            rig.tick(start + amplitude * if leap { s.signum() } else { s }, |_| ());
        }
        for _ in 0..500 {
            rig.tick(start, |_| ());
        }
        prop_assert!(rig.farthest <= 0.12, "{} m, {:?}", rig.farthest, rig.tripped);
    }

    /// A healthy table is let alone.
    #[test]
    fn no_trip_without_a_reason(
        amplitude in 0.0..0.08f64, frequency in 0.1..4.0f64, mode in 0..3_usize, kp in 3.0..10.0f32,
    ) {
        let mode = [Mode::Guard, Mode::Modifier, Mode::Controller][mode];
        let amplitude = amplitude.min(0.4 / (std::f64::consts::TAU * frequency));
        let mut rig = Rig::running(&Settings { displacement: Gains::new(kp, 0.5), ..settings(mode) });
        for _ in 0..6000 {
            let w = std::f64::consts::TAU * frequency;
            rig.tick(amplitude * (w * rig.t).sin(), |_| ());
        }
        prop_assert_eq!(rig.tripped, None);
    }

    /// No way round a trip but a reset, no way to move but arming and starting, no oil in Off.
    #[test]
    fn the_state_machine_has_no_other_ways(acts in proptest::collection::vec((0..9_u8, 1..400_u16), 1..60)) {
        let mut controller = Controller::new(&settings(Mode::Controller)).unwrap();
        let mut state = State::Off;
        let quiet = Sample::default();
        controller.step(&quiet);
        for (act, ticks) in acts {
            let requests = [
                OperatorRequest::Arm, OperatorRequest::Start, OperatorRequest::Hold, OperatorRequest::Resume, OperatorRequest::Stop, OperatorRequest::Off,
                OperatorRequest::Reset, OperatorRequest::Trip,
            ];
            if let Some(&request) = requests.get(usize::from(act)) {
                let answer = controller.request(request);
                let after = controller.step(&quiet).status.state;
                let allowed = match (state, request) {
                    (_, OperatorRequest::Trip) => State::Tripped,
                    (State::Off, OperatorRequest::Arm) => State::Ready,
                    (State::Ready, OperatorRequest::Start) | (State::Hold, OperatorRequest::Resume) => State::Running,
                    (State::Running, OperatorRequest::Hold) => State::Hold,
                    (State::Running | State::Hold, OperatorRequest::Stop) => State::RampDown,
                    (State::Ready, OperatorRequest::Off) => State::Off,
                    (State::Tripped, OperatorRequest::Reset) if answer.is_ok() => State::Off,
                    _ => {
                        prop_assert!(answer.is_err());
                        state
                    }
                };
                let landed = (state, after) == (State::RampDown, State::Ready)
                    || (allowed, after) == (State::RampDown, State::Ready);
                prop_assert!(after == allowed || landed, "{state:?} {request:?} {after:?}");
                state = after;
            }
            for _ in 0..ticks {
                let command = controller.step(&quiet);
                let now = command.status.state;
                prop_assert!(now == state || (state, now) == (State::RampDown, State::Ready));
                prop_assert_eq!(now == State::Tripped, command.status.trip.is_some());
                if now == State::Off {
                    prop_assert_eq!((command.status.relay, command.valve), (Relay::Open, 0.0));
                }
                state = now;
            }
        }
    }

    /// Start, hold, resume, stop at any moment: the reference given on never leaps, and ends at a stand.
    #[test]
    fn every_change_of_state_is_smooth(moments in proptest::array::uniform3(50..1500_u32), frequency in 0.2..2.0f64) {
        let guard = settings(Mode::Controller).guard.map(|guard| GuardSettings {
            valve: ValveMonitorSettings { mismatch: 10.0, ..guard.valve },
            ..guard
        });
        let settings = Settings { modification: Modification::Off, guard, ..settings(Mode::Controller) };
        let mut controller = Controller::new(&settings).unwrap();
        let [hold, resume, stop] = moments;
        let (mut last, mut before, mut fastest, mut sharpest) = (0.0_f32, 0.0_f32, 0.0_f32, 0.0_f32);
        for k in 0..hold + resume + stop + 1200 {
            let t = f64::from(k) * 1e-3;
            let reference = 0.05 * (1.0 + (std::f64::consts::TAU * frequency * t).sin());
            let command = controller.step(&Sample::new(reference as f32, 0.0, 0.0));
            if k > 1 {
                fastest = fastest.max((command.reference - last).abs());
            }
            // From three ticks of the armed table on.
            if k > 3 {
                sharpest = sharpest.max((command.reference - 2.0 * last + before).abs());
            }
            (before, last) = (last, command.reference);
            let request = match k {
                0 => Some(OperatorRequest::Arm),
                1 => Some(OperatorRequest::Start),
                k if k == hold => Some(OperatorRequest::Hold),
                k if k == hold + resume => Some(OperatorRequest::Resume),
                k if k == hold + resume + stop => Some(OperatorRequest::Stop),
                _ => None,
            };
            if let Some(request) = request {
                let answer = controller.request(request);
                prop_assert_eq!(answer, Ok(()));
            }
        }
        // The reference's own speed, and 0.1 m faded over 0.5 s at 1.5 times the mean rate.
        let bound = 0.05 * std::f64::consts::TAU * frequency + 1.5 * 0.1 / 0.5;
        prop_assert!(f64::from(fastest) < 1e-3 * bound * 1.05 + 1e-5, "{fastest}");
        // Its own acceleration, twice its speed at the fade's, and 0.1 m of two fades at once: 6 / T^2 each and 1.5 / T by 1.5 / T.
        let w = std::f64::consts::TAU * frequency;
        let bound = 0.05 * w * w + 2.0 * 0.05 * w * 3.0 + 0.1 * (2.0 * 24.0 + 2.0 * 9.0);
        prop_assert!(f64::from(sharpest) < 1e-6 * bound * 1.05 + 1e-7, "{sharpest}");
    }
}

/// The usual settings with another envelope.
fn with(envelope: EnvelopeSettings) -> Settings {
    let guard = settings(Mode::Controller).guard.map(|guard| GuardSettings { envelope, ..guard });
    Settings { guard, ..settings(Mode::Controller) }
}

#[test]
fn the_envelope_judges_what_lasts() {
    let envelope = EnvelopeSettings {
        acceleration: 2.0,
        jerk: 1e6,
        force: Some(ForceSettings { limit: 1000.0, piston_area: 0.024 }),
        tracking: 0.01,
        ..EnvelopeSettings::default()
    };
    let rig = || Rig::running(&with(envelope));
    let mut fast = rig();
    fast.swing(3.0, |s| s.pressure_difference = 1e5);
    assert!(fast.tripped.is_some_and(|(_, cause)| cause == Trip::Force), "{:?}", fast.tripped);
    let mut far = rig();
    far.controller.retune(&Settings { displacement: Gains::new(2.0, 0.0), ..with(envelope) }).unwrap();
    far.swing(4.0, |_| ());
    assert!(far.tripped.is_some_and(|(_, cause)| cause == Trip::Tracking), "{:?}", far.tripped);
}

/// Behind an existing controller the reference is not ours to know: how far the table is from it is not judged, whether the
/// guard goes its short way or, detecting nothing, the way of all others.
#[test]
fn in_guard_mode_no_distance_from_a_reference_trips() {
    for saturation in [None, Some(Detection::default())] {
        let mut settings = Settings { saturation, ..settings(Mode::Guard) };
        settings.guard.as_mut().unwrap().envelope.tracking = 1e-4;
        let mut rig = Rig::running(&settings);
        rig.swing(3.0, |_| ());
        assert!(rig.farthest > 0.02 && rig.tripped.is_none(), "{:?}", rig.tripped);
    }
}

/// Without an accelerometer the valve command, through the model, is the second witness, and the LVDT's noise is judged by
/// itself.
#[test]
fn without_an_accelerometer_the_command_contradicts_the_lvdt() {
    for mode in [Mode::Guard, Mode::Controller] {
        let mut settings = settings(mode);
        settings.observer.accelerometer = false;
        let findings: Vec<_> = settings.findings().collect();
        assert!(findings.contains(&Finding::NoAccelerometer), "{findings:?}");
        let motion = (0.03, 0.5);
        let (drift, farthest) = wrong_lvdt(&settings, motion, 10.0, |t, _| 0.15 * t);
        assert!(drift.is_some() && farthest < 0.1, "{mode:?}: {drift:?} {farthest} m");
        let (sinking, farthest) = wrong_lvdt(&settings, (0.067, 0.2), 25.0, |t, x| -x * (0.025 * t).min(0.5));
        assert!(sinking.is_some() && farthest < 0.115, "{mode:?}: {sinking:?} {farthest} m");
        let flip = std::cell::Cell::new(1.0);
        let (noisy, farthest) = wrong_lvdt(&settings, motion, 3.0, |_, _| 0.01 * flip.replace(-flip.get()));
        assert!(noisy == Some(Trip::DisplacementNoisy) && farthest < 0.1, "{mode:?}: {noisy:?} {farthest} m");
        assert_eq!(wrong_lvdt(&settings, motion, 10.0, |_, _| 0.0).0, None);
    }
}

/// The inputs beside the sensors, where they are fitted.
fn with_inputs(inputs: InputSettings) -> Rig {
    let guard = settings(Mode::Controller).guard.map(|guard| GuardSettings { inputs, ..guard });
    Rig::running(&Settings { guard, ..settings(Mode::Controller) })
}

#[test]
fn limit_switches_and_a_second_sensor_trip() {
    let mut rig = with_inputs(InputSettings { limit_switches: true, ..InputSettings::default() });
    rig.swing(3.0, |_| ());
    assert_eq!(rig.tick(0.0, |s| s.limit_switch = true).status.trip, Some(Trip::LimitSwitch));
    let mut rig = with_inputs(InputSettings { second_displacement: Some(0.005), ..InputSettings::default() });
    rig.swing(3.0, |s| s.second_displacement = s.displacement + 0.004);
    assert_eq!(rig.tripped, None);
    // A drift too slow for anything else.
    let from = rig.t;
    while rig.tripped.is_none() && rig.t < from + 5.0 {
        let crept = 0.005 * (rig.t - from);
        let reference = swing(rig.t);
        rig.tick(reference, |s| {
            s.second_displacement = s.displacement;
            s.displacement += crept as f32;
        });
    }
    assert_eq!(rig.tripped.map(|(_, cause)| cause), Some(Trip::SensorsDisagree));
    assert!(rig.t - from < 1.1, "{}", rig.t - from);
}

#[test]
fn a_relay_that_does_not_follow_is_seen() {
    let feedback = InputSettings { relay_feedback: Some(0.05), ..InputSettings::default() };
    let guard = settings(Mode::Controller).guard.map(|guard| GuardSettings { inputs: feedback, ..guard });
    let mut controller = Controller::new(&Settings { guard, ..settings(Mode::Controller) }).unwrap();
    let step = |controller: &mut Controller, closed| {
        let mut last = Command::default();
        (0..100).for_each(|_| last = controller.step(&Sample { relay_closed: closed, ..Sample::default() }));
        last.status
    };
    // Welded: it reads closed with the coil off.
    step(&mut controller, true);
    assert_eq!(controller.request(OperatorRequest::Arm), Err(Refused::Cause(Trip::RelayAstray)));
    step(&mut controller, false);
    controller.request(OperatorRequest::Arm).unwrap();
    assert_eq!(step(&mut controller, false).trip, Some(Trip::RelayAstray));
}

/// A sensor that is not fitted is at zero for ever, and is not stuck.
#[test]
fn without_an_accelerometer_none_is_missed() {
    let mut settings = without_valve_monitor();
    settings.observer.accelerometer = false;
    let mut rig = Rig::running(&settings);
    rig.swing(5.0, |sample| sample.acceleration = f32::NAN);
    assert_eq!(rig.tripped, None);
    assert!(rig.farthest > 0.02, "{}", rig.farthest);
}

#[test]
fn acceleration_and_jerk_have_their_limits() {
    for (acceleration, jerk, cause) in [(0.8, 1e6, Trip::Acceleration), (30.0, 60.0, Trip::Jerk)] {
        let envelope = EnvelopeSettings { acceleration, jerk, persistence: 0.004, ..EnvelopeSettings::default() };
        let mut rig = Rig::running(&Settings { modification: Modification::Off, ..with(envelope) });
        for k in 0..3000 {
            rig.tick(if k > 1500 { 0.05 } else { 0.0 }, |_| ());
        }
        assert!(rig.tripped.is_some_and(|(_, seen)| seen == cause), "{cause:?}: {:?}", rig.tripped);
    }
}

#[test]
fn too_fast_is_too_fast_at_once() {
    let envelope = EnvelopeSettings { velocity: 0.1, ..EnvelopeSettings::default() };
    let mut rig = Rig::running(&with(envelope));
    rig.swing(3.0, |_| ());
    assert!(rig.tripped.is_some_and(|(_, cause)| cause == Trip::Velocity));
}

#[test]
fn the_safe_ramp_ends_at_zero_flow_within_its_time() {
    let mut rig = Rig::running(&settings(Mode::Controller));
    rig.swing(3.0, |_| ());
    rig.controller.request(OperatorRequest::Trip).unwrap();
    let mut ticks = 0;
    loop {
        let command = rig.tick(0.1, |_| ());
        ticks += 1;
        assert_eq!(command.status.trip, Some(Trip::External));
        assert!(command.valve.abs() <= 0.242 / 2.39 * 1.01);
        if command.status.relay == Relay::Open {
            assert_eq!(command.valve, 0.0);
            break;
        }
    }
    assert_eq!(ticks, 50);
    assert!(matches!(rig.controller.request(OperatorRequest::Arm), Err(Refused::State(State::Tripped))));
}

#[test]
fn a_reset_waits_for_the_ramp_and_arming_for_the_cause() {
    let mut controller = Controller::new(&settings(Mode::Controller)).unwrap();
    let good = Sample::new(0.0, 0.0, 0.0);
    assert_eq!(controller.request(OperatorRequest::Arm), Err(Refused::Cause(Trip::SensorLost)));
    controller.step(&good);
    controller.request(OperatorRequest::Arm).unwrap();
    controller.request(OperatorRequest::Trip).unwrap();
    assert_eq!(controller.request(OperatorRequest::Reset), Err(Refused::StillMoving(Trip::External)));
    for _ in 0..60 {
        controller.step(&Sample { displacement: f32::NAN, ..good });
    }
    controller.request(OperatorRequest::Reset).unwrap();
    assert_eq!(controller.request(OperatorRequest::Arm), Err(Refused::Cause(Trip::SensorLost)));
    controller.step(&good);
    assert_eq!(controller.request(OperatorRequest::Arm), Ok(()));
}

/// What a test asked for when it tripped is no longer asked for: the table that stands where it stopped, away from its
/// reference, is armed again.
#[test]
fn a_table_that_tripped_in_motion_can_be_armed_again() {
    for mode in [Mode::Guard, Mode::Modifier, Mode::Controller] {
        let mut settings = settings(mode);
        // The swing is followed within 25 mm, or the test would not get as far.
        settings.guard.as_mut().unwrap().envelope.tracking = 0.025;
        let mut rig = Rig::running(&settings);
        rig.swing(3.4, |_| ());
        assert!(rig.tripped.is_none() && rig.table.v.abs() > 0.05);
        rig.controller.request(OperatorRequest::Trip).unwrap();
        for _ in 0..1000 {
            rig.tick(0.05, |_| ());
        }
        assert!((rig.table.x - 0.05).abs() > 0.025, "the reference is where the table stands");
        rig.controller.request(OperatorRequest::Reset).unwrap();
        assert_eq!(rig.controller.request(OperatorRequest::Arm), Ok(()), "{mode:?}");
        for _ in 0..1000 {
            let held = rig.tick(0.05, |_| ());
            assert_eq!((held.status.state, held.status.trip), (State::Ready, None), "{mode:?}");
        }
    }
}

/// A monitor has its turn at every third tick; what it found stands in between.
#[test]
fn a_cause_refuses_arming_at_every_tick() {
    let mut rig = Rig::running(&settings(Mode::Guard));
    let off = |sample: &mut Sample| sample.acceleration += 5.0;
    assert_eq!(rig.swing(3.0, off).status.state, State::Tripped);
    rig.controller.request(OperatorRequest::Reset).unwrap();
    for _ in 0..12 {
        rig.tick(0.0, off);
        assert!(matches!(rig.controller.request(OperatorRequest::Arm), Err(Refused::Cause(_))));
    }
    // And no longer than it stands.
    for _ in 0..3000 {
        rig.tick(0.0, |_| ());
    }
    assert_eq!(rig.controller.request(OperatorRequest::Arm), Ok(()));
}

/// The hazards again with monitors deaf: each must then go unseen, or the tests above show nothing.
#[test]
fn deaf_monitors_would_be_seen() {
    let plausibility =
        PlausibilitySettings { lost: 1.0, stuck: 10.0, disagreement: 1.0, offset: 1000.0, acceleration_noise: 1e4 };
    let deaf = |mode| {
        let guard = settings(mode).guard.unwrap();
        let valve = ValveMonitorSettings { mismatch: 10.0, ..guard.valve };
        let witness = WitnessSettings { bias: 100.0, ..guard.witness };
        let envelope =
            EnvelopeSettings { margin: 0.0, stopping_latency: 0.0, stopping_deceleration: 1000.0, ..guard.envelope };
        Settings { guard: Some(GuardSettings { plausibility, valve, witness, envelope, ..guard }), ..settings(mode) }
    };
    let unseen = |fault: fn(&mut Sample)| {
        let mut rig = Rig::running(&deaf(Mode::Guard));
        rig.swing(3.0, |_| ());
        rig.swing(0.3, fault);
        rig.tripped.is_none()
    };
    assert!(unseen(|s| s.displacement = f32::NAN));
    assert!(unseen(|s| s.acceleration = 0.03));
    assert!(unseen(|s| s.acceleration += 2.0));
    // And without a stopping distance the table runs into its stops.
    let mut rig = Rig::running(&deaf(Mode::Guard));
    for _ in 0..3000 {
        rig.tick(0.5, |_| ());
    }
    assert!(rig.farthest > 0.12, "{}", rig.farthest);
}

/// The hazard table names tests that exist. It lies outside the package, and may be absent from a packaged copy.
#[test]
fn the_hazard_table_names_real_tests() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let Ok(table) = std::fs::read_to_string(root.join("../docs/hazards.md")) else {
        eprintln!("skipped: no docs/hazards.md beside the package");
        return;
    };
    let here = std::fs::read_dir(root.join("tests/promises")).unwrap().map(|entry| entry.unwrap().path());
    let here: Vec<_> = here.collect();
    let explored = root.join("tests/state_machine.rs");
    let parts = root.join("tests/guard_parts.rs");
    let of_the_image =
        ["faults.rs", "device.rs", "shorts.rs"].map(|file| root.join("../tests/replay/tests").join(file));
    let live = root.join("../tests/tests/live.rs");
    let of_the_firmware = ["control_loop/stream/tests.rs", "link_server/tests.rs"];
    let of_the_firmware = of_the_firmware.map(|file| root.join("../firmware/src").join(file));
    let sources: String = here
        .iter()
        .chain([&explored, &parts, &live])
        .chain(of_the_image.iter().chain(&of_the_firmware))
        .map(|file| std::fs::read_to_string(file).unwrap())
        .collect();
    let mut named = 0;
    for row in table.lines().filter(|line| line.starts_with("| ") && line.contains('`')) {
        let cell = row.trim_end_matches([' ', '|']).rsplit('|').next().unwrap_or("");
        for test in cell.split('`').skip(1).step_by(2) {
            assert!(sources.contains(&format!("fn {test}(")), "no test {test}");
            named += 1;
        }
    }
    assert!(named > 25, "{named}");
}
