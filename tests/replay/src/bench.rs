//! The table and what else is wired to the board: Eq. 7 with the limiter, an LVDT, an accelerometer, and where the mode
//! has one, an existing proportional controller.

use shakedown_core::Mode;
use shakedown_core::link::Setup;

const B0: f64 = 138.0;
const B1: f64 = 0.69;
const A1: f64 = 57.65;
const LIMIT: f64 = 0.242;
/// Integration steps a tick.
const STEPS: usize = 4;

/// A bench that turns output codes into input codes.
#[derive(Debug, Clone)]
pub struct Bench {
    setup: Setup,
    record: Vec<f32>,
    z: f64,
    x: f64,
    v: f64,
    a: f64,
    external: f64,
    /// Ticks since the record began.
    pub played: Option<usize>,
}

impl Bench {
    /// At rest in the middle; `record` is what the existing controller follows in guard mode.
    pub fn new(setup: Setup, record: Vec<f32>) -> Self {
        Self { setup, record, z: 0.0, x: 0.0, v: 0.0, a: 0.0, external: 0.0, played: None }
    }

    /// One tick under the output `code`; with the relay open no oil flows.
    pub fn advance(&mut self, code: u16, relay: bool) {
        let out = f64::from(self.setup.wiring.output.to_si(code));
        let u = match self.setup.control.mode {
            // The device hands on a reference; the existing controller behind it closes the loop.
            Mode::Modifier => 3.7 * (out - self.x),
            _ => out,
        };
        let dt = 1.0 / f64::from(self.setup.control.rate);
        let before = self.v;
        if relay {
            for _ in 0..STEPS {
                let h = dt / STEPS as f64;
                self.z += h * (-A1 * self.z + (B0 - B1 * A1) * u);
                self.v = (self.z + B1 * u).clamp(-LIMIT, LIMIT);
                self.x += h * self.v;
            }
        } else {
            (self.z, self.v) = (0.0, 0.0);
        }
        self.a = (self.v - before) / dt;
        if let Some(played) = &mut self.played {
            let target = f64::from(self.record.get(*played).copied().unwrap_or(0.0));
            self.external = 3.7 * (target - self.x);
            *played += 1;
        }
    }

    /// The codes at the converter now.
    pub fn codes(&self) -> [u16; 4] {
        let wiring = &self.setup.wiring;
        let code = |scale: &shakedown_core::link::Scale, si: f64| {
            (si / f64::from(scale.per_code) + f64::from(scale.zero)).round().clamp(0.0, 4095.0) as u16
        };
        [
            code(&wiring.reference, 0.0),
            code(&wiring.displacement, self.x),
            code(&wiring.acceleration, self.a),
            code(&wiring.external, self.external),
        ]
    }

    /// Where the table is, m.
    pub fn displacement(&self) -> f64 {
        self.x
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
