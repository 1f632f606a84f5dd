//! Boots an image and says what it costs.
use std::time::Instant;
use shakedown_replay::{Tick, World, run};

struct Still { ticks: u64, last: u64, counts: Vec<u64>, bytes: usize, outputs: Vec<Option<u16>> }

impl World for Still {
    fn tick(&mut self, tick: Tick<'_>) -> bool {
        *tick.inputs = [2048, 2048, 2048, 2048];
        self.counts.push(tick.instructions - self.last);
        self.last = tick.instructions;
        self.bytes += tick.line.from_device.len();
        tick.line.from_device.clear();
        if self.outputs.len() < 10 { self.outputs.push(tick.output); }
        tick.index < self.ticks
    }
}

fn main() {
    let elf = std::env::args().nth(1).unwrap();
    let begun = Instant::now();
    let ran = run(elf.as_ref(), Still { ticks: 20000, last: 0, counts: vec![], bytes: 0, outputs: vec![] }).unwrap();
    let s = begun.elapsed().as_secs_f64();
    eprintln!("{:.2} s, {:.0} ticks/s, {} bytes, resets {:?}, blind {:?}", s, 20000.0 / s, ran.world.bytes, ran.resets, ran.blind_spots);
    eprintln!("{:?}\n{:?}", &ran.world.counts[..40], ran.world.outputs);
}
