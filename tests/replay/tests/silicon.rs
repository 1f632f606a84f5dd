//! What an emulator forgives and silicon does not, each with the forgiveness taken away.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use crate::common::{
    bench::Bench, g474_image, image, near_field, outboard, seen::Mischief, seen::Seen, setup, setup_outboard,
};
use shakedown::blocks::device::{LinkClient, Progress};
use shakedown_core::Mode;
use shakedown_core::link::{Clock, HostRequest, Report, StopCause};
use shakedown_replay::{Oscillator, Ran, Tick, World};

/// When the fault begins: in the middle of a run.
const AT: usize = 6000;
const GPIOD_PUPDR: u64 = 0x4002_0C0C;
const DAC_CR: u64 = 0x4000_7400;
const RCC_CR: u64 = 0x4002_3800;
const CSSON: u64 = 1 << 19;
const RNG_CR: u64 = 0x5006_0800;
const RNGEN: u64 = 1 << 2;

fn seen(seconds: usize) -> Seen {
    let mut seen = Seen::new(setup(Mode::Controller), near_field(seconds));
    seen.limit = 1000 * seconds + 4000;
    seen
}

fn run(seen: Seen) -> Ran<Seen> {
    shakedown_replay::run(&image(), seen).unwrap()
}

/// Time from the fault to the relay's opening, ms.
fn opened_after(seen: &Seen) -> f64 {
    assert!(seen.codes[AT - 1].relay, "the fault met no run: {:?}", seen.progress);
    let open = (AT..seen.codes.len()).find(|&tick| !seen.codes[tick].relay).expect("the relay stayed closed");
    (seen.times[open] - seen.times[AT]) as f64 / 1e6
}

fn supply(millivolts: u32) -> Seen {
    let mut seen = seen(12);
    let sag: Mischief = Box::new(move |tick, _| {
        *tick.supply = if tick.index as usize >= AT { millivolts } else { 3300 };
    });
    seen.mischief = Some(sag);
    run(seen).world
}

/// The monitor is behind a clock of its own, without which it takes no setting and says that all is well.
#[test]
fn a_supply_that_sags_trips() {
    let seen = supply(2800);
    assert_eq!(seen.cause(), Some(StopCause::SupplyLow));
    assert!(opened_after(&seen) <= 60.0, "{} ms", opened_after(&seen));
}

#[test]
fn a_board_of_three_volts_runs() {
    let mut seen = seen(3);
    seen.mischief = Some(Box::new(|tick, _| *tick.supply = 3000));
    assert_eq!(run(seen).world.progress, Progress::Done);
}

/// Asks the device who it is.
struct Asking {
    bench: Bench,
    talker: LinkClient,
    clock: Option<Clock>,
    ticks: usize,
    oscillator: Oscillator,
}

impl World for Asking {
    fn tick(&mut self, tick: Tick<'_>) -> bool {
        *tick.inputs = self.bench.codes();
        self.talker.hear(tick.line.from_device.drain(..));
        while let Some(report) = self.talker.report() {
            if let Report::Identity(identity) = report {
                self.clock = Some(identity.clock);
            }
        }
        self.ticks += 1;
        if self.ticks == 50 {
            self.talker.say(&HostRequest::Identify);
        }
        tick.line.to_device.extend(self.talker.outgoing().drain(..));
        self.ticks < 200
    }

    fn oscillator(&self) -> Oscillator {
        self.oscillator
    }
}

/// Whatever is on the crystal's pins, the device starts, and says what it counts time by.
#[test]
fn the_device_starts_without_a_crystal_and_says_so() {
    let all = [
        (Oscillator::Crystal, Clock::Crystal),
        (Oscillator::External, Clock::External),
        (Oscillator::Dead, Clock::Internal),
    ];
    for (oscillator, clock) in all {
        let bench = Bench::new(setup(Mode::Controller), Vec::new());
        let world = Asking { bench, talker: LinkClient::new(), clock: None, ticks: 0, oscillator };
        let ran = shakedown_replay::run(&image(), world).unwrap();
        assert_eq!(ran.world.clock, Some(clock), "{oscillator:?}");
        assert!(ran.resets.is_empty(), "{oscillator:?}");
        // A clock from outside is watched from then on (RM0090, 7.2.7); the internal oscillator has nothing to fall back to.
        let watched = ran.silicon.ever_set(RCC_CR) & CSSON != 0;
        assert_eq!(watched, clock != Clock::Internal, "{oscillator:?}");
    }
}

/// The watchdog's clock is any between 17 and 47 kHz: the slowest still opens the relay in the time stated, the fastest resets no
/// program that is well.
#[test]
fn the_watchdog_keeps_its_time_over_the_spread_of_its_clock() {
    for (frequency, within) in [(17_000, 110.0), (32_000, 65.0), (47_000, 45.0)] {
        let mut dead = seen(12);
        (dead.watchdog_clock, dead.dead_from) = (frequency, Some(AT));
        let dead = run(dead).world;
        assert_eq!((dead.resets, dead.cause()), (1, Some(StopCause::Restarted)), "{frequency} Hz");
        assert!(opened_after(&dead) <= within, "{} ms at {frequency} Hz", opened_after(&dead));
    }
    let mut well = seen(3);
    well.watchdog_clock = 47_000;
    let well = run(well).world;
    assert_eq!((well.resets, &well.progress), (0, &Progress::Done));
}

/// The emulated generator draws none, so that it was asked is all there is to see.
#[test]
fn challenges_are_made_of_the_chips_own_random_numbers() {
    for image in [image(), outboard()] {
        let mut seen = seen(1);
        if image == outboard() {
            seen = Seen::new(setup_outboard(Mode::Controller), near_field(1));
        }
        let ran = shakedown_replay::run(&image, seen).unwrap();
        assert_eq!(ran.silicon.ever_set(RNG_CR) & RNGEN, RNGEN);
        assert!(ran.blind_spots.iter().any(|spot| spot == "RNG.DR" || spot == "RNG.SR"), "{:?}", ran.blind_spots);
    }
}

#[test]
fn no_byte_is_stolen_from_the_line() {
    let ran = run(seen(3));
    assert_eq!((ran.silicon.stolen, ran.world.progress), (0, Progress::Done));
}

/// The output's buffer ends 0.2 V from either rail, so it is off; the line's input is pulled up.
#[test]
fn the_pins_are_set_as_the_guide_says() {
    let ran = run(seen(1));
    assert_eq!(ran.silicon.written(DAC_CR), Some(0b11), "EN1 and BOFF1 (RM0090, 14.5.1)");
    assert_eq!(ran.silicon.written(GPIOD_PUPDR).map(|pulls| pulls >> 18 & 0b11), Some(0b01), "PD9 up (RM0090, 8.4.4)");
}

/// The handler of a fault opens the relay by its first store, before a branch or a push: the stack may be what is gone.
#[test]
fn a_fault_opens_the_relay_without_a_stack() {
    // movw r0, #0x0418; movt r0, #0x4002, on the STM32G474 #0x4800; mov.w r1, #0x10000; str r1, [r0].
    let f407 = [0xF240, 0x4018, 0xF2C4, 0x0002, 0xF44F, 0x3180, 0x6001];
    let g474 = [0xF240, 0x4018, 0xF6C4, 0x0000, 0xF44F, 0x3180, 0x6001];
    for (image, expected) in [(image(), f407), (outboard(), f407), (g474_image(), g474)] {
        let code = shakedown_replay::size::fault_handler(&image).unwrap();
        assert_eq!(code[..expected.len()], expected, "{}: {code:04X?}", image.display());
    }
}
