//! The command line itself, fuzzed: words that nobody would type, drawn from what every command says of its options, and values of
//! every wrong kind. No line may panic, hang up by a signal, or end with a status that is not documented.
//!
//! Some seconds here; `cargo xtask fuzz command-line SECONDS` for as long as wanted. `SHAKEDOWN_FUZZ_SEED` begins elsewhere.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use shakedown_tests::binary::shakedown;
use std::fs;
use std::path::Path;
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// After this a line is work and no longer parsing: it is ended and counts as passed.
const LONGEST: Duration = Duration::from_millis(1500);

/// splitmix64 (Steele, Lea, Flood 2014).
struct Dice(u64);

impl Dice {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % count as u64) as usize
    }

    fn of<'a>(&mut self, list: &[&'a str]) -> &'a str {
        list[self.below(list.len())]
    }
}

const VALUES: [&str; 62] = [
    "0",
    "1",
    "-1",
    "2",
    "7",
    "0.005",
    "-0.005",
    "1e300",
    "-1e300",
    "1e-300",
    "1e23",
    "nan",
    "inf",
    "-inf",
    "0,005",
    "1,5",
    "5,1",
    "1,2,3",
    ",",
    ".",
    "-",
    "--",
    "",
    " ",
    "%",
    "1/2",
    "3/2",
    "0/0",
    "1/0",
    "abc",
    "strong",
    "convex",
    "clip",
    "taut",
    "preview",
    "spectrum",
    "waveform",
    "g",
    "m/s2",
    "0.74g",
    "1e9g",
    "-1g",
    "g0.74",
    "ac156",
    "ieee344",
    "comma",
    "tab",
    "good.AT2",
    "run.csv",
    "experiment.toml",
    "table.toml",
    "none.csv",
    "folder",
    "folder/",
    "good.AT2/x",
    "\u{e9}\u{20ac}",
    "a\nb",
    "\u{202e}",
    "coulomb_friction",
    "18446744073709551616",
    "0x10",
    "near-field-strong",
];

/// What a command takes: its options, read off its help.
struct Spoken {
    words: Vec<String>,
    options: Vec<String>,
}

fn help(words: &[String]) -> String {
    let output = shakedown().args(words).arg("--help").output().unwrap();
    assert!(output.status.success(), "{words:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Names that stand first in the lines of a help's `Commands:`.
fn below(help: &str) -> Vec<String> {
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let names = lines.take_while(|line| line.starts_with("  ")).filter(|line| !line.starts_with("    "));
    names.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help").map(str::to_owned).collect()
}

fn spoken() -> Vec<Spoken> {
    let mut open: Vec<Vec<String>> = vec![Vec::new()];
    let mut all = Vec::new();
    while let Some(words) = open.pop() {
        let text = help(&words);
        for name in below(&text) {
            // What opens programs of the desktop, and pages that are served, is left to tests of their own.
            if !["open", "replay", "live"].contains(&name.as_str()) {
                open.push([&words[..], &[name]].concat());
            }
        }
        let starts = text.lines().filter(|line| line.trim_start().starts_with('-'));
        let options = starts.filter_map(|line| {
            let found = line.split([' ', ',', '=', '<']).find(|word| word.starts_with("--") && word.len() > 2)?;
            (found != "--help" && found != "--version").then(|| found.to_owned())
        });
        all.push(Spoken { options: options.collect(), words });
    }
    assert!(all.len() > 20, "{} commands", all.len());
    all
}

fn line(dice: &mut Dice, all: &[Spoken]) -> Vec<String> {
    let command = &all[dice.below(all.len())];
    let mut words = command.words.clone();
    for _ in 0..dice.below(5) {
        match dice.below(6) {
            0 => words.push(dice.of(&VALUES).to_owned()),
            1 => words.push(format!("--{}", dice.of(&VALUES))),
            _ if command.options.is_empty() => {}
            kind => {
                let option = command.options[dice.below(command.options.len())].clone();
                match kind {
                    2 => words.push(option),
                    3 => words.push(format!("{option}={}", dice.of(&VALUES))),
                    _ => words.extend([option, dice.of(&VALUES).to_owned()]),
                }
            }
        }
    }
    words
}

fn prepared() -> TempDir {
    let folder = TempDir::new().unwrap();
    let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let values: String = (0..200).map(|k| format!("{:.4}\n", 0.01 * f64::from(k % 7 - 3))).collect();
    let head = "PEER NGA\nSomewhere, 90\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 200, DT= .0100 SEC\n";
    put("good.AT2", &format!("{head}{values}"));
    let rows: String =
        (0..300).map(|k| format!("{:.3},{1:.4},{1:.4}\n", f64::from(k) * 0.005, f64::from(k).sin())).collect();
    put("run.csv", &format!("time [s],reference [mm],displacement [mm]\n{rows}"));
    let servo = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n";
    put("table.toml", servo);
    put(
        "experiment.toml",
        &format!(
            "{servo}[channels]\ntime = {{ column = \"time\", unit = \"s\" }}\nreference = {{ column = \"reference\", unit = \"mm\" }}\n\
             displacement = {{ column = \"displacement\", unit = \"mm\" }}\n[[runs]]\nfile = \"run.csv\"\ncontroller = {{ kp = 3.7, ki = 0.6 }}\n"
        ),
    );
    fs::create_dir(folder.path().join("folder")).unwrap();
    folder
}

/// Runs a line; none where it had to be ended.
fn run(folder: &Path, words: &[String]) -> Option<Output> {
    let mut command = shakedown();
    command.args(words).current_dir(folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let begun = Instant::now();
    // Much output would fill the pipe: who is kept waiting for that is ended like who works.
    while child.try_wait().unwrap().is_none() {
        if begun.elapsed() > LONGEST {
            child.kill().unwrap();
            child.wait().unwrap();
            return None;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    Some(child.wait_with_output().unwrap())
}

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

#[test]
fn no_line_of_words_panics() {
    let all = spoken();
    let mut dice = Dice(number("SHAKEDOWN_FUZZ_SEED", 1));
    let time = Duration::from_secs(number("SHAKEDOWN_FUZZ_SECONDS", 20));
    let (begun, mut lines, mut ended) = (Instant::now(), 0, 0);
    let mut folder = prepared();
    let mut wrong = Vec::new();
    while begun.elapsed() < time && wrong.len() < 10 {
        if lines % 500 == 499 {
            folder = prepared();
        }
        let words = line(&mut dice, &all);
        lines += 1;
        let Some(output) = run(folder.path(), &words) else {
            ended += 1;
            continue;
        };
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        if !matches!(output.status.code(), Some(0..=2)) || said.contains("panicked at") {
            wrong.push(format!("{words:?}: {}: {}", output.status, said.chars().take(300).collect::<String>()));
        }
    }
    println!("{lines} lines, {ended} of them work that was ended");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(lines > 20, "{lines} lines in {time:?}");
}
