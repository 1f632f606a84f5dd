//! The page that does the host tool's work in a browser, opened from disk as a reader opens it: what it finds is what the command
//! line finds, in the time it may take, and nothing leaves it. Minutes of work: `cargo xtask nightly` builds the page and runs it.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use serde_json::Value;
use shakedown_tests::binary::{data, shakedown};
use shakedown_tests::browser::{Browser, chromium};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// What a command says of itself, of its files and of the time it took.
const OWN: [&str; 7] = ["version", "inputs", "seconds", "out", "times_real_time", "command_line", "written"];
/// Relative difference that numbers may have.
const NEAR: f64 = 1e-9;

/// The page and a browser that shows it.
struct Shown {
    browser: Browser,
    folder: TempDir,
}

impl Shown {
    fn new() -> Option<Self> {
        let program = chromium()?;
        let page = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../hosts/shakedown.html").canonicalize();
        let page = page.expect("the page is built: cargo xtask page");
        let mut browser = Browser::start(program, 1280, 900).expect("Chromium starts");
        browser.open(&page).unwrap();
        Some(Self { browser, folder: TempDir::new().unwrap() })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs a script in the page.
    fn script(&mut self, script: &str) -> Value {
        self.browser.value(script).unwrap()
    }

    /// Sets fields of a form, without telling the page.
    fn fill(&mut self, form: &str, fields: &[(&str, &str)]) {
        for (name, value) in fields {
            self.script(&format!("document.querySelector('#{form}').{name}.value = '{value}'"));
        }
    }

    /// Drops files and waits for what comes of them.
    fn drop_files(&mut self, form: &str, files: &[&Path]) {
        // A browser says nothing where the same files are chosen again.
        self.script(&format!(
            "last.status = last.trouble = null; document.querySelector('#{form} input[type=file]').value = ''"
        ));
        self.browser.choose(&format!("#{form} input[type=file]"), files).unwrap();
    }

    /// Waits until the run is over; what the page complains of.
    fn wait(&mut self) -> Option<String> {
        let over = "new Promise((done) => { const look = setInterval(() => { \
             if (!tool.busy && (last.status !== null || last.trouble)) { clearInterval(look); done(last.trouble); } }, 5); })";
        self.script(over).as_str().map(str::to_owned)
    }

    fn json(&mut self) -> Value {
        let text = self.script("text(last.written['result.json'])");
        serde_json::from_str(text.as_str().unwrap()).unwrap()
    }

    fn seconds(&mut self) -> f64 {
        self.script("last.seconds").as_f64().unwrap()
    }

    /// The command line's JSON of the same.
    fn native(&self, line: &[&str]) -> Value {
        let output = shakedown().current_dir(self.folder.path()).args(line).args(["--json", "-"]).output().unwrap();
        assert!(output.status.success(), "{line:?}: {}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    }
}

/// A record that asks more of the table than it has.
fn record(path: &Path) {
    let mut text = String::from("time [s],acceleration [m/s2]\n");
    for k in 0..2000 {
        let t = f64::from(k) * 0.01;
        let a = 4.0 * (2.0 * std::f64::consts::PI * 0.7 * t).sin() * (-((t - 8.0) / 3.0).powi(2)).exp();
        let _ = writeln!(text, "{t:.2},{a:.6}");
    }
    std::fs::write(path, text).unwrap();
}

/// Where two results differ: names, words, numbers beyond [`NEAR`].
fn differences(place: &str, ours: &Value, theirs: &Value, found: &mut Vec<String>) {
    match (ours, theirs) {
        (Value::Object(a), Value::Object(b)) => {
            let keys: std::collections::BTreeSet<&String> = a.keys().chain(b.keys()).collect();
            for key in keys.into_iter().filter(|key| !OWN.contains(&key.as_str())) {
                let of = |map: &serde_json::Map<String, Value>| map.get(key).cloned().unwrap_or(Value::Null);
                differences(&format!("{place}.{key}"), &of(a), &of(b), found);
            }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            for (k, (a, b)) in a.iter().zip(b).enumerate() {
                differences(&format!("{place}[{k}]"), a, b, found);
            }
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            if (a - b).abs() > NEAR * a.abs().max(b.abs()) {
                found.push(format!("{place}: {a:e} in the page, {b:e} natively"));
            }
        }
        _ if ours == theirs => {}
        _ => found.push(format!("{place}: {ours} in the page, {theirs} natively")),
    }
}

fn same(what: &str, ours: &Value, theirs: &Value) {
    let mut found = Vec::new();
    differences("", ours, theirs, &mut found);
    assert!(found.is_empty(), "{what}: {} differences:\n{}", found.len(), found.join("\n"));
}

/// The comparison itself: a name, a verdict and the tenth digit of a number are found out.
#[test]
fn what_differs_is_found_out() {
    let whole = serde_json::json!({"verdict": "named", "effects": [{"id": "backlash", "value": 0.1}], "seconds": 1.0});
    let found = |from: &str, to: &str| {
        let other = serde_json::from_str(&whole.to_string().replace(from, to)).unwrap();
        let mut found = Vec::new();
        differences("", &whole, &other, &mut found);
        found.len()
    };
    assert_eq!(found("1.0", "2.0"), 0, "seconds are not compared");
    assert_eq!(found("named", "unlisted"), 1);
    assert_eq!(found("backlash", "spring"), 1);
    assert_eq!(found("0.1", "0.1000000002"), 1);
    assert_eq!(found("0.1", "0.10000000002"), 0);
    assert_eq!(found("\"value\":0.1", "\"value\":0.1,\"more\":1"), 1);
}

#[test]
#[ignore = "needs the page: cargo xtask nightly"]
fn a_record_that_is_dropped_is_fitted_as_the_command_line_fits_it() {
    let Some(mut shown) = Shown::new() else { return };
    let path = shown.path("record.csv");
    record(&path);
    for method in ["taut", "convex", "clip", "causal", "preview"] {
        shown.fill("fit", &[("method", method)]);
        shown.drop_files("fit", &[&path]);
        assert_eq!(shown.wait(), None, "{method}");
        let ours = shown.json();
        let theirs = shown.native(&["modify", "record.csv", "--method", method, "--out", "drive.csv"]);
        same(method, &ours, &theirs);
        eprintln!("modify {method}: {:.2} s", shown.seconds());
        let report = shown.script("document.querySelector('#result iframe').srcdoc.length");
        assert!(report.as_u64().unwrap() > 10_000);
    }
    let asked = shown.browser.requests();
    let inside = |address: &String| ["file://", "about:", "blob:", "data:"].iter().any(|own| address.starts_with(own));
    assert!(asked.iter().all(inside), "{asked:?}");
    assert_eq!(asked.iter().filter(|address| address.starts_with("file://")).count(), 1, "{asked:?}");
    assert_eq!(shown.browser.complaints(), [""; 0], "console");
}

#[test]
#[ignore = "needs the page: cargo xtask nightly"]
fn kobe_is_fitted_while_one_waits() {
    let Some(kobe) = data("records/RSN1106_KOBE_KJM000.AT2") else { return };
    let Some(mut shown) = Shown::new() else { return };
    // A browser may read what lies beside the page, not every path that leads elsewhere.
    let kobe = {
        let near = shown.path("RSN1106_KOBE_KJM000.AT2");
        std::fs::copy(kobe, &near).unwrap();
        near
    };
    for (method, most) in [("taut", 0.5), ("convex", 8.0)] {
        shown.fill("fit", &[("method", method)]);
        // Once to compile the program and once to be timed.
        for _ in 0..2 {
            shown.drop_files("fit", &[&kobe]);
            assert_eq!(shown.wait(), None, "{method}");
        }
        let ours = shown.json();
        let (fit, whole) = (ours["seconds"].as_f64().unwrap(), shown.seconds());
        eprintln!("Kobe by {method}: {fit:.2} s, with its indices and its report {whole:.2} s");
        assert!(whole <= most, "{method}: {whole} s, more than {most}");
        let theirs = shown.native(&["modify", kobe.to_str().unwrap(), "--method", method, "--out", "drive.csv"]);
        same(method, &ours, &theirs);
    }
}

#[test]
#[ignore = "needs the page: cargo xtask nightly"]
fn an_experiment_that_is_dropped_is_diagnosed_as_the_command_line_does() {
    use shakedown_truth::plan::{Stratum, Strength, stratum};
    let Some(mut shown) = Shown::new() else { return };
    let single = |n: &u64| matches!(stratum(1, *n), Stratum::Single(_, Strength::Gross));
    let number = (0..1000).find(single).unwrap();
    shakedown_truth::case(1, number).write(shown.folder.path()).unwrap();
    let files: Vec<PathBuf> =
        std::fs::read_dir(shown.folder.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
    let files: Vec<&Path> = files.iter().map(PathBuf::as_path).filter(|path| path.is_file()).collect();
    shown.drop_files("diagnose", &files);
    assert_eq!(shown.wait(), None);
    let seconds = shown.seconds();
    let ours = shown.json();
    eprintln!("diagnose case {number}: {seconds:.1} s, {} {}", ours["verdict"], ours["effects"][0]["id"]);
    same("diagnose", &ours, &shown.native(&["diagnose", "experiment.toml"]));
    assert!(seconds <= 60.0, "{seconds} s");
}

#[test]
#[ignore = "needs the page: cargo xtask nightly"]
fn the_loop_answers_to_the_limits_that_are_turned() {
    let Some(mut shown) = Shown::new() else { return };
    shown.script("panel('loop')");
    let mut errors = Vec::new();
    for limit in ["0.1", "0.4"] {
        shown.script("last.status = last.trouble = null");
        shown.fill("loop", &[("velocity", limit)]);
        shown.script("document.querySelector('#loop').velocity.dispatchEvent(new Event('input'))");
        assert_eq!(shown.wait(), None);
        let ours = shown.json();
        let table = shown.script("table(document.querySelector('#loop'))");
        std::fs::write(shown.path("limits.toml"), table.as_str().unwrap()).unwrap();
        let line = ["run", "--table", "limits.toml", "--controller", "strong", "--modification", "off"];
        same(limit, &ours, &shown.native(&line));
        let figures = shown.script("document.querySelectorAll('#watch svg path').length");
        assert_eq!(figures, 3, "{limit}");
        // E_a is near one at both: the slow table hardly accelerates, the faster one rings where it catches up.
        errors.push(ours["metrics"]["e_d"].as_f64().unwrap());
        eprintln!("loop at {limit} m/s: {:.2} s", shown.seconds());
    }
    assert!(errors[0] > errors[1], "a slower table follows no better: {errors:?}");
    // Every controller that the page offers is one that the program knows.
    let offered = shown.script("[...document.querySelector('#loop').controller.options].map((o) => o.value)");
    let known = shown.native(&["run", "--controller", "strong"]);
    assert!(known["metrics"]["e_a"].is_number());
    for name in offered.as_array().unwrap() {
        shown.fill("loop", &[("controller", name.as_str().unwrap())]);
        shown.script("last.status = last.trouble = null; watch(document.querySelector('#loop')); 0");
        assert_eq!(shown.wait(), None, "{name}");
    }
}

#[test]
#[ignore = "needs the page: cargo xtask nightly"]
fn nonsense_and_a_huge_file_are_refused_and_work_can_be_cancelled() {
    let Some(mut shown) = Shown::new() else { return };
    let (nonsense, huge, path) = (shown.path("nonsense.AT2"), shown.path("huge.csv"), shown.path("record.csv"));
    std::fs::write(&nonsense, [0x7f, b'E', b'L', b'F', 0, 255, 254, 13, 10].repeat(999)).unwrap();
    // Four gigabytes that take no room on the disk.
    std::fs::File::create(&huge).unwrap().set_len(4 << 30).unwrap();
    record(&path);
    for file in [&nonsense, &huge] {
        shown.drop_files("fit", &[file]);
        let said = shown.wait().unwrap_or_else(|| panic!("{}: was taken", file.display()));
        let name = file.file_name().unwrap().to_str().unwrap();
        assert!(said.contains(name), "{said}");
        eprintln!("{said}");
    }
    shown.drop_files("diagnose", &[&nonsense]);
    assert!(shown.wait().unwrap().contains("no experiment"));
    let words = shown.path("words.toml");
    std::fs::write(&words, "[[runs]]\nfile = 7\n").unwrap();
    shown.drop_files("diagnose", &[&words]);
    assert!(shown.wait().unwrap().contains("words.toml"));
    // Cancelled, and asked again at once.
    shown.fill("fit", &[("method", "convex")]);
    shown.drop_files("fit", &[&path]);
    shown.script("document.querySelector('#cancel').click()");
    assert_eq!(shown.wait().as_deref(), Some("cancelled"));
    shown.fill("fit", &[("method", "taut")]);
    shown.drop_files("fit", &[&path]);
    assert_eq!(shown.wait(), None);
    // A tab at work asks before it is closed; browsers ask only where the page was touched.
    shown.browser.mouse("mousePressed", 700.0, 20.0, 1).unwrap();
    shown.browser.mouse("mouseReleased", 700.0, 20.0, 1).unwrap();
    shown.fill("fit", &[("method", "convex")]);
    shown.drop_files("fit", &[&path]);
    assert!(shown.browser.asks_before_closing().unwrap());
    assert_eq!(shown.wait(), None, "and the work goes on");
    assert!(!shown.browser.asks_before_closing().unwrap(), "a page at rest closes");
}
