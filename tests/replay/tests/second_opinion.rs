//! The firmware's loop on QEMU's Cortex-M4F, closed over the same bench, gives the codes that the host gives.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use std::fs::{File, OpenOptions};
use std::io::{Read as _, Write as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::common::{bench::Bench, built, near_field, setup};
use shakedown_core::link::Setup;
use shakedown_core::{Mode, OperatorRequest};
use shakedown_firmware::ControlLoop;
use shakedown_firmware::queues::{LoopCommand, Point, Queues, ServerEnd};
use shakedown_second_opinion::{Done, FROM_DEVICE, Given, SETUP, TO_DEVICE};

const SECONDS: usize = 60;
/// Ticks at which the test is armed and started, and those after its record.
const ARM: usize = 20;
const START: usize = 40;
const AFTER: usize = 4000;

fn qemu(folder: &Path) -> Child {
    let image = built("shakedown-second-opinion");
    for name in [TO_DEVICE, FROM_DEVICE] {
        assert!(Command::new("mkfifo").arg(folder.join(name)).status().unwrap().success());
    }
    Command::new("qemu-system-arm")
        .args(["-machine", "netduinoplus2", "-nographic", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(image)
        .current_dir(folder)
        .stdin(Stdio::null())
        .spawn()
        .expect("qemu-system-arm is missing: `cargo xtask setup` installs it")
}

/// What each tick is given, closed over a bench.
struct Outside {
    bench: Bench,
    points: std::vec::IntoIter<f32>,
    relay: bool,
}

impl Outside {
    fn new(setup: Setup, record: Vec<f32>) -> Self {
        let points: Vec<f32> = record.iter().copied().chain([f32::NAN]).collect();
        Self { bench: Bench::new(setup, record), points: points.into_iter(), relay: false }
    }

    fn give(&mut self, tick: usize) -> Given {
        let request = match tick {
            ARM => Some(OperatorRequest::Arm),
            START => Some(OperatorRequest::Start),
            _ => None,
        };
        // A point ahead of each tick, then the end of the record.
        let point = if tick >= START { self.points.next() } else { None };
        Given { inputs: self.bench.codes(), point, request }
    }

    fn take(&mut self, done: Done) {
        self.bench.advance(done.output, done.relay);
        if done.relay && !self.relay && self.bench.played.is_none() {
            self.bench.played = Some(0);
        }
        self.relay = done.relay;
    }
}

/// One tick of the same loop on the host.
fn tick(decide: &mut ControlLoop<'_>, server: &mut ServerEnd<'_>, given: &Given) -> Done {
    if let Some(request) = given.request {
        server.orders.enqueue(LoopCommand::Ask(request)).unwrap();
    }
    if let Some(point) = given.point {
        server.points.enqueue(Point::new(point).unwrap_or(Point::END)).unwrap();
    }
    let outcome = decide.tick(|input| given.inputs.get(input).copied().unwrap_or_default());
    while server.records.dequeue().is_some() {}
    Done { output: outcome.output, relay: decide.relay() }
}

/// Runs `mode` on both; the first tick at which they differ, and how many different codes went out.
fn first_difference(mode: Mode, seconds: usize, mut spoil: impl FnMut(usize, Done) -> Done) -> (Option<usize>, usize) {
    let (setup, record) = (setup(mode), near_field(seconds));
    let folder = tempfile::tempdir().unwrap();
    let mut child = qemu(folder.path());
    let mut to: File = OpenOptions::new().write(true).open(folder.path().join(TO_DEVICE)).unwrap();
    let mut from = File::open(folder.path().join(FROM_DEVICE)).unwrap();
    let mut bytes = [0; SETUP];
    postcard::to_slice(&setup, &mut bytes).unwrap();
    to.write_all(&bytes).unwrap();

    let mut queues = Queues::new();
    let (loop_end, mut server) = queues.split();
    let mut decide = ControlLoop::new(&setup, loop_end, false).unwrap();
    let mut outside = Outside::new(setup, record.clone());
    let mut codes = std::collections::BTreeSet::new();
    let difference = (0..START + record.len() + AFTER).find(|&at| {
        let given = outside.give(at);
        to.write_all(&given.to_bytes()).unwrap();
        let mut bytes = [0; Done::LENGTH];
        from.read_exact(&mut bytes).unwrap();
        let theirs = Done::from_bytes(bytes);
        let ours = spoil(at, tick(&mut decide, &mut server, &given));
        codes.insert(theirs.output);
        outside.take(theirs);
        theirs != ours
    });
    drop(to);
    assert!(child.wait().unwrap().success());
    (difference, codes.len())
}

#[test]
fn another_emulator_gives_the_same_codes() {
    for mode in [Mode::Guard, Mode::Modifier, Mode::Controller] {
        let (difference, codes) = first_difference(mode, SECONDS, |_, done| done);
        assert_eq!(difference, None, "{mode:?}");
        assert!(codes > 100, "only {codes} different codes: the run showed nothing");
    }
}

/// The control of the test above.
#[test]
fn one_wrong_bit_is_found_here_too() {
    let spoil = |tick, done: Done| if tick == 2500 { Done { output: done.output ^ 1, ..done } } else { done };
    assert_eq!(first_difference(Mode::Controller, 4, spoil).0, Some(2500));
}
