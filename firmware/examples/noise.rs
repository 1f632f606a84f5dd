//! Noise into the link: `cargo run --release -p shakedown-firmware --example noise [BYTES [SEED]]`.
//!
//! A device's assembler and server hear so many bytes (10^9 where nothing is said) of each kind of noise, and the device must not
//! arm: bytes of any value; frames of every request with bits flipped; whole frames that ask for arming and answer wrongly, or
//! with the answer to an earlier challenge, as a recording of an earlier session would.
#![allow(clippy::print_stdout, reason = "what an example has to say")]

use std::process::ExitCode;

use shakedown_core::link::{
    Assembler, Challenge, Clock, HostRequest, LinkError, MAX_FRAME, Points, Report, answer, encode,
};
use shakedown_core::{OperatorRequest as Ask, State};
use shakedown_firmware::defaults;
use shakedown_firmware::link_server::{Action, LinkServer, LoopStatus};
use shakedown_firmware::queues::{LoopCommand, LoopEnd, Queues, TestStatus, Verdict};

/// splitmix64.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// Bytes of any value.
    Any,
    /// Frames of every request, one to eight bits of each flipped.
    Flipped,
    /// Whole frames: challenges asked for, answered wrongly or with an answer given before.
    Wrong,
}

/// What a device made of the noise.
#[derive(Debug, Default)]
struct Heard {
    bytes: u64,
    frames: u64,
    garbled: u64,
    others: u64,
    challenges: u64,
    answers: u64,
    armed: u64,
}

/// A device that hears.
struct Device<'a> {
    server: LinkServer<'a>,
    orders: LoopEnd<'a>,
    assembler: Assembler,
    heard: Heard,
    /// Answers to challenges given before, of which the last one's stays unsaid.
    earlier: Vec<u64>,
    last: Option<u64>,
}

impl Device<'_> {
    fn receive(&mut self, bytes: &[u8]) {
        self.heard.bytes += bytes.len() as u64;
        for &byte in bytes {
            match self.assembler.push::<HostRequest>(byte) {
                Some(Ok(request)) => self.take(request),
                Some(Err(LinkError::Garbled | LinkError::TooLong)) => self.heard.garbled += 1,
                Some(Err(_)) => self.heard.others += 1,
                None => {}
            }
        }
    }

    fn take(&mut self, request: HostRequest) {
        self.heard.frames += 1;
        self.heard.answers += u64::from(matches!(request, HostRequest::Arm(_)));
        let standing = TestStatus { state: State::Off, cause: None };
        let seen = LoopStatus { standing, ticks: 0, dropped: 0, cause: None };
        // A millisecond for every hundred bytes: 1 Mbit/s.
        let now = (self.heard.bytes / 100) as u32;
        if let Action::Send(Report::Challenge(challenge)) = self.server.take(request, seen, now) {
            self.heard.challenges += 1;
            self.earlier.extend(self.last.replace(answer(challenge)));
            if self.earlier.len() > 64 {
                self.earlier.remove(0);
            }
        }
        while let Some(order) = self.orders.orders.dequeue() {
            self.heard.armed += u64::from(order == LoopCommand::Ask(Ask::Arm));
            if matches!(order, LoopCommand::TakeSetup | LoopCommand::Lend) {
                self.orders.setups.dequeue();
                let _ = self.orders.verdicts.enqueue(Verdict::Taken);
            }
        }
        let _ = self.server.heed();
        while self.orders.points.dequeue().is_some() {}
    }
}

/// A request; none of them the right answer but by the chance that is measured.
fn request(kind: Kind, earlier: &[u64], dice: &mut Dice) -> HostRequest {
    let wrong = match earlier.len() as u64 {
        0 => dice.next(),
        count if dice.below(2) == 0 => earlier[dice.below(count) as usize],
        _ => dice.next(),
    };
    match dice.below(if kind == Kind::Wrong { 4 } else { 12 }) {
        0 => HostRequest::RequestArming,
        1..=3 => HostRequest::Arm(wrong),
        4 => HostRequest::Start,
        5 => HostRequest::Stop,
        6 => HostRequest::Disarm,
        7 => HostRequest::ClearTrip,
        8 => HostRequest::Trip,
        9 => HostRequest::WriteSetup(defaults::setup()),
        10 => HostRequest::Probe(dice.next() as u16),
        _ => {
            let points = (0..=dice.below(64)).map(|k| 1e-3 * k as f32).collect();
            HostRequest::Reference(Points { first: dice.next() as u32, points, last: false })
        }
    }
}

fn noise(kind: Kind, bytes: u64, seed: u64) -> Heard {
    let mut queues = Queues::new();
    let (orders, server) = queues.split();
    let server = LinkServer::new(defaults::setup(), false, Clock::Crystal, defaults::LIMITS, seed, server);
    let assembler = Assembler::new();
    let (heard, earlier, last) = (Heard::default(), Vec::new(), None);
    let mut device = Device { server, orders, assembler, heard, earlier, last };
    let mut dice = Dice(seed);
    while device.heard.bytes < bytes {
        if kind == Kind::Any {
            let mut block = [0; 4096];
            block.chunks_exact_mut(8).for_each(|eight| eight.copy_from_slice(&dice.next().to_le_bytes()));
            device.receive(&block);
            continue;
        }
        let request = request(kind, &device.earlier, &mut dice);
        let mut wire = [0; MAX_FRAME];
        let length = encode(&request, &mut wire).unwrap_or(0);
        if kind == Kind::Flipped {
            for _ in 0..=dice.below(8) {
                wire[dice.below(length as u64) as usize] ^= 1 << dice.below(8);
            }
        }
        device.receive(&wire[..length]);
    }
    device.heard
}

/// That a device arms when it is answered rightly; without it the noise would show nothing.
fn right_answer_arms() -> bool {
    let mut queues = Queues::new();
    let (mut orders, server) = queues.split();
    let mut server = LinkServer::new(defaults::setup(), false, Clock::Crystal, defaults::LIMITS, 1, server);
    let standing = TestStatus { state: State::Off, cause: None };
    let seen = LoopStatus { standing, ticks: 0, dropped: 0, cause: None };
    let Action::Send(Report::Challenge(Challenge(asked))) = server.take(HostRequest::RequestArming, seen, 0) else {
        return false;
    };
    let _ = server.take(HostRequest::Arm(answer(Challenge(asked))), seen, 1);
    std::iter::from_fn(|| orders.orders.dequeue()).any(|order| order == LoopCommand::Ask(Ask::Arm))
}

fn main() -> ExitCode {
    let mut words = std::env::args().skip(1).map(|word| word.replace('_', "").parse::<u64>());
    let (Ok(bytes), Ok(seed)) = (words.next().unwrap_or(Ok(1_000_000_000)), words.next().unwrap_or(Ok(1))) else {
        println!("expected: noise [BYTES [SEED]]");
        return ExitCode::from(2);
    };
    println!(
        "{:8} {:>12} {:>10} {:>10} {:>8} {:>10} {:>9} {:>6}",
        "noise", "bytes", "frames", "garbled", "others", "challenges", "answers", "armed"
    );
    let mut armed = 0;
    for kind in [Kind::Any, Kind::Flipped, Kind::Wrong] {
        let h = noise(kind, bytes, seed);
        armed += h.armed;
        let name = format!("{kind:?}").to_lowercase();
        println!(
            "{name:8} {:>12} {:>10} {:>10} {:>8} {:>10} {:>9} {:>6}",
            h.bytes, h.frames, h.garbled, h.others, h.challenges, h.answers, h.armed
        );
    }
    if !right_answer_arms() {
        println!("the right answer does not arm either: the noise showed nothing");
        return ExitCode::FAILURE;
    }
    println!("the right answer arms; noise armed {armed} times");
    if armed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
