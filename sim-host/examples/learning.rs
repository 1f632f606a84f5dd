//! What iterative learning comes to: on three records at 0.242 m/s, beside plain iterative learning, and how surely a payload that
//! has softened since is noticed before a learnt drive is played. `cargo run --release -p shakedown --example learning [PAYLOADS]`.
#![allow(clippy::print_stdout, reason = "an example prints what it measured")]

use shakedown::blocks::closed_loop::learning::stale::{check_motion, stale};
use shakedown::blocks::closed_loop::learning::{Learned, Learning, Limits, Update, learn, played};
use shakedown::blocks::motion::{ASKED, RecordFit};
use shakedown::blocks::plant::EffectParameters;
use shakedown::blocks::plant::paper::Paper;
use shakedown::blocks::plant::sensors::SensorModel;
use shakedown::fit::{Recipe, read};
use shakedown::simulate::{Named, Setup, Twin};
use std::error::Error;
use std::path::{Path, PathBuf};

const LIMITS: Limits = Limits { displacement: 0.12, velocity: 0.242, acceleration: 15.0 };

fn main() -> Result<(), Box<dyn Error>> {
    let payloads = std::env::args().nth(1).map_or(Ok(250), |n| n.parse())?;
    let mut held = records()?;
    held &= staleness(payloads)?;
    if held { Ok(()) } else { Err("a bound is missed".into()) }
}

fn records() -> Result<bool, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let data = std::env::var_os("SHAKEDOWN_DATA").map_or_else(|| root.join("../shared/data"), PathBuf::from);
    let mut held = true;
    for name in ["RSN1106_KOBE_KJM000.AT2", "Rinaldi228.AT2", "IELC180.AT2"] {
        let path = data.join("records").join(name);
        if !path.exists() {
            println!("SKIPPED: {} is not at hand; set SHAKEDOWN_DATA to the folder of the data", path.display());
            continue;
        }
        let motion = Recipe::table1(1000.0).apply(&read::record(&path, &read::Options::default())?)?;
        let fit = RecordFit::parse("nearest").ok_or("no fit of that name")?;
        let wanted = fit.apply(&motion, 0.95 * LIMITS.velocity, ASKED * LIMITS.displacement, |_| {})?;
        let mut setup = Setup::paper(Named::Current);
        setup.sensors = SensorModel::laboratory(1);
        let ours = learn(&setup, &wanted, &LIMITS, &Learning::default())?;
        let plain = learn(&setup, &wanted, &LIMITS, &Learning { update: Update::Plain, ..Learning::default() })?;
        let errors = |l: &Learned| l.rounds.iter().map(|r| r.score.e_a.ratio).collect::<Vec<f64>>();
        let (a, b) = (errors(&ours), errors(&plain));
        let most = |get: fn(&shakedown::blocks::closed_loop::learning::Iteration) -> f64| {
            ours.rounds.iter().map(get).fold(0.0, f64::max)
        };
        let (x, v, g) =
            (most(|r| r.reached.displacement), most(|r| r.reached.velocity), most(|r| r.reached.acceleration));
        let text = |e: &[f64]| e.iter().map(|e| format!("{e:.3}")).collect::<Vec<_>>().join(" ");
        println!("{name}: E_a run by run {}; plain {}", text(&a), text(&b));
        println!(
            "  true peaks of all runs: {x:.4} of {} m, {v:.4} of {} m/s, {g:.2} of {} m/s2; {}",
            LIMITS.displacement,
            LIMITS.velocity,
            LIMITS.acceleration,
            ours.refused.map_or("none refused".to_owned(), |r| r.to_string())
        );
        let ratio = a.get(1).zip(b.get(1)).map_or(f64::NAN, |(a, b)| a / b);
        let converged = ours.refused.is_none() && a.last().zip(a.first()).is_some_and(|(l, f)| *l < 0.5 * f);
        let within = x <= LIMITS.displacement && v <= LIMITS.velocity && g <= LIMITS.acceleration;
        println!(
            "  after one run {ratio:.2} of plain learning's error (at most 0.5); converged: {converged}; within the limits: {within}"
        );
        held &= ratio <= 0.5 && converged && within;
    }
    Ok(held)
}

/// Numbers that are the same wherever this runs.
struct Dice(u64);

impl Dice {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let x = (self.0 ^ (self.0 >> 32)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        low + (high - low) * (x >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A table with a payload; on another day its gain and its null bias are a little others.
fn table(payload: [f64; 3], friction: f64, gain: f64, null: f64) -> Twin {
    let placed = |id, parameters: &[f64]| EffectParameters { id, parameters: parameters.to_vec() };
    let paper = Paper::default();
    let [ratio, frequency, damping] = payload;
    Twin {
        plant: Paper { b0: paper.b0 * gain, b1: paper.b1 * gain, ..paper },
        effects: vec![
            placed("null_bias", &[null, 0.0]),
            placed("coulomb_friction", &[friction, 2e-5]),
            placed("payload_resonance", &[ratio, frequency, damping, 0.0]),
        ],
    }
}

/// Intact payloads that are called changed, and softened ones that are not.
fn staleness(payloads: usize) -> Result<bool, Box<dyn Error>> {
    let drive = check_motion(1000.0, 0.04, 0.012);
    let (mut false_alarms, mut found) = (0, 0);
    let mut by_softening = [(0usize, 0usize); 4];
    for k in 0..payloads {
        let mut dice = Dice(k as u64 * 7919 + 17);
        for _ in 0..5 {
            dice.between(0.0, 1.0);
        }
        let payload = [dice.between(0.1, 0.6), dice.between(1.5, 8.0), dice.between(0.01, 0.06)];
        let friction = dice.between(0.0, 0.3);
        let null = || 0.0;
        let run = |twin: Twin, seed: u64| -> Result<Vec<f64>, Box<dyn Error>> {
            let mut setup = Setup::paper(Named::Strong);
            (setup.table, setup.sensors) = (twin, SensorModel::laboratory(k as u64 + 1));
            // Logged at 250 Hz.
            Ok(played(&setup, &drive, seed)?.into_iter().step_by(4).collect())
        };
        let before = run(table(payload, friction, 1.0, null()), 1)?;
        // Another day: oil at another temperature.
        let gain = 1.0 + dice.between(-0.01, 0.01);
        let bias = dice.between(-2e-4, 2e-4);
        let intact = run(table(payload, friction, gain, bias), 2)?;
        let soft = dice.between(0.1, 0.5);
        let softened = [payload[0], payload[1] * (1.0 - soft).sqrt(), payload[2]];
        let changed = run(table(softened, friction, gain, bias), 3)?;
        let (same, other) = (stale(&before, &intact, 4e-3)?, stale(&before, &changed, 4e-3)?);
        false_alarms += usize::from(same.stale);
        found += usize::from(other.stale);
        let class = &mut by_softening[(((soft - 0.1) / 0.1) as usize).min(3)];
        *class = (class.0 + usize::from(other.stale), class.1 + 1);
        if std::env::var_os("SHOW").is_some() {
            println!(
                "{k} ratio {:.2} at {:.1} Hz, {:.0} % softer: {:.4} at {:.1} Hz; intact {:.4} at {:.1} Hz",
                payload[0],
                payload[1],
                100.0 * soft,
                other.change,
                other.frequency,
                same.change,
                same.frequency
            );
        }
    }
    let parts: Vec<String> = by_softening
        .iter()
        .zip(1..)
        .map(|((f, n), k)| format!("{f} of {n} softened by {}0 to {}0 %", k, k + 1))
        .collect();
    let missed = far_bound(payloads - found, payloads);
    println!(
        "payload softened since: noticed {found} of {payloads} ({}); 95 % bound {:.2} % (at least 95 %)",
        parts.join(", "),
        100.0 * (1.0 - missed)
    );
    let far = far_bound(false_alarms, payloads);
    println!(
        "payload intact: called changed {false_alarms} of {payloads}; 95 % bound {:.2} % (at most 2 %)",
        100.0 * far
    );
    Ok(missed <= 0.05 && far <= 0.02)
}

/// The one-sided 95 % bound of a rate of which so many of so many were seen (Clopper and Pearson).
fn far_bound(seen: usize, of: usize) -> f64 {
    let tail = |p: f64| {
        let mut term = (1.0 - p).powi(of as i32);
        let mut sum = term;
        for k in 0..seen {
            term *= (of - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
            sum += term;
        }
        sum
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if tail(middle) > 0.05 { low = middle } else { high = middle }
    }
    high
}
