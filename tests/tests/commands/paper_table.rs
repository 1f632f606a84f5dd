//! Recordings of the paper's table, from a truth that shares no code with what reads them, and the experiment that states its set-up.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use shakedown::fit::Recipe;
use shakedown::fit::generate::{self, NEAR_FIELD_MODERATE, NEAR_FIELD_STRONG};
use shakedown_truth::closed_loop::{Controller, Run, simulate};
use shakedown_truth::noise::Noise;
use shakedown_truth::plant::{Machine, Physics};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

const RATE: f64 = 200.0;
const GAINS: (f64, f64) = (3.7, 0.6);
const NOISE: (f64, f64) = (1.5e-5, 0.1);

/// A generated record as the paper prepares its own, scaled.
fn reference(recipe: generate::Recipe, seed: u64, scale: f64) -> Vec<f64> {
    let motion = Recipe::table1(RATE).apply(&recipe.generate(seed).unwrap()).unwrap();
    motion.displacement.iter().take(4800).map(|x| x * scale).collect()
}

/// What is stated of the set-up, where it is not what ran.
pub(crate) struct Stated {
    /// Whether the command is recorded.
    pub(crate) command: bool,
    /// Samples by which the displacement is recorded late.
    pub(crate) late: usize,
    /// The stated integral gain, as a multiple of the one that ran, 1.
    pub(crate) integral: f64,
    /// Amplitude of a hum at 50.03 Hz in the accelerometer, m/s2.
    pub(crate) hum: f64,
    /// By how much one sample of the accelerometer in the middle of each run is wrong, m/s2.
    pub(crate) spike: f64,
}

impl Default for Stated {
    fn default() -> Self {
        Self { command: true, late: 0, integral: 1.0, hum: 0.0, spike: 0.0 }
    }
}

/// The paper's table.
pub(crate) fn paper() -> Physics {
    Physics::baseline(Machine::Servo { b1: 0.69, b0: 138.0, a1: 57.65, velocity_limit: 0.242 })
}

/// What the accelerometer's wiring makes of an acceleration.
fn recorded(acceleration: &[f64], dt: f64, stated: &Stated) -> Vec<f64> {
    let hum = |k: usize| stated.hum * (TAU * 50.03 * k as f64 * dt + 1.0).sin();
    let spike = |k: usize| if k == acceleration.len() / 2 { stated.spike } else { 0.0 };
    (0..acceleration.len()).map(|k| acceleration[k] + hum(k) + spike(k)).collect()
}

/// The experiment: two strong records and a moderate one to fit, another strong one held out.
pub(crate) fn write(folder: &Path, physics: &Physics, stated: &Stated) {
    let records = [
        (NEAR_FIELD_STRONG, 1, 1.0),
        (NEAR_FIELD_MODERATE, 2, 1.0),
        (NEAR_FIELD_STRONG, 3, 0.7),
        (NEAR_FIELD_STRONG, 4, 0.9),
    ];
    let mut toml = String::from(
        "name = \"paper table\"\n[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n\
         [channels]\ntime = { column = \"time\", unit = \"s\" }\nreference = { column = \"reference\", unit = \"m\" }\n\
         displacement = { column = \"displacement\", unit = \"m\", noise = 1.5e-5 }\n\
         acceleration = { column = \"acceleration\", unit = \"m/s2\", noise = 0.1 }\n",
    );
    if stated.command {
        toml.push_str("command = { column = \"command\", unit = \"1\" }\n");
    }
    for (number, (recipe, seed, scale)) in records.into_iter().enumerate() {
        let run = Run {
            reference: reference(recipe, seed, scale),
            dt: 1.0 / RATE,
            controller: Controller::Pi { kp: GAINS.0, ki: GAINS.1 },
            number: number as u64,
        };
        let (displacement, acceleration) = NOISE;
        let noise = Noise { displacement, step: 0.0, acceleration, colour: 0.0, hum: None, seed: (7, 7) };
        let traces = simulate(physics, &run, Some(&noise)).expect("a stable loop");
        let acceleration = recorded(&traces.acceleration, run.dt, stated);
        let mut csv = String::from("time,reference,displacement,acceleration,command\n");
        for (k, a) in acceleration.iter().enumerate() {
            let (t, r) = (k as f64 * run.dt, run.reference[k]);
            let (x, u) = (traces.displacement[k.saturating_sub(stated.late)], traces.command[k]);
            let _ = writeln!(csv, "{t:.3},{r:.9},{x:.9},{a:.6},{u:.9}");
        }
        std::fs::write(folder.join(format!("{number}.csv")), csv).unwrap();
        let purpose = if number == 3 { "holdout" } else { "fit" };
        let _ = writeln!(
            toml,
            "[[runs]]\nfile = \"{number}.csv\"\ncontroller = {{ kp = {}, ki = {} }}\nuse = \"{purpose}\"",
            GAINS.0,
            stated.integral * GAINS.1
        );
    }
    std::fs::write(folder.join("experiment.toml"), toml).unwrap();
}
