//! Orders and ticks in every order that chance finds: whatever the server was told and when, nothing that needs an open relay
//! happens with a closed one, and every request has one answer.
use super::*;
use crate::defaults;
use crate::link_server::{Action, LinkServer, LoopStatus};
use crate::queues::Queues;
use shakedown_core::link::{Challenge, Clock, HostRequest as Asked, Report, answer};

const RUNS: u64 = 10_000;
const STEPS: usize = 40;

/// splitmix64.
struct Dice(u64);

impl Dice {
    fn below(&mut self, count: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % count
    }
}

/// How often each thing happened: an interleaving in which nothing does shows nothing.
#[derive(Debug, Default)]
struct Count {
    saves: u32,
    rewired: u32,
    refused: u32,
    armed: u32,
    closed_at_request: u32,
}

struct Device<'a> {
    decide: ControlLoop<'a>,
    server: LinkServer<'a>,
    /// What the loop published when it last told anyone.
    published: TestStatus,
    challenge: Challenge,
    owed: u32,
    count: &'a mut Count,
}

impl Device<'_> {
    fn tick(&mut self, events: Events) {
        let before = (self.decide.relay(), self.decide.wires, self.decide.rate);
        if self.decide.tick_with(Codes::of(|_| 32768), events).news && self.decide.news().tell {
            self.published = self.decide.standing();
        }
        let after = (self.decide.relay(), self.decide.wires, self.decide.rate);
        if !after.1.same_board(&before.1) || after.2 != before.2 {
            assert!(!before.0 && !after.0, "rewired with the relay closed");
            self.count.rewired += 1;
        }
        self.count.armed += u32::from(after.0 && !before.0);
        if !self.server.waits() {
            assert!(
                after.1.same_board(&InputScaling::new(self.server.setup())),
                "the server holds another setup for taken"
            );
        }
    }

    fn request(&mut self, request: Asked, dice: &mut Dice) {
        self.owed += 1;
        let sensitive = matches!(request, Asked::Save | Asked::WriteSetup(_));
        self.count.closed_at_request += u32::from(sensitive && self.decide.relay());
        let (ticks, dropped) = self.decide.counts();
        let seen = LoopStatus { standing: self.published, ticks, dropped, cause: None };
        let action = self.server.take(request, seen, self.server.milliseconds(ticks));
        self.act(action, dice);
    }

    fn act(&mut self, action: Action, dice: &mut Dice) {
        let report = match action {
            Action::Wait => return,
            Action::Send(report) => report,
            Action::TellOptions => Report::Options(heapless::Vec::new()),
            Action::Save(proof) => {
                self.count.saves += 1;
                assert!(!self.decide.relay(), "a save began with the relay closed");
                // On the board the ticks stand meanwhile, but for one that is already on its way, and nobody listens.
                for _ in 0..dice.below(100) {
                    match self.any(dice) {
                        Asked::Save | Asked::WriteSetup(_) => {}
                        request => self.request(request, dice),
                    }
                    self.tick(Events::default());
                    assert_eq!(self.decide.controller.relay(), Relay::Open, "closed while its proof was lent");
                }
                self.server.saved(proof, true)
            }
        };
        self.owed -= 1;
        match report {
            Report::Challenge(challenge) => self.challenge = challenge,
            Report::Refused(_) => self.count.refused += 1,
            _ => {}
        }
    }

    /// What the link does when it is woken: hears the loop, and then the host while it waits for nothing.
    fn serve(&mut self, dice: &mut Dice) {
        if let Some(action) = self.server.heed() {
            self.act(action, dice);
        }
        for _ in 0..=dice.below(3) {
            if !self.server.waits() {
                let request = self.any(dice);
                self.request(request, dice);
            }
        }
    }

    fn any(&self, dice: &mut Dice) -> Asked {
        match dice.below(16) {
            0..=3 => Asked::RequestArming,
            4..=7 => Asked::Arm(answer(self.challenge)),
            8 => Asked::Start,
            9 => Asked::Disarm,
            10 => Asked::Trip,
            11 => Asked::ClearTrip,
            12 | 13 => Asked::Save,
            14 => Asked::WriteSetup(setup(1000.0, 32768.0 + dice.below(3) as f32)),
            _ => Asked::WriteSetup(setup(1000.0 * (1 + dice.below(2)) as f32, 32768.0)),
        }
    }
}

fn setup(rate: f32, zero: f32) -> Setup {
    let mut setup = defaults::setup();
    setup.control.rate = rate;
    setup.wiring.external.zero = zero;
    setup
}

fn interleave(seed: u64, count: &mut Count) {
    let (mut queues, mut dice) = (Queues::new(), Dice(seed));
    let (loop_end, server_end) = queues.split();
    let decide = ControlLoop::new(&defaults::setup(), loop_end, false).unwrap();
    let server = LinkServer::new(defaults::setup(), false, Clock::Crystal, defaults::LIMITS, seed, server_end);
    let published = decide.standing();
    let mut device = Device { decide, server, published, challenge: Challenge(0), owed: 0, count };
    device.tick(Events::default());
    for _ in 0..STEPS {
        match dice.below(8) {
            0..=3 => device.serve(&mut dice),
            4 => device.tick(Events { emergency_stop: true, ..Events::default() }),
            5 => (0..dice.below(80)).for_each(|_| device.tick(Events::default())),
            _ => device.tick(Events::default()),
        }
    }
    for _ in 0..8 {
        device.tick(Events::default());
        if let Some(action) = device.server.heed() {
            device.act(action, &mut dice);
        }
    }
    assert_eq!(device.owed, 0, "a request without an answer");
}

#[test]
fn nothing_that_needs_an_open_relay_happens_with_a_closed_one() {
    let mut count = Count::default();
    for seed in 0..RUNS {
        interleave(seed, &mut count);
    }
    let all = [count.saves, count.rewired, count.refused, count.armed, count.closed_at_request];
    assert!(all.iter().all(|&often| often > 1000), "the interleavings reached too little: {count:?}");
}
