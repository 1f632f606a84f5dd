use super::super::{Codes, Events};
use super::*;
use crate::defaults;
use crate::queues::{LoopCommand, Queues, ServerEnd};
use shakedown_core::link::{Setup, Source};
use std::vec::Vec;

/// Ticks in which a test is faded in, and after which its end comes: the reference is at full speed then.
const BEFORE: u32 = 2749;
/// Ticks in all.
const TICKS: u32 = 6000;

/// How a test ends.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Ending {
    Stopped,
    HostSilent,
    Underrun,
    /// The record ends in full motion.
    End,
}

/// A device whose table is simulated, with every tick recorded.
fn setup() -> Setup {
    let mut setup = defaults::setup();
    setup.wiring.source = Source::Rehearsal;
    setup.telemetry_every = 1;
    setup
}

/// A sine of 0.2 m/s, m.
fn reference(tick: u32) -> f32 {
    0.05 * (tick as f32 * 4e-3).sin()
}

fn order(server: &mut ServerEnd<'_>, order: LoopCommand) {
    server.orders.enqueue(order).unwrap();
}

/// What the law was given in every tick of a test that ends like this, m, and how it stood afterwards.
fn fitted(ending: Ending) -> (Vec<f32>, State) {
    let mut queues = Queues::new();
    let (loop_end, mut server) = queues.split();
    let mut device = ControlLoop::new(&setup(), loop_end, false).unwrap();
    let mut seen = Vec::new();
    let mut sent = 0;
    for tick in 0..TICKS {
        match tick {
            5 => order(&mut server, LoopCommand::Ask(OperatorRequest::Arm)),
            6 => order(&mut server, LoopCommand::Ask(OperatorRequest::Start)),
            BEFORE if ending == Ending::Stopped => order(&mut server, LoopCommand::Ask(OperatorRequest::Stop)),
            BEFORE if ending == Ending::HostSilent => order(&mut server, LoopCommand::HostSilent),
            BEFORE if ending == Ending::End => server.points.enqueue(Point::END).unwrap(),
            _ => {}
        }
        // A host that is a quarter of a second ahead, until it is silent; of a record that ends nothing follows.
        let ahead = if ending == Ending::End { 1 } else { 250 };
        while tick > 5 && tick < BEFORE && sent < tick - 6 + ahead {
            server.points.enqueue(Point::new(reference(sent)).unwrap()).unwrap();
            sent += 1;
        }
        device.tick_with(Codes::of(|_| 0), Events::default());
        while let Some(entry) = server.records.dequeue() {
            seen.push(entry.record.fitted);
        }
    }
    assert_eq!(server.points.len(), 0, "{ending:?}: points are left for the next test");
    (seen, device.standing().state)
}

/// The largest second difference from a tick on, as an acceleration, m/s2.
fn hardest(fitted: &[f32]) -> f32 {
    let second = |w: &[f32]| (w[2] - 2.0 * w[1] + w[0]).abs() / 1e-6;
    fitted.windows(3).map(second).fold(0.0, f32::max)
}

/// However a test ends, the reference brakes as hard as the envelope plans for a table that stops, and no harder: 5 m/s2. One that stops
/// dead at 0.2 m/s would ask for 200.
#[test]
fn a_streamed_reference_never_stops_dead() {
    for ending in [Ending::Stopped, Ending::HostSilent, Ending::Underrun, Ending::End] {
        let (fitted, state) = fitted(ending);
        assert_eq!(state, State::Ready, "{ending:?}");
        let fastest = fitted.windows(2).map(|w| (w[1] - w[0]).abs() * 1e3).fold(0.0, f32::max);
        assert!((0.15..0.25).contains(&fastest), "{ending:?}: {fastest} m/s");
        assert!(hardest(&fitted) < 6.5, "{ending:?}: {} m/s2", hardest(&fitted));
        let farthest = fitted.iter().fold(0.0_f32, |most, x| most.max(x.abs()));
        assert!(farthest < 0.056, "{ending:?}: {farthest} m");
    }
}

/// A record may leap, and end with the leap: what goes on from there goes no faster than the table.
#[test]
fn a_leap_is_not_gone_on_with() {
    let mut queues = Queues::new();
    let (loop_end, mut server) = queues.split();
    let mut device = ControlLoop::new(&setup(), loop_end, false).unwrap();
    let tick = |device: &mut ControlLoop<'_>| _ = device.tick_with(Codes::of(|_| 0), Events::default());
    (0..5).for_each(|_| tick(&mut device));
    order(&mut server, LoopCommand::Ask(OperatorRequest::Arm));
    tick(&mut device);
    for point in [0.0, 0.05] {
        server.points.enqueue(Point::new(point).unwrap()).unwrap();
    }
    order(&mut server, LoopCommand::Ask(OperatorRequest::Start));
    (0..1000).for_each(|_| tick(&mut device));
    let way = setup().control.velocity_limit.powi(2) / (2.0 * 5.0);
    assert!(way - 2e-4 < device.reference - 0.05 && device.reference - 0.05 < way + 2e-4, "{}", device.reference);
}
