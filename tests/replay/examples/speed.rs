//! Ticks a second of the image in the loop, on one core: ticks over the processor time of the fastest of several runs, so
//! that what else the machine does counts less. Arguments: image, run by number.
#![allow(clippy::unwrap_used, clippy::large_types_passed_by_value, reason = "shares the tests' helpers")]
#![allow(clippy::print_stdout, reason = "its only output")]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{bench::Bench, near_field, seen::Seen, setup};
use shakedown_core::Mode;
use shakedown_core::link::Setup;
use shakedown_replay::{Tick, World};
use std::path::Path;

const SECONDS: usize = 60;
const RUNS: usize = 3;

/// The bench at the converters and nobody at the line: the device as it stands at a table between tests.
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

/// Processor time of this process so far, s, in hundredths (proc(5): user and system time in ticks of 10 ms).
fn processor_time() -> f64 {
    let line = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = line.rsplit(')').next().unwrap_or_default().split_whitespace();
    fields.skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

fn least(name: &str, mut ticks: impl FnMut() -> Result<usize, shakedown_replay::ReplayError>) {
    let fastest = (0..RUNS)
        .filter_map(|_| {
            let start = processor_time();
            ticks().ok().map(|ticks| ticks as f64 / (processor_time() - start))
        })
        .fold(0.0, f64::max);
    println!("{fastest:8.0} ticks/s  {name}");
}

fn main() {
    let image = std::env::args().nth(1).unwrap_or_else(|| common::image().display().to_string());
    let image = Path::new(&image);
    let wanted: Option<usize> = std::env::args().nth(2).and_then(|number| number.parse().ok());
    let mut number = 0;
    let mut least = |name: &str, ticks: &mut dyn FnMut() -> Result<usize, shakedown_replay::ReplayError>| {
        number += 1;
        if wanted.is_none_or(|wanted| wanted == number) {
            least(name, ticks);
        }
    };
    let streamed = |every: u16| {
        let setup = Setup { telemetry_every: every, ..setup(Mode::Controller) };
        let ran = shakedown_replay::run(image, Seen::new(setup, near_field(SECONDS)))?;
        Ok(ran.world.codes.len())
    };
    least("controller, record streamed, telemetry of every tick", &mut || streamed(1));
    least("controller, record streamed, telemetry of every tenth tick", &mut || streamed(10));
    least("controller, record streamed, no telemetry", &mut || streamed(0));
    least("nobody at the line, telemetry of every tick", &mut || {
        let bench = Bench::new(setup(Mode::Controller), near_field(SECONDS));
        Ok(shakedown_replay::run(image, Quiet { bench, ticks: 0 })?.world.ticks as usize)
    });
}
