//! A rehearsal on the board is a rehearsal on the host, bit for bit, whatever is at the board's converters.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use crate::common::{image, near_field, seen::Mischief, seen::Seen, setup, twin};
use shakedown::blocks::device::{DriveError, Progress};
use shakedown::blocks::plant::{
    Plant as _,
    paper::{FixedStep, Paper},
};
use shakedown_core::link::{Record, Setup, Source, StopCause};
use shakedown_core::settings::InnerLoop;
use shakedown_core::{Mode, State};
use shakedown_firmware::store::{InMemory, save};
use shakedown_rehearsal::Table;
use shakedown_replay::Ran;

const SECONDS: usize = 60;
/// Where the settings lie (`memory.x`).
const SLOT: u64 = 0x080C_0000;
/// Cycles of an instruction at worst: a line of the flash of its own, at five wait states (RM0090, table 10).
const CYCLES: f64 = 6.0;
/// Instructions of a tick's entry, dispatch and return, and of what it publishes last, which make no access that the count sees.
const AROUND: f64 = 300.0;
/// Cycles of 1 ms, and the share of them that a tick with its table may take.
const MILLISECOND: f64 = 168_000.0;
const SHARE: f64 = 0.4;

fn rehearsing(mode: Mode, inner_loop: InnerLoop) -> Setup {
    let mut setup = setup(mode);
    setup.wiring.source = Source::Rehearsal;
    setup.control.inner_loop = inner_loop;
    setup
}

/// Noise at every input, from a fixed generator: nothing of it may matter.
fn noise() -> Mischief {
    let mut state = 0x9E37_79B9_u32;
    Box::new(move |tick, _| {
        for code in tick.inputs.iter_mut() {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *code = (state >> 16) as u16;
        }
    })
}

/// A run on a board that has `setup` in its flash.
fn on_board(setup: Setup, record: &[f32], mischief: Mischief) -> Ran<Seen> {
    let mut memory = InMemory::erased();
    save(&mut memory, &setup).unwrap();
    let mut seen = Seen::new(setup, record.to_vec());
    seen.mischief = Some(mischief);
    shakedown_replay::run_with(&image(), &[(SLOT, memory.0[0].to_vec())], seen).unwrap()
}

/// The bits of a record.
fn bits(record: &Record) -> (u32, u32, [u16; 4], u16, u16) {
    (record.reference.to_bits(), record.fitted.to_bits(), record.inputs, record.output, record.flags)
}

/// The first tick whose telemetry, or whose motion at the output, is not the host's.
fn first_difference(setup: Setup, seconds: usize, spoil: impl FnMut(usize, u16) -> u16) -> (Ran<Seen>, Option<u32>) {
    let record = near_field(seconds);
    let ran = on_board(setup, &record, noise());
    let seen = &ran.world;
    assert_eq!(seen.progress, Progress::Done);
    let telemetry = seen.drive.telemetry();
    assert_eq!((telemetry.gaps(), telemetry.dropped()), (&[][..], 0));
    let twin = twin::run(setup, &record, telemetry, seen.codes.len() - 1, spoil);
    assert!(telemetry.rows().len() > seen.codes.len() - 200);
    let alike = |row: &&shakedown::blocks::device::Row| {
        let at = row.tick as usize;
        let Some(entry) = twin.entries.get(at) else { return true };
        let motion = (seen.codes[at].output, twin.codes[at].output);
        bits(&row.record) == bits(&entry.record) && row.state == entry.state && motion.0 == motion.1
    };
    let difference = telemetry.rows().iter().find(|row| !alike(row)).map(|row| row.tick);
    (ran, difference)
}

fn identical(setup: Setup) {
    let (ran, difference) = first_difference(setup, SECONDS, |_, code| code);
    assert_eq!(difference, None);
    let seen = &ran.world;
    let rows: Vec<_> = seen.drive.telemetry().run().collect();
    assert!(rows.len() >= SECONDS * 1000, "{} ticks ran", rows.len());
    let moved: std::collections::BTreeSet<u16> = rows.iter().map(|row| row.record.inputs[1]).collect();
    assert!(moved.len() > 300, "the table stood: {} codes", moved.len());
    assert!(seen.codes.iter().all(|codes| !codes.relay), "a rehearsal closed the relay");
}

#[test]
fn guard_mode_rehearses_bit_for_bit() {
    identical(rehearsing(Mode::Guard, InnerLoop::Absent));
}

#[test]
fn modifier_mode_rehearses_bit_for_bit() {
    identical(rehearsing(Mode::Modifier, InnerLoop::Absent));
}

#[test]
fn controller_mode_rehearses_bit_for_bit() {
    identical(rehearsing(Mode::Controller, InnerLoop::Absent));
}

#[test]
fn controller_mode_behind_a_hard_wired_loop_rehearses_bit_for_bit() {
    identical(rehearsing(Mode::Controller, InnerLoop::Hardwired));
}

/// The control of the tests above: a bit of the motion that goes out.
#[test]
fn one_wrong_bit_of_the_motion_is_found() {
    let spoil = |tick, code: u16| if tick == 2500 { code ^ 1 } else { code };
    let (_, difference) = first_difference(rehearsing(Mode::Controller, InnerLoop::Absent), 4, spoil);
    assert_eq!(difference, Some(2500));
}

/// What leaves by the output is the table's displacement, by the code of the LVDT, whose scale it shares, one tick on: half a step of
/// the output's 12 bits, and one of the LVDT's 16.
#[test]
fn the_motion_leaves_by_the_output() {
    let ran = on_board(rehearsing(Mode::Controller, InnerLoop::Absent), &near_field(4), noise());
    let seen = ran.world;
    let rows = seen.drive.telemetry().rows();
    for pair in rows.windows(2).filter(|pair| pair[1].tick == pair[0].tick + 1) {
        let (out, next) = (seen.codes[pair[0].tick as usize].output, pair[1].record.inputs[1]);
        assert!(out.abs_diff(next) <= 9, "tick {}: {out}, {next}", pair[0].tick);
    }
}

#[test]
fn a_stop_that_is_pressed_trips_a_rehearsal() {
    let mut others = noise();
    let pressed: Mischief = Box::new(move |tick, talker| {
        others(tick, talker);
        *tick.circuit_closed = tick.index < 6000;
    });
    let ran = on_board(rehearsing(Mode::Controller, InnerLoop::Absent), &near_field(12), pressed);
    let stopped =
        matches!(ran.world.progress, Progress::Failed(DriveError::Stopped { cause: StopCause::EmergencyStop, .. }));
    assert!(stopped, "{:?}", ran.world.progress);
    let last = ran.world.drive.telemetry().rows().last().unwrap();
    assert_eq!(last.state, State::Tripped);
}

/// The dearest tick of a rehearsal takes no more of 1 ms than it may, by a bound: every instruction at the worst that the flash
/// does to it. On a board the cycle counter says what it is.
#[test]
fn a_tick_with_its_table_takes_at_most_two_fifths_of_a_millisecond() {
    for (mode, inner_loop) in [
        (Mode::Guard, InnerLoop::Absent),
        (Mode::Modifier, InnerLoop::Absent),
        (Mode::Controller, InnerLoop::Absent),
        (Mode::Controller, InnerLoop::Hardwired),
    ] {
        let rehearsed = rehearsing(mode, inner_loop);
        let ran = on_board(rehearsed, &near_field(10), noise());
        assert_eq!(ran.world.progress, Progress::Done);
        let share = (ran.dearest_tick as f64 + AROUND) * CYCLES / MILLISECOND;
        println!("{mode:?}, {inner_loop:?}: {} instructions, at most {:.1} % of 1 ms", ran.dearest_tick, 100.0 * share);
        assert!(ran.dearest_tick > 500, "{} instructions are no tick", ran.dearest_tick);
        assert!(share <= SHARE, "{mode:?}: {share}");
    }
}

/// The table of a rehearsal is the paper's, which the host simulates exactly: under the same commands it is where that is, to the
/// rounding of single precision.
#[test]
fn the_table_is_the_papers() {
    let mut table = Table::new(1000.0);
    let mut exact = FixedStep::new(Paper::default(), 1e-3, 0.0).unwrap();
    let (mut farthest, mut limited) = (0.0_f64, 0);
    for tick in 0..60_000 {
        let t = f64::from(tick) * 1e-3;
        let command = (0.08 * (2.0 * t).sin() + 0.09 * (23.0 * t).sin() * (0.3 * t).sin()) as f32;
        table.advance(command);
        exact.advance(f64::from(command), 1);
        limited += u32::from(exact.saturated(f64::from(command)));
        farthest = farthest.max((f64::from(table.displacement()) - exact.displacement()).abs());
    }
    assert!(limited > 1000, "the limit was met in {limited} ticks only");
    assert!(farthest < 5e-6, "{farthest} m from the exact plant");
}
