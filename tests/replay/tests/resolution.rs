//! What the converters' noise makes of a table at rest, with the noise of their data sheets, through the firmware's own sums and its
//! telemetry. Linearity apart: what bends a scale does not move a table that rests.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use std::path::PathBuf;

use crate::common::{bench::Bench, image, outboard, setup, setup_outboard};
use shakedown::blocks::device::LinkClient;
use shakedown_core::Mode;
use shakedown_core::link::{Report, Setup};
use shakedown_replay::{Fitted, Tick, World};

const TICKS: u64 = 4000;
const SETTLED: usize = 100;
/// Signal to noise of a full sine, dB: the chip's own (STM32F407 data sheet, table of the ADC's dynamic accuracy, least) and an AD7606's
/// of +/-10 V (its data sheet, least, without oversampling).
const ON_CHIP: f64 = 64.0;
const OUTBOARD: f64 = 88.5;
/// Bounds, m, of the stroke of 152 mm either side.
const BOUND_ON_CHIP: f64 = 25e-6;
const BOUND_OUTBOARD: f64 = 5e-6;

/// A fixed generator, roughly normal.
struct Normal(u64);

impl Normal {
    fn next(&mut self) -> f64 {
        (0..12).fold(-6.0, |sum, _| {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            sum + (self.0 >> 11) as f64 / (1u64 << 53) as f64
        })
    }
}

/// Noise of a converter of so many codes, of which the data sheet's figure contains that of rounding: what is left to add before it, codes.
fn added(codes: f64, decibels: f64) -> f64 {
    let whole = codes / 8.0_f64.sqrt() / 10.0_f64.powf(decibels / 20.0);
    (whole * whole - 1.0 / 12.0).sqrt()
}

/// A table at rest, a little off its middle, and nobody who asks for anything.
struct Resting {
    bench: Bench,
    fitted: Fitted,
    talker: LinkClient,
    noise: Normal,
    /// Of one scan, codes.
    deviation: f64,
    displacement: Vec<f64>,
    setup: Setup,
}

impl World for Resting {
    fn tick(&mut self, tick: Tick<'_>) -> bool {
        *tick.inputs = self.bench.codes().map(|code| code + 5);
        if self.fitted == Fitted::Outboard {
            for code in tick.inputs.iter_mut() {
                *code = (f64::from(*code) + self.deviation * self.noise.next()).round() as u16;
            }
        }
        self.talker.hear(tick.line.from_device.drain(..));
        while let Some(report) = self.talker.report() {
            if let Report::Telemetry(batch) = report {
                let scale = self.setup.wiring.displacement;
                self.displacement.extend(batch.records.iter().map(|record| f64::from(scale.to_si(record.inputs[1]))));
            }
        }
        tick.index < TICKS
    }

    fn fitted(&self) -> Fitted {
        self.fitted
    }

    fn scans(&mut self, inputs: [u16; 4]) -> [[u16; 4]; 16] {
        [(); 16].map(|()| {
            inputs.map(|code| {
                (f64::from(code) / 16.0 + self.deviation * self.noise.next()).round().clamp(0.0, 4095.0) as u16
            })
        })
    }
}

/// Standard deviation of displacement at rest, m.
fn at_rest(image: PathBuf, setup: Setup, deviation: f64) -> f64 {
    let resting = Resting {
        bench: Bench::new(setup, Vec::new()),
        fitted: Fitted::of(setup.wiring.full_scale),
        talker: LinkClient::new(),
        noise: Normal(0x2545_F491_4F6C_DD1D),
        deviation,
        displacement: Vec::new(),
        setup,
    };
    let read = shakedown_replay::run(&image, resting).unwrap().world.displacement;
    // The first tick may find no sample yet.
    let read = &read[SETTLED..];
    assert!(read.len() as u64 > TICKS / 2, "{} samples", read.len());
    let mean = read.iter().sum::<f64>() / read.len() as f64;
    (read.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / read.len() as f64).sqrt()
}

#[test]
fn displacement_at_rest_is_as_quiet_as_stated() {
    let chip = at_rest(image(), setup(Mode::Controller), added(4096.0, ON_CHIP));
    let out = at_rest(outboard(), setup_outboard(Mode::Controller), added(65_536.0, OUTBOARD));
    println!(
        "standard deviation at rest: {:.1} um with 16 scans on the chip, {:.1} um outboard",
        1e6 * chip,
        1e6 * out
    );
    assert!(chip <= BOUND_ON_CHIP && out <= BOUND_OUTBOARD, "{chip} m, {out} m");
    // The control: noise there is, and a single scan would read four times that of sixteen.
    let single = 0.1524 / 2048.0 * 4096.0 / 8.0_f64.sqrt() / 10.0_f64.powf(ON_CHIP / 20.0);
    assert!((0.2..0.3).contains(&(chip / single)), "{chip} m of {single} m");
}
