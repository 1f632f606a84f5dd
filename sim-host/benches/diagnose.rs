//! The whole library with pairs on 4 runs of 30 s at 1 kHz: wall-clock and processor time of a diagnosis, from the files on.
//!
//! `cargo bench -p shakedown --bench diagnose`
//!
//! The recordings come from the tool's own simulation: this measures time, not what a diagnosis is worth, which
//! `shakedown prove` does on data that share no code with it.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a bench prints its figures and stops where it cannot"
)]

use shakedown::blocks::faults::dice::FaultRng;
use shakedown::blocks::plant::{Baseline, EffectParameters, Excitation, SimulatedLaw, Start, Wanted, simulate};
use shakedown::diagnose::{Options, diagnose};
use shakedown::recording::Experiment;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

const DT: f64 = 1e-3;
const SECONDS: f64 = 30.0;
const RUNS: usize = 4;
const NOISE: [f64; 2] = [1e-5, 0.05];

/// Tones of another phase in each run, as fast as the limit lets through.
fn reference(number: usize) -> Vec<f64> {
    let tone = |t: f64, i: i32| {
        let hz = 0.25 * 1.7_f64.powi(i);
        0.03 / f64::from(i + 1) * (std::f64::consts::TAU * hz * t + f64::from(i) * number as f64).sin()
    };
    let at = |k: usize| {
        let t = k as f64 * DT;
        t.min(1.0) * (0..7).map(|i| tone(t, i)).sum::<f64>()
    };
    (0..(SECONDS / DT) as usize).map(at).collect()
}

fn recording(number: usize, effects: &[EffectParameters<f64>]) -> String {
    let input = reference(number);
    let drive = Excitation {
        dt: DT,
        ticks: 1,
        input: &input,
        added: &[],
        before: None,
        law: SimulatedLaw::Pi { kp: 6.0, ki: 0.6 },
        shaping: shakedown::blocks::plant::Shaping::default(),
        sensor_noise: NOISE[0],
        wanted: Wanted::ALL,
    };
    let table = Baseline::Servo { b1: 0.69, b0: 138.0, a1: 57.65, velocity_limit: 0.242 };
    let start = Start { displacement: input[0], velocity: 0.0, states: Vec::new(), time: 0.0 };
    let trace = simulate(&table, effects, &drive, &start).expect("the table runs");
    let mut dice = FaultRng::new(1, number as u64);
    let mut text = String::from("time,reference,displacement,acceleration,command\n");
    for (k, reference) in input.iter().enumerate() {
        let x = trace.displacement[k] + NOISE[0] * dice.normal();
        let a = trace.acceleration[k] + NOISE[1] * dice.normal();
        let _ = writeln!(text, "{:.3},{:.9},{x:.9},{a:.6},{:.9}", k as f64 * DT, reference, trace.command[k]);
    }
    text
}

fn experiment(folder: &Path, effects: &[EffectParameters<f64>]) -> Experiment {
    let mut text = String::from(
        "name = \"bench\"\n[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 131.0\na1 = 55.0\nvelocity_limit = 0.242\n\
         fit = [\"b0\", \"a1\"]\n[channels]\ntime = { column = \"time\", unit = \"s\" }\n\
         reference = { column = \"reference\", unit = \"m\" }\ncommand = { column = \"command\", unit = \"1\" }\n\
         displacement = { column = \"displacement\", unit = \"m\", noise = 1e-5 }\n\
         acceleration = { column = \"acceleration\", unit = \"m/s2\", noise = 0.05 }\n",
    );
    for number in 1..=RUNS {
        std::fs::write(folder.join(format!("{number}.csv")), recording(number, effects)).expect("a writable folder");
        let purpose = if number == RUNS { "holdout" } else { "fit" };
        let _ = writeln!(
            text,
            "[[runs]]\nfile = \"{number}.csv\"\ncontroller = {{ kp = 6.0, ki = 0.6 }}\nuse = \"{purpose}\""
        );
    }
    let path = folder.join("experiment.toml");
    std::fs::write(&path, text).expect("a writable folder");
    Experiment::load(&path).expect("a whole experiment")
}

/// Processor time of this process so far, s; none where the system does not say.
fn processor() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let ticks: Vec<f64> =
        stat.rsplit(')').next()?.split_whitespace().skip(11).take(2).map_while(|t| t.parse().ok()).collect();
    Some(ticks.iter().sum::<f64>() / 100.0)
}

fn main() {
    let one = |id, parameters: &[f64]| EffectParameters { id, parameters: parameters.to_vec() };
    let cases = [
        ("nothing missing", vec![]),
        ("a deadband", vec![one("valve_deadband", &[1.5e-3, 0.01])]),
        (
            "friction and a payload",
            vec![one("coulomb_friction", &[0.25, 1e-5]), one("payload_resonance", &[0.2, 6.0, 0.03, 0.0])],
        ),
    ];
    println!("4 runs of 30 s at 1 kHz, {} cores", rayon::current_num_threads());
    for (name, effects) in cases {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let experiment = experiment(folder.path(), &effects);
        let (wall, cpu) = (Instant::now(), processor());
        let examined = diagnose(&experiment, &Options::default()).expect("a diagnosis");
        let spent = processor().zip(cpu).map_or(f64::NAN, |(now, then)| now - then);
        let named: Vec<&str> = examined.diagnosis.effects.iter().map(|e| e.id).collect();
        println!("{name}: {:.1} s, {spent:.1} s of processors; named {named:?}", wall.elapsed().as_secs_f64());
    }
}
