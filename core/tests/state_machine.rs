//! The state machine and arming, explored exhaustively: every request, every cause of a trip and every tick, in every order.
//!
//! The first test walks through all states that [`Supervisor`] has under given ramps, and holds each step to what the hazard
//! table says of it. Its state is finite: three weights that move by fixed steps, and four discrete fields. The second runs the
//! whole [`Controller`] through every sequence of a bounded length. `--nocapture` prints how many there were.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test that says how far it went")]

use std::collections::{HashMap, HashSet, VecDeque};

use shakedown_core::blocks::guard::{Ramps, Supervisor};
use shakedown_core::settings::{GuardSettings, RampSettings};
use shakedown_core::{Controller, OperatorRequest, Refused, Relay, Sample, Settings, State, Trip, Tuning};

const REQUESTS: [OperatorRequest; 8] = [
    OperatorRequest::Arm,
    OperatorRequest::Start,
    OperatorRequest::Hold,
    OperatorRequest::Resume,
    OperatorRequest::Stop,
    OperatorRequest::Off,
    OperatorRequest::Reset,
    OperatorRequest::Trip,
];

const CAUSES: [Trip; 17] = [
    Trip::Displacement,
    Trip::Velocity,
    Trip::Acceleration,
    Trip::Jerk,
    Trip::Force,
    Trip::Tracking,
    Trip::SensorLost,
    Trip::DisplacementStuck,
    Trip::AccelerationStuck,
    Trip::SensorsDisagree,
    Trip::DisplacementNoisy,
    Trip::AccelerationNoisy,
    Trip::ValveStuck,
    Trip::Internal,
    Trip::External,
    Trip::LimitSwitch,
    Trip::RelayAstray,
];

/// Everything that can happen to the state machine.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Act {
    Request(OperatorRequest),
    /// A monitor's finding, which counts only where something moves.
    Doubt(Trip),
    /// The law's own failure, which counts anywhere.
    Trip(Trip),
    OpenAtOnce,
    Tick,
}

fn acts() -> Vec<Act> {
    let causes = CAUSES.into_iter().flat_map(|cause| [Act::Doubt(cause), Act::Trip(cause)]);
    REQUESTS.into_iter().map(Act::Request).chain(causes).chain([Act::OpenAtOnce, Act::Tick]).collect()
}

/// What tells two states apart: all but the count of changes, which is modulo 256 and decides nothing.
type Key = (u8, Option<u8>, [u32; 3], bool, bool);

fn key(s: &Supervisor) -> Key {
    let closed = s.relay() == Relay::Closed;
    (
        s.state() as u8,
        s.cause().map(|cause| cause as u8),
        [s.fades().0.to_bits(), s.fades().1.to_bits(), s.command().to_bits()],
        closed,
        s.whole(),
    )
}

fn act(supervisor: &mut Supervisor, act: Act, ramps: Ramps) -> Result<(), Refused> {
    match act {
        Act::Request(request) => return supervisor.request(request),
        Act::Doubt(cause) => supervisor.doubt(cause),
        Act::Trip(cause) => supervisor.trip(cause),
        Act::OpenAtOnce => supervisor.open_relay_at_once(),
        Act::Tick => supervisor.advance(ramps),
    }
    Ok(())
}

/// The arrows of the diagram; `ticks` is the arrow that a tick follows.
fn arrow(from: State, request: Option<OperatorRequest>) -> &'static [State] {
    use State::{Hold, Off, RampDown, Ready, Running, Tripped};
    match (from, request) {
        (Off, Some(OperatorRequest::Arm)) | (RampDown, None) => &[Ready],
        (Ready, Some(OperatorRequest::Start)) | (Hold, Some(OperatorRequest::Resume)) => &[Running],
        (Running, Some(OperatorRequest::Hold)) => &[Hold],
        (Running | Hold, Some(OperatorRequest::Stop)) => &[RampDown],
        (Ready, Some(OperatorRequest::Off)) | (Tripped, Some(OperatorRequest::Reset)) => &[Off],
        (_, Some(OperatorRequest::Trip)) => &[Tripped],
        _ => &[],
    }
}

/// What holds of any state by itself.
fn holds_of_a_state(s: &Supervisor) {
    let (state, test_weight, command) = (s.state(), s.test_weight(), s.command());
    assert!((0.0..=1.0).contains(&test_weight) && (0.0..=1.0).contains(&command), "{s:?}");
    assert_eq!(s.cause().is_some(), state == State::Tripped, "a cause, and no trip, or none, and a trip: {s:?}");
    assert_eq!(s.moves(), !matches!(state, State::Off | State::Tripped), "{s:?}");
    assert_eq!(s.steady(), state == State::Running && s.whole(), "{s:?}");
    let closed = s.relay() == Relay::Closed;
    match state {
        State::Off => assert!(!closed, "off, and oil: {s:?}"),
        // Open at the end of the ramp at the latest; before only where no command is known to stop the table.
        State::Tripped => assert!(!(closed && command <= 0.0), "the ramp is over, and oil: {s:?}"),
        _ => assert!(closed && command <= 0.0, "moves without oil, or with a rest of an old command: {s:?}"),
    }
}

/// What holds of a step from `before` to `after` by `by`.
fn holds_of_a_step(before: &Supervisor, after: &Supervisor, by: Act, answer: Result<(), Refused>) {
    let said = || format!("{by:?}: {before:?} -> {after:?}");
    let (from, to) = (before.state(), after.state());
    // Only along the diagram's arrows.
    let request = if let Act::Request(request) = by { Some(request) } else { None };
    let tripped = to == State::Tripped && matches!(by, Act::Doubt(_) | Act::Trip(_));
    assert!(from == to || tripped || arrow(from, request).contains(&to), "{}", said());
    // What is refused changes nothing, and what is not refused does what it says.
    if answer.is_err() {
        assert_eq!(key(before), key(after), "{}", said());
    } else if let Some(request) = request {
        assert!(arrow(from, Some(request)).contains(&to), "{}", said());
    }
    // Oil comes by arming and by nothing else.
    if before.relay() == Relay::Open && after.relay() == Relay::Closed {
        assert_eq!((from, by, to), (State::Off, Act::Request(OperatorRequest::Arm), State::Ready), "{}", said());
    }
    // The first cause stands, and a trip is left by a reset alone, and not before the end of the ramp.
    if from == State::Tripped {
        assert!(to == State::Off || after.cause() == before.cause(), "{}", said());
        assert!(after.command() <= before.command(), "the safe ramp rises: {}", said());
        if to != State::Tripped {
            assert_eq!((by, to), (Act::Request(OperatorRequest::Reset), State::Off), "{}", said());
            assert!(before.command() <= 0.0, "{}", said());
        }
        if by == Act::Tick && before.command() > 0.0 {
            assert!(after.command() < before.command(), "the safe ramp stands: {}", said());
        }
    }
    // A table that moves trips on every cause, at once; one without oil on none that a monitor has.
    match by {
        Act::Doubt(cause) | Act::Trip(cause) if before.moves() => {
            assert_eq!((to, after.cause()), (State::Tripped, Some(cause)), "{}", said());
            let open = after.relay() == Relay::Open;
            assert_eq!(open, cause == Trip::ValveStuck, "{}", said());
        }
        Act::Doubt(_) => assert_eq!(key(before), key(after), "{}", said()),
        Act::OpenAtOnce if from == State::Tripped => assert_eq!(after.relay(), Relay::Open, "{}", said()),
        _ => {}
    }
    // A test is faded in from nothing after arming, and is not cut short by anything but a trip.
    if by == Act::Request(OperatorRequest::Arm) && answer.is_ok() {
        assert!(after.test_weight() <= 0.0, "{}", said());
    }
    if by != Act::Tick && !matches!(by, Act::Request(OperatorRequest::Arm)) {
        assert_eq!(before.test_weight().to_bits(), after.test_weight().to_bits(), "{}", said());
    }
}

/// Every state, with what each is reached from. Returns states and steps.
fn explore(test: u16, safe: u16) -> (usize, usize) {
    let dt = 1e-3;
    let settings = RampSettings { test: f32::from(test) * dt, safe: f32::from(safe) * dt };
    let ramps = Ramps::new(&settings, dt).unwrap();
    let acts = acts();
    let mut seen: HashSet<Key> = HashSet::from([key(&Supervisor::off())]);
    let mut back: HashMap<Key, Vec<Key>> = HashMap::new();
    let mut open = VecDeque::from([Supervisor::off()]);
    let mut steps = 0;
    while let Some(before) = open.pop_front() {
        holds_of_a_state(&before);
        for &by in &acts {
            let mut after = before;
            let answer = act(&mut after, by, ramps);
            holds_of_a_step(&before, &after, by, answer);
            steps += 1;
            back.entry(key(&after)).or_default().push(key(&before));
            if seen.insert(key(&after)) {
                open.push_back(after);
            }
        }
        opens_in_time(before, ramps, safe);
    }
    leads_home(&back, seen.len());
    (seen.len(), steps)
}

/// After a trip the relay is open within the safe ramp's ticks, whatever the operator asks for meanwhile.
fn opens_in_time(mut supervisor: Supervisor, ramps: Ramps, safe: u16) {
    supervisor.trip(Trip::Displacement);
    // No ramp at all takes the one tick in which it is over.
    for _ in 0..safe.max(1) {
        for request in REQUESTS {
            let _ = supervisor.request(request);
        }
        if supervisor.state() != State::Tripped {
            // It had tripped before and was reset, or armed anew: another story.
            return;
        }
        supervisor.advance(ramps);
    }
    assert_eq!(supervisor.relay(), Relay::Open, "{supervisor:?}");
}

/// Off can be reached from every state: nothing locks the device up.
fn leads_home(back: &HashMap<Key, Vec<Key>>, states: usize) {
    let home = key(&Supervisor::off());
    let mut reached: HashSet<Key> = HashSet::from([home]);
    let mut open = vec![home];
    while let Some(at) = open.pop() {
        for &from in back.get(&at).into_iter().flatten() {
            if reached.insert(from) {
                open.push(from);
            }
        }
    }
    assert_eq!(reached.len(), states, "states from which off cannot be reached");
}

#[test]
fn every_interleaving_of_requests_causes_and_ticks_keeps_the_promises() {
    let (mut states, mut steps) = (0, 0);
    // No ramps at all, one longer than the other both ways, and the default safe ramp of 50 ticks.
    for (test, safe) in [(0, 0), (1, 5), (5, 1), (3, 3), (20, 50)] {
        let (found, walked) = explore(test, safe);
        println!("state machine, ramps of {test} and {safe} ticks: {found} states, {walked} steps");
        states += found;
        steps += walked;
    }
    println!("state machine: {states} states, {steps} steps");
    assert!(states > 10_000, "the exploration reached too little: {states}");
}

/// What can happen to a whole controller, between two ticks or in one.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Event {
    Request(OperatorRequest),
    /// A tick with sensors that tell the truth of a table at rest.
    Tick,
    /// One in which the LVDT is no number, and as many as make it lost.
    Deaf,
    DeafForLong,
    /// A tick with the LVDT beyond the stroke.
    Outside,
    /// As many as end any ramp.
    Wait,
    /// Other settings.
    Exchange,
}

const EVENTS: [Event; 14] = [
    Event::Request(OperatorRequest::Arm),
    Event::Request(OperatorRequest::Start),
    Event::Request(OperatorRequest::Hold),
    Event::Request(OperatorRequest::Resume),
    Event::Request(OperatorRequest::Stop),
    Event::Request(OperatorRequest::Off),
    Event::Request(OperatorRequest::Reset),
    Event::Request(OperatorRequest::Trip),
    Event::Tick,
    Event::Deaf,
    Event::DeafForLong,
    Event::Outside,
    Event::Wait,
    Event::Exchange,
];

/// Ticks that end any ramp of these settings, and that make a reading lost.
const RAMP: usize = 6;
const LOST: usize = 6;
/// Events in a row.
const DEPTH: usize = 5;

fn settings() -> Settings {
    let mut guard = GuardSettings { ramps: RampSettings { test: 0.005, safe: 0.005 }, ..GuardSettings::default() };
    guard.plausibility.lost = 0.005;
    Settings { guard: Some(guard), ..Settings::default() }
}

/// What is known of a controller from outside.
#[derive(Debug, Clone, Copy, Default)]
struct Known {
    /// Whether there has been a reading, and the last one was inside the stroke.
    inside: bool,
    /// Ticks since it.
    deaf: usize,
    /// Ticks since the trip.
    tripped: usize,
}

fn tick(controller: &mut Controller, displacement: f32, known: &mut Known) {
    let before = (controller.state(), controller.trip());
    let command = controller.step(&Sample::new(0.01, displacement, 0.0));
    assert!(command.valve.is_finite());
    if let (State::Tripped, trip) = before {
        assert_eq!((controller.state(), controller.trip()), (State::Tripped, trip), "a tick ends no trip");
    }
    known.tripped = if controller.state() == State::Tripped { known.tripped + 1 } else { 0 };
    assert!(known.tripped <= RAMP || controller.relay() == Relay::Open, "oil {} ticks after a trip", known.tripped);
    if displacement.is_finite() {
        (known.inside, known.deaf) = (displacement.abs() < 0.11, 0);
    } else {
        known.deaf += 1;
    }
}

fn happen(controller: &mut Controller, event: Event, known: &mut Known, tuning: &Tuning) {
    let before = (controller.state(), controller.relay(), controller.trip());
    match event {
        Event::Request(request) => {
            let answer = controller.request(request);
            if before.0 != State::Tripped || controller.state() != State::Tripped {
                known.tripped = 0;
            }
            match (request, answer) {
                (OperatorRequest::Arm, Ok(())) => {
                    assert!(known.inside && known.deaf == 0 && before.0 == State::Off, "armed in {before:?}");
                }
                (OperatorRequest::Reset, Ok(())) => assert_eq!((before.0, before.1), (State::Tripped, Relay::Open)),
                (OperatorRequest::Trip, Ok(())) => assert_eq!(controller.state(), State::Tripped),
                (_, Err(_)) => assert_eq!((controller.state(), controller.relay(), controller.trip()), before),
                _ => assert_ne!(controller.state(), before.0),
            }
        }
        Event::Tick => tick(controller, 0.0, known),
        Event::Deaf => tick(controller, f32::NAN, known),
        Event::DeafForLong => (0..LOST).for_each(|_| tick(controller, f32::NAN, known)),
        Event::Outside => tick(controller, 0.118, known),
        Event::Wait => (0..RAMP).for_each(|_| tick(controller, 0.0, known)),
        Event::Exchange => {
            controller.exchange(tuning).unwrap();
            assert_eq!((controller.state(), controller.relay(), controller.trip()), before);
        }
    }
    let closed = controller.relay() == Relay::Closed;
    let armed = event == Event::Request(OperatorRequest::Arm) && before.0 == State::Off;
    assert!(!closed || before.1 == Relay::Closed || armed, "oil by {event:?} in {before:?}");
    if matches!(event, Event::DeafForLong | Event::Outside) {
        assert!(!matches!(controller.state(), State::Ready | State::Running | State::Hold | State::RampDown));
    }
}

fn descend(controller: &Controller, known: Known, depth: usize, tuning: &Tuning, reached: &mut [usize; 6]) -> usize {
    reached[controller.state() as usize] += 1;
    if depth == 0 {
        return 1;
    }
    let mut sequences = 0;
    for event in EVENTS {
        let (mut next, mut known) = (controller.clone(), known);
        happen(&mut next, event, &mut known, tuning);
        sequences += descend(&next, known, depth - 1, tuning, reached);
    }
    sequences
}

#[test]
fn every_sequence_of_events_arms_only_a_table_that_is_seen() {
    let tuning = Tuning::new(&Settings { velocity_limit: 0.2, ..settings() }).unwrap();
    let mut reached = [0; 6];
    let mut sequences = 0;
    let fresh = Controller::new(&settings()).unwrap();
    // Before the first reading, and with a table at rest that has been seen.
    let (mut seen, mut known) = (fresh.clone(), Known::default());
    tick(&mut seen, 0.0, &mut known);
    for (controller, known) in [(fresh, Known::default()), (seen, known)] {
        sequences += descend(&controller, known, DEPTH, &tuning, &mut reached);
    }
    println!("controller: {sequences} sequences of {DEPTH} events; states reached, off to tripped: {reached:?}");
    assert!(reached.iter().all(|&often| often > 100), "{reached:?}");
}
