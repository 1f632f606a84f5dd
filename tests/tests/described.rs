//! A table described once, and qualification from the command line.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use serde_json::Value;
use shakedown_tests::binary::shakedown;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const TABLE: &str = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.2\n\
    [table]\nstroke = 0.08\ncontroller = \"strong\"\ndrive_unit = \"V\"\nvolts_per_metre = 100.0\nvalve_unit = \"mA\"\nvalve_full = 20.0\n";

fn run(folder: &Path, line: &str) -> (Option<i32>, String) {
    let output = shakedown().current_dir(folder).args(line.split(' ')).output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

fn json(folder: &Path, name: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join(name)).unwrap()).unwrap()
}

#[test]
fn a_table_described_once_gives_every_limit() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("table.toml"), TABLE).unwrap();
    let (status, said) = run(folder.path(), "modify near-field-moderate --method causal --out d.csv --json m.json");
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("table.toml of this folder describes the table: stroke 0.08 m, controller strong"), "{said}");
    let fitted = json(folder.path(), "m.json");
    assert_eq!((fitted["limits"]["velocity"].as_f64(), fitted["limits"]["stroke"].as_f64()), (Some(0.2), Some(0.08)));
    assert_eq!(fitted["drive"]["unit"].as_str(), Some("V"));
    assert!(fitted["indices"]["waveform"].as_f64().is_some());
    let (status, said) = run(folder.path(), "run --record d.csv --json r.json --report r.html");
    assert_eq!(status, Some(0), "{said}");
    let result = json(folder.path(), "r.json");
    assert_eq!(result["controller"].as_str(), Some("strong"));
    let page = fs::read_to_string(folder.path().join("r.html")).unwrap();
    assert!(page.contains("\"unit\":\"mA\"") && page.contains("Valve, 20 mA fully open"));
    // What is given on the command line overrides it.
    let (_, _) =
        run(folder.path(), "modify near-field-moderate --method causal --stroke 0.1 --velocity 0.15 --json o.json");
    let own = json(folder.path(), "o.json");
    assert_eq!((own["limits"]["velocity"].as_f64(), own["limits"]["stroke"].as_f64()), (Some(0.15), Some(0.1)));
}

#[test]
fn a_model_beside_no_description_is_not_taken() {
    let folder = TempDir::new().unwrap();
    let model = TABLE.split("[table]").next().unwrap();
    fs::write(folder.path().join("table.toml"), model).unwrap();
    let (status, said) = run(folder.path(), "run --json r.json");
    assert_eq!(status, Some(0), "{said}");
    assert!(!said.contains("table.toml"), "{said}");
    let result = json(folder.path(), "r.json");
    assert!(result["conditioning"].as_str().unwrap().starts_with("specimen: "), "{result}");
    for key in ["waveform", "spectrum", "peak", "delay_s", "gain", "coherence"] {
        assert!(result["indices"][key].as_f64().is_some(), "{key}");
    }
}

#[test]
fn init_leaves_a_table_to_describe() {
    let folder = TempDir::new().unwrap();
    assert_eq!(run(folder.path(), "sweep --write recordings").0, Some(0));
    let (status, said) = run(folder.path(), "init recordings --out first.toml");
    assert_eq!(status, Some(0), "{said}");
    let text = fs::read_to_string(folder.path().join("recordings/table.toml")).unwrap();
    assert!(text.contains("NOT yours") && text.contains("# stroke = "), "{text}");
    fs::write(folder.path().join("recordings/table.toml"), "mine").unwrap();
    assert_eq!(run(folder.path(), "init recordings --out first.toml --force").0, Some(0));
    assert_eq!(fs::read_to_string(folder.path().join("recordings/table.toml")).unwrap(), "mine");
}

#[test]
fn a_synthetic_motion_qualifies_with_its_margin_and_a_weaker_one_does_not() {
    let folder = TempDir::new().unwrap();
    let made = "qualify --synthesise x.csv --standard ac156 --sds 1.0 --z-over-h 0 --margin 1.1 --json made.json";
    let (status, said) = run(folder.path(), made);
    assert_eq!(status, Some(0), "{said}");
    assert!((json(folder.path(), "made.json")["margin"].as_f64().unwrap() - 1.1).abs() < 1e-9);
    // Read back from its file.
    let (status, said) =
        run(folder.path(), "qualify x.csv --standard ac156 --sds 1.0 --z-over-h 0 --json q.json --report q.html");
    assert_eq!(status, Some(0), "{said}");
    let found = json(folder.path(), "q.json");
    assert!((found["margin"].as_f64().unwrap() - 1.1).abs() < 1e-6, "{}", found["margin"]);
    assert_eq!(found["complies"].as_bool(), Some(true));
    let page = fs::read_to_string(folder.path().join("q.html")).unwrap();
    assert!(page.contains("no certificate") && page.contains("not checked against the text"));
    let (status, said) = run(folder.path(), "qualify x.csv --standard ac156 --sds 1.2 --z-over-h 0");
    assert_eq!(status, Some(1));
    assert!(said.contains("does not satisfy") && said.contains("envelope"), "{said}");
}

#[test]
fn a_shell_gets_completions_and_man_gets_pages() {
    let folder = TempDir::new().unwrap();
    for shell in ["bash", "zsh", "fish"] {
        let output = shakedown().args(["completions", shell]).output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success() && text.contains("qualify") && text.contains("z-over-h"), "{shell}");
    }
    let (status, said) = run(folder.path(), "man pages");
    assert_eq!(status, Some(0), "{said}");
    let page = fs::read_to_string(folder.path().join("pages/shakedown-run.1")).unwrap();
    assert!(page.contains("closed") && page.contains("conditioning"));
    let (status, said) = run(folder.path(), "open none.html");
    assert_eq!(status, Some(2));
    assert!(said.contains("none.html"), "{said}");
    assert_eq!(run(folder.path(), "completions tcsh").0, Some(2));
}

/// A near-field record has room to be learnt: no run is refused, none passes a limit, and the error falls.
#[test]
fn a_near_field_record_is_learnt_within_the_limits() {
    let folder = TempDir::new().unwrap();
    let (status, said) = run(folder.path(), "learn --runs 3 --json l.json");
    assert_eq!(status, Some(0), "{said}");
    let learnt = json(folder.path(), "l.json");
    let runs = learnt["runs"].as_array().unwrap();
    assert!(learnt["refused"].is_null() && runs.len() == 3, "{}", learnt["refused"]);
    for run in runs {
        let peak = |key: &str| run["peaks"][key].as_f64().unwrap();
        assert!(peak("velocity") <= 0.242 && peak("displacement") <= 0.12, "{run}");
    }
    let e_a = |k: usize| runs[k]["e_a"].as_f64().unwrap();
    assert!(e_a(2) < 0.5 * e_a(0), "{} {}", e_a(0), e_a(2));
}
