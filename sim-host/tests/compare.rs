//! What changed between two dates, and what did not. Prints the figures it asserts; `PAIRS=300` makes more pairs, `SEED=2000` others:
//! `PAIRS=300 SEED=2000 cargo test --release -p shakedown --test compare -- --nocapture`.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "the lint knows test functions, not helpers")]

#[path = "support/table.rs"]
mod table;

use shakedown::blocks::plant::EffectParameters;
use shakedown::identify::{Change, compare};
use shakedown::recording::Experiment;
use std::fmt::Write as _;
use std::fs;
use table::{HEAD, recorded};
use tempfile::TempDir;

/// A table on one date.
#[derive(Clone, Copy)]
struct Table {
    b0: f64,
    null: f64,
    friction: f64,
    frequency: f64,
}

const BEFORE: Table = Table { b0: 138.0, null: 2e-4, friction: 0.25, frequency: 3.0 };

fn experiment(folder: &TempDir, name: &str, table: Table, seed: u64) -> Experiment {
    let placed = |id, parameters: &[f64]| EffectParameters { id, parameters: parameters.to_vec() };
    let effects = [
        placed("null_bias", &[table.null, 0.0]),
        placed("coulomb_friction", &[table.friction, 2e-5]),
        placed("payload_resonance", &[0.3, table.frequency, 0.03, 0.0]),
    ];
    let mut text = String::from(
        "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n\
         effects = [\"null_bias\", \"coulomb_friction\", \"payload_resonance\"]\n\
         fit = [\"b0\", \"null_bias\", \"coulomb_friction.force\", \"payload_resonance\"]\n\
         [effects.null_bias]\noffset = 1e-4\n[effects.coulomb_friction]\nforce = 0.2\npresliding = 2e-5\n\
         [effects.payload_resonance]\nmass_ratio = 0.3\nfrequency = 3.0\ndamping = 0.03\n",
    );
    text += HEAD;
    for run in 0..2 {
        let file = format!("{name}{run}.csv");
        fs::write(folder.path().join(&file), recorded(table.b0, &effects, seed * 2 + run)).unwrap();
        let _ = write!(text, "[[runs]]\nfile = {file:?}\ncontroller = {{ kp = 3.7, ki = 0.6 }}\nuse = \"fit\"\n");
    }
    let path = folder.path().join(format!("{name}.toml"));
    fs::write(&path, text).unwrap();
    Experiment::load(&path).unwrap()
}

fn pair(after: Table, seed: u64) -> Vec<Change> {
    let folder = TempDir::new().unwrap();
    let experiments = [experiment(&folder, "a", BEFORE, seed), experiment(&folder, "b", after, seed + 50_000)];
    compare(&experiments[0], &experiments[1]).unwrap()
}

fn pairs() -> u64 {
    number("PAIRS", 4)
}

/// The first pair's seed.
fn seed() -> u64 {
    number("SEED", 1)
}

fn number(name: &str, usual: u64) -> u64 {
    std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(usual)
}

#[test]
fn what_changed_is_found_and_the_rest_is_not() {
    let after =
        Table { b0: 1.05 * BEFORE.b0, friction: 1.2 * BEFORE.friction, frequency: 1.02 * BEFORE.frequency, ..BEFORE };
    let truth = [
        ("b0", after.b0 - BEFORE.b0),
        ("coulomb_friction.force", after.friction - BEFORE.friction),
        ("payload_resonance.frequency", after.frequency - BEFORE.frequency),
        ("null_bias.offset", 0.0),
    ];
    let (mut found, mut held, mut wrong) = ([0; 4], [0; 4], 0);
    for seed in seed()..seed() + pairs() {
        let changes = pair(after, seed);
        for (i, (name, difference)) in truth.iter().enumerate() {
            let change = changes.iter().find(|c| c.name == *name).unwrap();
            found[i] += u64::from(change.changed == Some(true));
            let within = |low, high| low <= *difference && *difference <= high;
            held[i] += u64::from(change.low.zip(change.high).is_some_and(|(low, high)| within(low, high)));
            if change.changed.is_none() {
                println!("{change:?}");
            }
        }
        wrong +=
            changes.iter().filter(|c| !truth[..3].iter().any(|t| t.0 == c.name) && c.changed == Some(true)).count();
    }
    for (i, (name, _)) in truth.iter().enumerate() {
        println!("{name}: reported changed in {} of {}, 90 % interval right in {}", found[i], pairs(), held[i]);
    }
    println!("numbers that did not change and were reported: {wrong}");
    assert!(found[..3].iter().all(|n| *n == pairs()), "{found:?}");
    assert!(wrong as u64 * 20 <= pairs(), "{wrong}");
    assert!(pairs() < 50 || held.iter().all(|n| (0.85..=0.95).contains(&(*n as f64 / pairs() as f64))), "{held:?}");
}

#[test]
fn nothing_changed_and_nothing_is_reported() {
    let reported = (1000 + seed()..1000 + seed() + pairs())
        .filter(|seed| pair(BEFORE, *seed).iter().any(|c| c.changed == Some(true)))
        .count();
    println!("pairs of the same table: {reported} of {} report a change", pairs());
    assert!(reported as u64 * 100 <= pairs(), "{reported}");
}
