//! Ticks a second of the image in the loop, on one core: ticks over the processor time of the fastest of several runs, so
//! that what else the machine does counts less. A run begins with the emulator translating the image, which takes about a
//! second whatever the length of the run; what follows its tenth second stands beside the whole. Arguments: image, run by
//! number.
#![allow(clippy::unwrap_used, clippy::large_types_passed_by_value, reason = "shares the tests' helpers")]
#![allow(clippy::print_stdout, reason = "its only output")]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{bench::Bench, near_field, seen::Seen, setup};
use shakedown_core::Mode;
use shakedown_core::link::{Setup, Source};
use shakedown_replay::{ReplayError, Tick, World};
use std::path::Path;

const SECONDS: usize = 60;
const RUNS: usize = 3;
/// Tick at which a run that needs no stream has begun for certain, and its host falls silent.
const STARTED: u64 = 3000;
/// Ticks after which all that a run needs is translated.
const WARM: u64 = 10_000;

/// The bench at the converters and nobody at the line: the device as it is at a table between tests.
struct Quiet {
    bench: Bench,
    ticks: u64,
}

impl World for Quiet {
    fn tick(&mut self, tick: Tick<'_>) -> bool {
        if let Some(output) = tick.output {
            self.bench.advance(output, tick.relay);
        }
        *tick.inputs = self.bench.codes();
        self.ticks += 1;
        self.ticks < SECONDS as u64 * 1000
    }
}

/// A world whose ticks are counted and timed.
struct Timed<W> {
    world: W,
    ticks: u64,
    begun: f64,
    warm: f64,
}

impl<W: World> World for Timed<W> {
    fn tick(&mut self, tick: Tick<'_>) -> bool {
        self.ticks += 1;
        if self.ticks == WARM {
            self.warm = processor_time();
        }
        self.world.tick(tick)
    }
}

/// Processor time of this process so far, s, in hundredths (proc(5): user and system time in ticks of 10 ms).
fn processor_time() -> f64 {
    let line = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = line.rsplit(')').next().unwrap_or_default().split_whitespace();
    fields.skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// Ticks a second of one run: of the whole, and once warm.
fn speed<W: World>(image: &Path, world: W) -> Result<[f64; 2], ReplayError> {
    let timed = Timed { world, ticks: 0, begun: processor_time(), warm: 0.0 };
    let ran = shakedown_replay::run(image, timed)?.world;
    let ended = processor_time();
    Ok([ran.ticks as f64 / (ended - ran.begun), (ran.ticks - WARM) as f64 / (ended - ran.warm)])
}

fn fastest(name: &str, mut run: impl FnMut() -> Result<[f64; 2], ReplayError>) {
    let mut best = [0.0_f64; 2];
    for ran in (0..RUNS).filter_map(|_| run().ok()) {
        best = std::array::from_fn(|i| best[i].max(ran[i]));
    }
    println!("{:8.0} ticks/s, {:8.0} once warm  {name}", best[0], best[1]);
}

fn main() {
    let image = std::env::args().nth(1).unwrap_or_else(|| common::image().display().to_string());
    let image = Path::new(&image);
    let wanted: Option<usize> = std::env::args().nth(2).and_then(|number| number.parse().ok());
    let streamed = |mode: Mode, every: u16| {
        let setup = Setup { telemetry_every: every, ..setup(mode) };
        speed(image, Seen::new(setup, near_field(SECONDS)))
    };
    let alone = |mode: Mode| {
        let mut setup = Setup { telemetry_every: 0, ..setup(mode) };
        setup.wiring.source = Source::Analog;
        let mut seen = Seen::new(setup, near_field(SECONDS));
        seen.after = u32::MAX;
        seen.mischief = Some(Box::new(|tick, _| {
            if tick.index > STARTED {
                assert!(tick.relay, "the run is over at tick {}", tick.index);
                tick.line.to_device.clear();
            }
        }));
        speed(image, seen)
    };
    let quiet = |mode: Mode| speed(image, Quiet { bench: Bench::new(setup(mode), near_field(SECONDS)), ticks: 0 });
    let runs: [(&str, &dyn Fn() -> Result<[f64; 2], ReplayError>); 8] = [
        ("controller, record streamed, telemetry of every tick", &|| streamed(Mode::Controller, 1)),
        ("controller, record streamed, telemetry of every tenth tick", &|| streamed(Mode::Controller, 10)),
        ("controller, record streamed, no telemetry", &|| streamed(Mode::Controller, 0)),
        ("controller, reference at the converter, no telemetry", &|| alone(Mode::Controller)),
        ("guard, no telemetry", &|| alone(Mode::Guard)),
        ("modifier, record streamed, no telemetry", &|| streamed(Mode::Modifier, 0)),
        ("controller, nobody at the line", &|| quiet(Mode::Controller)),
        ("guard, nobody at the line", &|| quiet(Mode::Guard)),
    ];
    for (_, (name, run)) in (1..).zip(runs).filter(|(number, _)| wanted.is_none_or(|wanted| wanted == *number)) {
        fastest(name, run);
    }
}
