//! What is in the flash at power-on, and what is left there: a slot that is not whole never counts.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use crate::common::{bench::Bench, image, setup};
use shakedown::blocks::device::LinkClient;
use shakedown_core::link::{DeviceHealth, HostRequest, RefusedBecause, Report, Setup};
use shakedown_core::{Mode, State};
use shakedown_firmware::defaults;
use shakedown_firmware::store::{InMemory, save};
use shakedown_replay::{Ran, Tick, World};

/// Where the slots lie (`memory.x`).
const SLOTS: [u64; 2] = [0x080C_0000, 0x080E_0000];
/// Ticks between two questions.
const PAUSE: usize = 50;

/// Asks one question after the other, and keeps what it hears.
struct Asking {
    bench: Bench,
    talker: LinkClient,
    questions: std::vec::IntoIter<HostRequest>,
    heard: Vec<Report>,
    ticks: usize,
    relay: bool,
}

impl World for Asking {
    fn tick(&mut self, tick: Tick<'_>) -> bool {
        *tick.inputs = self.bench.codes();
        self.relay |= tick.relay;
        self.talker.hear(tick.line.from_device.drain(..));
        while let Some(report) = self.talker.report() {
            if !matches!(report, Report::Telemetry(_)) {
                self.heard.push(report);
            }
        }
        self.ticks += 1;
        if !self.ticks.is_multiple_of(PAUSE) {
            return true;
        }
        let Some(question) = self.questions.next() else { return false };
        self.talker.say(&question);
        tick.line.to_device.extend(self.talker.outgoing().drain(..));
        true
    }
}

fn ask(memory: &InMemory, questions: Vec<HostRequest>) -> Ran<Asking> {
    let world = Asking {
        bench: Bench::new(setup(Mode::Controller), Vec::new()),
        talker: LinkClient::new(),
        questions: questions.into_iter(),
        heard: Vec::new(),
        ticks: 0,
        relay: false,
    };
    let flash: Vec<(u64, Vec<u8>)> = SLOTS.iter().zip(memory.0).map(|(&at, slot)| (at, slot.to_vec())).collect();
    let ran = shakedown_replay::run_with(&image(), &flash, world).unwrap();
    assert!(!ran.world.relay, "the relay closed");
    ran
}

/// The setup in force after a reset with this in the flash, and the health of the device.
fn at_power_on(memory: &InMemory) -> (Setup, DeviceHealth) {
    match ask(memory, vec![HostRequest::ReadSetup, HostRequest::ReadVitals]).world.heard[..] {
        [Report::Setup(setup), Report::Vitals(vitals)] => (setup, vitals),
        ref other => panic!("{other:?}"),
    }
}

fn gain(proportional: f32) -> Setup {
    let mut setup = setup(Mode::Controller);
    setup.control.displacement.proportional = proportional;
    setup
}

/// A flash to which these were saved, one after the other.
fn holding(setups: &[Setup]) -> InMemory {
    let mut memory = InMemory::erased();
    for setup in setups {
        save(&mut memory, setup).unwrap();
    }
    memory
}

#[test]
fn the_setup_saved_last_is_in_force() {
    let (setup, vitals) = at_power_on(&holding(&[gain(2.0), gain(3.0)]));
    assert_eq!((setup, vitals.stored, vitals.state), (gain(3.0), true, State::Off));
}

/// One wrong bit anywhere in what the slot holds: the setup before it is in force.
#[test]
fn a_corrupted_slot_leaves_the_setup_before_it_in_force() {
    for (byte, bit) in [(0, 0), (5, 3), (9, 7), (20, 1), (200, 5)] {
        let mut memory = holding(&[gain(2.0), gain(3.0)]);
        memory.0[1][byte] ^= 1 << bit;
        let (setup, vitals) = at_power_on(&memory);
        assert_eq!((setup, vitals.stored, vitals.state), (gain(2.0), true, State::Off), "byte {byte}");
    }
}

#[test]
fn with_both_slots_corrupted_the_device_is_as_it_was_never_set_up() {
    let mut memory = holding(&[gain(2.0), gain(3.0)]);
    memory.0[0][40] ^= 2;
    memory.0[1][40] ^= 2;
    let (setup, vitals) = at_power_on(&memory);
    assert_eq!((setup, vitals.stored, vitals.state), (defaults::setup(), false, State::Off));
}

/// The emulated flash erases in its time and takes nothing that is programmed, as one does that is worn out: that is said,
/// what was written stays in force unsaved, and the stack is deep enough for the longest way through the device.
#[test]
fn a_save_that_the_flash_does_not_take_is_said() {
    let questions =
        vec![HostRequest::WriteSetup(gain(4.0)), HostRequest::Save, HostRequest::ReadVitals, HostRequest::ReadSetup];
    let ran = ask(&holding(&[gain(2.0), gain(3.0)]), questions);
    match ran.world.heard[..] {
        [Report::Done, Report::Refused(RefusedBecause::Flash), Report::Vitals(vitals), Report::Setup(setup)] => {
            assert_eq!((setup, vitals.stored), (gain(4.0), false));
        }
        ref other => panic!("{other:?}"),
    }
    assert!(ran.stack.deepest * 4 <= ran.stack.size * 3, "{:?}", ran.stack);
}

/// `FLASH_ACR`, `FLASH_SR` and `FLASH_CR` of the reference manual (RM0090, 3.9), and what of them is looked at.
const ACR: u64 = 0x4002_3C00;
const SR: u64 = 0x4002_3C0C;
const CR: u64 = 0x4002_3C10;
const ERRORS: u64 = 0b1111_0010;
const CACHE_ON: u64 = 1 << 10;
const CACHE_RESET: u64 = 1 << 12;
const PROGRAM: u64 = 1;
const ERASE: u64 = 1 << 1;
const START: u64 = 1 << 16;

/// An error's flag stays until a one is written to it, and then every later save would look failed; the cache of the data keeps what was
/// read before an erase, and takes its reset only while it is off. The emulated flash has neither.
#[test]
fn an_erase_leaves_no_old_error_and_no_old_reading() {
    let ran = ask(&holding(&[gain(2.0), gain(3.0)]), vec![HostRequest::Save]);
    let writes = ran.silicon.flash;
    let start = writes.iter().position(|&(at, value)| at == CR && value & START != 0).expect("nothing was erased");
    let (before, after) = writes.split_at(start);
    assert!(before.iter().any(|&(at, value)| at == SR && value & ERRORS == ERRORS), "{before:X?}");
    assert_eq!(after[0].1 & (PROGRAM | ERASE), ERASE, "programming and erasing at once");
    let cache: Vec<u64> =
        after.iter().filter(|&&(at, _)| at == ACR).map(|&(_, value)| value & (CACHE_ON | CACHE_RESET)).collect();
    assert_eq!(cache, [0, CACHE_RESET, 0, CACHE_ON], "the cache of the data");
}
