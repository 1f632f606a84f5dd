//! What needs an open relay waits for one: a save, another rate and another wiring, asked for at the worst moments.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use crate::common::{bench::Bench, image, near_field, seen::Mischief, seen::Seen, setup};
use shakedown::blocks::device::LinkClient;
use shakedown_core::link::{HostRequest, RefusedBecause, Report, Setup, answer};
use shakedown_core::{Mode, State};
use shakedown_replay::{Tick, World};

/// When the emergency stop is pressed: in the middle of a run.
const AT: usize = 6000;
/// The safe ramp, s: long enough for a host to ask for anything in it.
const RAMP: f32 = 0.3;

/// With a long safe ramp.
fn ramping() -> Setup {
    let mut setup = setup(Mode::Controller);
    let lag = setup.control.valve.lag;
    let guard = setup.control.guard.as_mut().unwrap();
    guard.ramps.safe = RAMP;
    // The way to stop over such a ramp has to be planned for.
    guard.envelope.stopping_latency = 0.5 * RAMP + lag;
    setup
}

/// A run whose emergency stop is pressed at [`AT`], and `request` made when the ramp is half over.
fn asked_in_the_ramp(request: HostRequest) -> Seen {
    let mut seen = Seen::new(ramping(), near_field(12));
    let mut said = false;
    let mischief: Mischief = Box::new(move |tick, talker| {
        *tick.circuit_closed = (tick.index as usize) < AT;
        if tick.index as usize >= AT + (500.0 * RAMP) as usize && !said {
            said = true;
            talker.say(&request);
        }
    });
    seen.mischief = Some(mischief);
    seen.after = 1000;
    seen.limit = 12_000;
    shakedown_replay::run(&image(), seen).unwrap().world
}

/// The longest time from one tick to the next with the relay closed in between, ms.
fn longest_tick(seen: &Seen) -> f64 {
    let closed = seen.codes.iter().zip(seen.times.windows(2)).filter(|(codes, _)| codes.relay);
    closed.map(|(_, pair)| (pair[1] - pair[0]) as f64 / 1e6).fold(0.0, f64::max)
}

/// How long the relay was closed after [`AT`], ms.
fn ramped(seen: &Seen) -> f64 {
    let open = (AT..seen.codes.len()).find(|&tick| !seen.codes[tick].relay).expect("the relay stayed closed");
    (seen.times[open] - seen.times[AT]) as f64 / 1e6
}

#[test]
fn a_save_in_the_safe_ramp_does_not_stop_the_ticks() {
    let seen = asked_in_the_ramp(HostRequest::Save);
    assert!(longest_tick(&seen) < 1.1, "{} ms without a tick", longest_tick(&seen));
    assert!((290.0..320.0).contains(&ramped(&seen)), "{} ms", ramped(&seen));
}

#[test]
fn another_rate_in_the_safe_ramp_is_not_taken() {
    let mut slower = ramping();
    slower.control.rate = 500.0;
    let seen = asked_in_the_ramp(HostRequest::WriteSetup(slower));
    assert!(longest_tick(&seen) < 1.1, "{} ms without a tick", longest_tick(&seen));
    assert!((290.0..320.0).contains(&ramped(&seen)), "{} ms", ramped(&seen));
}

#[test]
fn another_wiring_in_the_safe_ramp_is_not_taken() {
    let mut inverted = ramping();
    inverted.wiring.output.per_code = -inverted.wiring.output.per_code;
    let other = asked_in_the_ramp(HostRequest::WriteSetup(inverted));
    let same = asked_in_the_ramp(HostRequest::ReadVitals);
    let outputs = |seen: &Seen| seen.codes[AT..AT + 300].iter().map(|codes| codes.output).collect::<Vec<_>>();
    assert_eq!(outputs(&other), outputs(&same));
}

/// Arms, and asks for a save in the same breath.
struct Hasty {
    bench: Bench,
    talker: LinkClient,
    heard: Vec<Report>,
    /// Virtual time of each tick, ns, and whether the relay was closed after it.
    ticks: Vec<(u64, bool)>,
    /// Bytes kept, so that the burst begins later within a tick.
    delay: usize,
}

impl World for Hasty {
    fn tick(&mut self, tick: Tick<'_>) -> bool {
        *tick.inputs = self.bench.codes();
        if let Some(last) = self.ticks.last_mut() {
            last.1 = tick.relay;
        }
        self.ticks.push((tick.time, false));
        self.talker.hear(tick.line.from_device.drain(..));
        while let Some(report) = self.talker.report() {
            if let Report::Challenge(challenge) = report {
                tick.line.to_device.extend(std::iter::repeat_n(0, self.delay));
                self.talker.say(&HostRequest::Arm(answer(challenge)));
                self.talker.say(&HostRequest::Save);
            }
            if !matches!(report, Report::Telemetry(_) | Report::Vitals(_)) {
                self.heard.push(report);
            }
        }
        if self.ticks.len() == 50 {
            self.talker.say(&HostRequest::RequestArming);
        }
        tick.line.to_device.extend(self.talker.outgoing().drain(..));
        self.ticks.len() < 300
    }
}

#[test]
fn a_save_in_one_breath_with_arming_is_refused() {
    for delay in [0, 20, 40, 60, 80] {
        let bench = Bench::new(setup(Mode::Controller), Vec::new());
        let world = Hasty { bench, talker: LinkClient::new(), heard: Vec::new(), ticks: Vec::new(), delay };
        let world = shakedown_replay::run(&image(), world).unwrap().world;
        let refused = Report::Refused(RefusedBecause::State(State::Ready));
        assert!(matches!(world.heard[..], [Report::Challenge(_), Report::Done, _]), "{:?}", world.heard);
        assert_eq!(world.heard[2], refused, "{delay} bytes later");
        assert!(world.ticks[299 - 1].1, "not armed");
        let gap = world.ticks.windows(2).map(|pair| pair[1].0 - pair[0].0).max().unwrap();
        assert!(gap < 1_100_000, "{gap} ns without a tick, {delay} bytes later");
    }
}
