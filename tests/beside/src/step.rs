//! The core's whole step in each mode, around the paper's plant: a mark before every step and one behind it.

use core::hint::black_box;

use shakedown_core::settings::Gains;
use shakedown_core::{Controller, Mode, OperatorRequest, Sample, Settings};
use shakedown_firmware::defaults;

use crate::target::{BEGIN, END, mark};

/// Ticks of a run; the reader takes the median over the last half.
const TICKS: u16 = 2000;
const DT: f32 = 1e-3;
/// Eq. 7 of the paper, and its limiter.
const B0: f32 = 138.0;
const B1: f32 = 0.69;
const A1: f32 = 57.65;
const VELOCITY: f32 = 0.242;

#[inline(never)]
fn step(controller: &mut Controller, sample: &Sample) -> f32 {
    controller.step(sample).valve
}

/// The table, its reference, and the controller that is there already.
#[derive(Default)]
struct Table {
    z: f32,
    v: f32,
    x: f32,
    a: f32,
    /// A rotating vector, whose one part is the reference's.
    wave: (f32, f32),
}

impl Table {
    /// 40 mm at 1.3 Hz: 0.33 m/s, beyond what the table can do.
    fn reference(&mut self, tick: u16) -> f32 {
        if tick == 0 {
            self.wave = (0.04, 0.0);
        }
        let turn = 8.168e-3;
        self.wave.0 -= turn * self.wave.1;
        self.wave.1 += turn * self.wave.0;
        self.wave.1
    }

    fn advance(&mut self, u: f32) {
        let before = self.v;
        self.z += DT * ((B0 - B1 * A1) * u - A1 * self.z);
        self.v = self.z + B1 * u;
        self.v = if self.v > VELOCITY { VELOCITY } else { self.v };
        self.v = if self.v < -VELOCITY { -VELOCITY } else { self.v };
        self.x += DT * self.v;
        self.a = (self.v - before) / DT;
    }
}

fn run(number: u32, settings: &Settings) {
    // In place: the stack holds one, and not the copies that a result is handed over by.
    let mut controller = Controller::inert();
    if controller.retune(settings).is_err() {
        return;
    }
    let mut table = Table::default();
    for tick in 0..TICKS {
        let reference = table.reference(tick);
        let external = 3.7 * (reference - table.x);
        let sample = Sample { external, ..Sample::new(reference, table.x, table.a) };
        let sample = black_box(sample);
        mark(BEGIN | number);
        let out = step(black_box(&mut controller), &sample);
        mark(END | number);
        if let 3 | 6 = tick {
            let _ = controller.request(if tick == 3 { OperatorRequest::Arm } else { OperatorRequest::Start });
        }
        table.advance(if settings.mode == Mode::Modifier { 3.7 * (out - table.x) } else { out });
    }
}

/// Measures every mode, and the controller with all three variables fed back.
pub(crate) fn measure() {
    let mut settings = defaults::setup().control;
    if let Some(guard) = &mut settings.guard {
        guard.ramps.test = 0.1;
    }
    for (number, mode) in [(32, Mode::Guard), (33, Mode::Modifier), (34, Mode::Controller)] {
        run(number, &Settings { mode, ..settings });
    }
    let (velocity, acceleration) = (Gains::new(1.0, 0.1), Gains::new(0.02, 0.01));
    run(35, &Settings { velocity, acceleration, ..settings });
}
