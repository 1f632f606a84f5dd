//! Runs of the paper's table with effects, by the library's own simulation, with noise that is the same wherever it runs.

use shakedown::blocks::plant::{
    Baseline, EffectParameters, Excitation, Shaping, SimulatedLaw, Start, Wanted, simulate,
};
use std::fmt::Write as _;

/// Numbers between -1 and 1, four summed, nearly normal; the same wherever this runs.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    /// The next of this standard deviation.
    pub(crate) fn next(&mut self, deviation: f64) -> f64 {
        let mut sum = 0.0;
        for _ in 0..4 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            sum += (self.0 >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
        }
        sum * deviation * 3.0_f64.sqrt()
    }
}

/// Samples a second.
const RATE: f64 = 200.0;

/// A reference of five sines that starts and ends at rest.
fn reference(seed: u64) -> Vec<f64> {
    let n = 3200;
    let wave = |k: usize| {
        let t = k as f64 / RATE;
        let parts = [(0.23, 0.022), (0.61, 0.012), (1.3, 0.006), (2.7, 0.0025), (4.9, 0.0009)];
        let sum: f64 = parts
            .iter()
            .enumerate()
            .map(|(i, (f, a))| a * (std::f64::consts::TAU * f * t + (i as f64 + 1.0) * seed as f64).sin())
            .sum();
        let rise = (t / 1.5).min((n as f64 / RATE - t) / 1.5).clamp(0.0, 1.0);
        sum * rise * rise * (3.0 - 2.0 * rise)
    };
    (0..n).map(wave).collect()
}

/// A run of the paper's table, its gain `b0` apart, with effects, as CSV.
pub(crate) fn recorded(b0: f64, effects: &[EffectParameters<f64>], seed: u64) -> String {
    let baseline = Baseline::Servo { b1: 0.69, b0, a1: 57.65, velocity_limit: 0.242 };
    let (reference, dt) = (reference(seed), 1.0 / RATE);
    let drive = Excitation {
        dt,
        ticks: 1,
        input: &reference,
        added: &[],
        before: None,
        law: SimulatedLaw::Pi { kp: 3.7, ki: 0.6 },
        shaping: Shaping::default(),
        sensor_noise: 0.0,
        wanted: Wanted::ALL,
    };
    let start = Start { displacement: reference[0], velocity: 0.0, states: Vec::new(), time: 0.0 };
    let trace = simulate(&baseline, effects, &drive, &start).unwrap();
    let mut noise = Noise(seed);
    let mut text = String::from("time,reference,displacement,acceleration,command\n");
    for (k, r) in reference.iter().enumerate() {
        let (x, a) = (trace.displacement[k] + noise.next(2e-5), trace.acceleration[k] + noise.next(0.05));
        let _ = writeln!(text, "{},{r},{x},{a},{}", k as f64 * dt, trace.command[k]);
    }
    text
}

/// The channels of such a run.
pub(crate) const HEAD: &str = r#"
[channels]
time = { column = "time", unit = "s" }
reference = { column = "reference", unit = "m" }
displacement = { column = "displacement", unit = "m", noise = 2e-5 }
acceleration = { column = "acceleration", unit = "m/s2", noise = 0.05 }
"#;
