//! Effects of a user's own: five textbook equations from `examples/effects`, each found where it is present, and what is wrong
//! with one refused at its line.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "the lint knows test functions, not helpers"
)]

#[path = "support/table.rs"]
mod table;

use shakedown::blocks::plant::{EffectParameters, entry};
use shakedown::blocks::recording::load_effects;
use shakedown::diagnose::{Options, diagnose};
use shakedown::identify::identify;
use shakedown::recording::{Experiment, Model};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use table::{HEAD, Noise, recorded};
use tempfile::TempDir;

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/effects").join(name).canonicalize().unwrap()
}

/// What each example is tried with.
const CLEAR: [(&str, &[(&str, f64)]); 5] = [
    ("quadratic_drag", &[("drag", 120.0)]),
    ("hardening_spring", &[("linear", 120.0), ("cubic", 6e4)]),
    ("cogging", &[("even", 0.8), ("odd", -1.5), ("pitch", 0.0197)]),
    ("gain_over_stroke", &[("tilt", 2.5), ("bow", -30.0)]),
    ("accelerometer_curvature", &[("curvature", 0.06)]),
];

/// An experiment on a table that has the effect; `model` is what follows the paper's four numbers.
fn experiment(folder: &TempDir, id: &str, truth: &[(&str, f64)], model: &str) -> Experiment {
    load_effects(&example(&format!("{id}.toml"))).unwrap();
    let known = entry(id).unwrap();
    let value = |key: &str| truth.iter().find(|(name, _)| *name == key).unwrap().1;
    let parameters = known.parameters.iter().map(|p| value(p.key)).collect();
    let effects = [EffectParameters { id: known.id, parameters }];
    let mut text = format!("effect_files = ['{}']\n", example(&format!("{id}.toml")).display());
    text += "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n";
    text += model;
    text += HEAD;
    for (seed, purpose) in [(1, "fit"), (2, "fit"), (3, "holdout")] {
        fs::write(folder.path().join(format!("{seed}.csv")), recorded(138.0, &effects, seed)).unwrap();
        let _ = write!(
            text,
            "[[runs]]\nfile = \"{seed}.csv\"\ncontroller = {{ kp = 3.7, ki = 0.6 }}\nuse = \"{purpose}\"\n"
        );
    }
    let path = folder.path().join("e.toml");
    fs::write(&path, text).unwrap();
    Experiment::load(&path).unwrap()
}

#[test]
fn a_stated_effect_is_fitted_to_its_true_values() {
    for (id, truth) in CLEAR {
        let folder = TempDir::new().unwrap();
        let model = format!("effects = [{id:?}]\nfit = [{id:?}]\n");
        let experiment = experiment(&folder, id, truth, &model);
        let found = identify(&experiment).unwrap();
        for (key, value) in truth {
            let q = &found.quantities[&format!("{id}.{key}")];
            println!("{id}.{key}: {:.5} {} of {value}", q.value, q.unit);
            assert!((q.value / value - 1.0).abs() < 0.05, "{id}.{key}");
        }
        // The file that `run` and `diagnose` take carries the equation along.
        let table = folder.path().join("table.toml");
        fs::write(&table, found.model(&experiment.model).to_toml()).unwrap();
        let again = Model::load(&table).unwrap();
        assert_eq!(again.effects[0].id, id);
        shakedown::simulate::Twin::of(&again).unwrap();
    }
}

#[test]
fn an_effect_that_is_missing_is_found_among_the_librarys() {
    for (id, truth) in CLEAR {
        let folder = TempDir::new().unwrap();
        let diagnosis = diagnose(&experiment(&folder, id, truth, ""), &Options::default()).unwrap().diagnosis;
        let named: Vec<&str> = diagnosis.effects.iter().map(|e| e.id).collect();
        println!("{id}: {:?} {named:?}", diagnosis.verdict);
        assert_eq!(named, [id]);
    }
}

/// Each refusal names the line and what to do.
#[test]
fn what_is_wrong_is_said_by_line() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("own.toml");
    let said = |place: &str, states: &str, expression: &str, unit: &str, range: &str| {
        let text = format!(
            "[[effect]]\nid = \"wrong_one\"\nplace = \"{place}\"\nstates = [{states}]\nexpression = \"{expression}\"\n\
             parameters.p = {{ unit = \"{unit}\", {range} }}\n"
        );
        fs::write(&path, text).unwrap();
        let (entries, errors) = match load_effects(&path) {
            Ok(both) => both,
            Err(error) => (Vec::new(), vec![error]),
        };
        assert!(entries.is_empty(), "{expression} was taken");
        errors[0].to_string()
    };
    let range = "low = 0.0, high = 1.0, start = 0.5";
    for (place, states, expression, unit, range, line, word) in [
        ("table", "\"velocity\"", "p*velocity", "N", range, 5, "m2 kg/s3"),
        ("table", "\"velocity\"", "p*velocity + 1", "1/s", range, 5, "has no unit"),
        ("table", "\"velocity\"", "p*exp(velocity)", "N", range, 5, "divide by a parameter"),
        ("table", "\"velocity\"", "p*velocty", "1/s", range, 5, "did you mean `velocity`"),
        ("table", "\"velocity\"", "p*-velocity", "1/s", range, 5, "two ways"),
        ("table", "\"velocity\"", "p*(velocity", "1/s", range, 5, "parentheses"),
        ("table", "\"velocity\"", "p*velocity*", "1/s", range, 5, "operator"),
        ("table", "\"velocity\"", "p*velocity/0", "1/s", range, 5, "not finite"),
        ("table", "\"velocity\"", "p*sqrt(velocity)^2", "1/s", range, 5, "not finite"),
        ("table", "\"velocity\"", "foo(velocity)*p", "1/s", range, 5, "no function"),
        ("table", "\"velocity\"", "", "1/s", range, 5, "is empty"),
        ("table", "\"speed\"", "p*speed", "1/s", range, 4, "no state"),
        ("table", "\"acceleration\"", "p*acceleration", "1", range, 4, "cannot be had"),
        ("tabel", "\"velocity\"", "p*velocity", "1/s", range, 3, "did you mean `table`"),
        ("table", "\"velocity\"", "p*velocity", "lbf", range, 6, "no SI unit"),
        ("table", "\"velocity\"", "p*velocity", "1/s", "low = 1.0, high = 0.0, start = 0.5", 6, "is not below"),
        ("table", "\"velocity\"", "p*velocity", "1/s", "low = 0.0, high = 1.0, start = 2.0", 6, "`start`"),
        ("table", "\"velocity\"", "p*velocity", "1/s", "low = 0.0, high = nan, start = 2.0", 6, "finite"),
    ] {
        let message = said(place, states, expression, unit, range);
        println!("{message}");
        assert!(message.contains(&format!("line {line},")) && message.contains(word), "{expression}: {message}");
    }
}

/// What a user may type at all: nothing of it ends the process.
#[test]
fn nonsense_is_refused_and_never_worse() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("own.toml");
    let mut noise = Noise(5);
    let pieces = [
        "p", "velocity", "(", ")", "*", "+", "-", "^", "/", "1", "2.5e3", ".", ",", "exp", "max", "sign(", "e", " ",
        "%", "[", "{", "}",
    ];
    for _ in 0..3000 {
        let count = 1 + (noise.next(1.0).abs() * 8.0) as usize;
        let any = |noise: &mut Noise| pieces[(noise.next(1.0).abs() * 1e6) as usize % pieces.len()];
        let expression: String = (0..count).map(|_| any(&mut noise)).collect();
        let text = format!(
            "[[effect]]\nid = \"any\"\nplace = \"table\"\nstates = [\"velocity\"]\nexpression = '{expression}'\n\
             parameters.p = {{ unit = \"1/s\", low = 0.0, high = 1.0, start = 0.5 }}\n"
        );
        fs::write(&path, text).unwrap();
        let _ = load_effects(&path);
    }
}
