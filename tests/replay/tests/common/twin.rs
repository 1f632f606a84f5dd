//! The same run on the host: the firmware's own [`ControlLoop`] around the same core, the same bench, and orders at the ticks at
//! which the device's telemetry says that it took them.

use shakedown::blocks::device::Telemetry;
use shakedown_core::link::Setup;
use shakedown_core::{OperatorRequest, State};
use shakedown_firmware::ControlLoop;
use shakedown_firmware::queues::{Entry, LoopCommand, Point, Queues};
use shakedown_replay::Fitted;

use super::bench::Bench;
use super::seen::Codes;

/// What the twin did, by tick from the device's reset.
pub(crate) struct Twin {
    pub(crate) codes: Vec<Codes>,
    pub(crate) entries: Vec<Entry>,
}

/// Ticks at which the state became another, with the state before and the one it became.
fn changes(telemetry: &Telemetry) -> Vec<(u32, State, State)> {
    let rows = telemetry.rows();
    rows.windows(2).filter(|pair| pair[0].state != pair[1].state).map(|p| (p[1].tick, p[0].state, p[1].state)).collect()
}

/// Runs `ticks` of the twin. `spoil` may touch an output code on its way to the bench and the log.
pub(crate) fn run(
    setup: Setup,
    record: &[f32],
    telemetry: &Telemetry,
    ticks: usize,
    mut spoil: impl FnMut(usize, u16) -> u16,
) -> Twin {
    let changes = changes(telemetry);
    let fitted = Fitted::of(setup.wiring.full_scale);
    let mut queues = Queues::new();
    let (loop_end, mut server) = queues.split();
    let mut decide = ControlLoop::new(&setup, loop_end, false).unwrap();
    let mut bench = Bench::new(setup, record.to_vec());
    let mut points = record.iter().filter_map(|&point| Point::new(point)).chain([Point::END]);
    let mut twin = Twin { codes: Vec::new(), entries: Vec::new() };
    let (mut relay, mut armed) = (false, false);
    for tick in 0..ticks {
        for &(_, before, after) in changes.iter().filter(|(at, ..)| *at as usize == tick) {
            let request = match (before, after) {
                (State::Off, State::Ready) => OperatorRequest::Arm,
                (State::Ready, State::Running) => OperatorRequest::Start,
                (State::Ready, State::Off) => OperatorRequest::Off,
                _ => continue,
            };
            server.orders.enqueue(LoopCommand::Ask(request)).unwrap();
        }
        if armed
            && server.points.ready()
            && let Some(point) = points.next()
        {
            server.points.enqueue(point).unwrap();
        }
        let inputs = bench.codes();
        let outcome = decide.tick(|input| inputs[input]);
        let output = spoil(tick, fitted.at_the_output(outcome.output));
        twin.codes.push(Codes { inputs, output, relay: decide.relay() });
        while let Some(entry) = server.records.dequeue() {
            twin.entries.push(entry);
        }
        let closed = decide.relay();
        bench.advance(output, closed);
        if closed && !relay && bench.played.is_none() {
            bench.played = Some(0);
        }
        relay = closed;
        armed = !matches!(decide.standing().state, State::Off | State::Tripped);
    }
    twin
}
