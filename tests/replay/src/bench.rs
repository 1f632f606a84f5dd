//! The table and what else is wired to the board: that of a rehearsal, which is Eq. 7 with the limiter, an LVDT, an accelerometer,
//! and where the mode has one, an existing proportional controller.

use shakedown_core::link::{Setup, Wiring};
use shakedown_rehearsal::{Behind, Inputs, Rehearsal};

/// A bench that turns output codes into input codes.
#[derive(Debug, Clone)]
pub struct Bench {
    wiring: Wiring,
    record: Vec<f32>,
    rehearsal: Rehearsal,
    /// What the existing controller follows, m.
    target: f32,
    /// Ticks since the record began.
    pub played: Option<usize>,
}

impl Bench {
    /// At rest in the middle; `record` is what the existing controller follows in guard mode.
    pub fn new(setup: Setup, record: Vec<f32>) -> Self {
        let rehearsal = Rehearsal::new(setup.control.rate, Behind::of(&setup.control));
        Self { wiring: setup.wiring, record, rehearsal, target: 0.0, played: None }
    }

    /// One tick under the output `code`; with the relay open no oil flows.
    pub fn advance(&mut self, code: u16, relay: bool) {
        self.rehearsal.advance(self.wiring.output.to_si(code), relay);
        if let Some(played) = &mut self.played {
            self.target = self.record.get(*played).copied().unwrap_or(0.0);
            *played += 1;
        }
    }

    /// The codes at the converter now.
    pub fn codes(&self) -> [u16; 4] {
        let Wiring { reference, displacement, acceleration, external, full_scale, .. } = self.wiring;
        self.rehearsal.codes(&Inputs { reference, displacement, acceleration, external, full_scale }, self.target)
    }

    /// Where the table is, m.
    pub fn displacement(&self) -> f64 {
        f64::from(self.rehearsal.table().displacement())
    }
}

/// A near-field record of `seconds` at 1 kHz, m: a fling step with a velocity pulse beyond the table's limit, and
/// incoherent shaking on top, from a fixed generator.
pub fn near_field(seconds: usize) -> Vec<f32> {
    let mut noise = 0x2545_F491_4F6C_DD1D_u64;
    let mut shake = [0.0_f64; 2];
    (0..seconds * 1000)
        .map(|tick| {
            let t = tick as f64 / 1000.0;
            noise ^= noise << 13;
            noise ^= noise >> 7;
            noise ^= noise << 17;
            let white = (noise >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
            shake[0] += 0.02 * (white - shake[0]);
            shake[1] += 0.01 * (shake[0] - shake[1]);
            let pulse = |at: f64, width: f64| 0.035 * (-((t - at) / width).powi(2)).exp() * ((t - at) * 9.0).sin();
            let fling = 0.02 * (1.0 / (1.0 + (-(t - 8.0) * 6.0).exp()) - 1.0 / (1.0 + (-(t - 40.0)).exp()));
            let window = (t / 3.0).min(1.0) * ((seconds as f64 - t) / 5.0).clamp(0.0, 1.0);
            (window * (pulse(8.0, 1.2) + pulse(21.0, 2.5) + fling + 0.12 * shake[1])) as f32
        })
        .collect()
}
