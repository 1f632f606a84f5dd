//! Inputs of other kinds: folders and empty files for files, files of another command, values with units, numbers that are none,
//! words left out, TOML that is nearly right.

use super::cases::Case;
use super::files::{CHANNELS, RUNS, SERVO, rows};
use std::fs;
use std::path::Path;

const HEADER: &str = "time [s],reference [mm],displacement [mm]\n";

fn row(k: u32) -> String {
    let t = f64::from(k) * 0.005;
    format!("{t:.3},{:.4},{:.4}", 20.0 * (3.0 * t).sin(), 19.0 * (3.0 * t - 0.2).sin())
}

/// Writes them.
pub(super) fn files(folder: &Path) {
    let text = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    fs::create_dir(folder.join("folder.toml")).unwrap();
    fs::create_dir(folder.join("folder.csv")).unwrap();
    text("o-empty.toml", "");
    text("header.csv", HEADER);
    text("backwards.csv", &(HEADER.to_owned() + &rows(600, |k| row(600 - k))));
    text(
        "stopped.csv",
        &(HEADER.to_owned() + &rows(600, |k| row(k).replacen(row(k).split(',').next().unwrap(), "0.0", 1))),
    );
    text(
        "twice.csv",
        &("time [s],reference [mm],reference [mm],displacement [mm]\n".to_owned()
            + &rows(600, |k| row(k).replacen(',', ",1,", 1))),
    );
    text("words.csv", "hello world\nnothing here counts\n");
    text("constant.txt", &"5\n".repeat(500));
    text("nan.txt", &"nan\n".repeat(500));
    text("row.csv", "time [s],acc [g]\n0,1\n");
    text("x-plain.toml", &[SERVO, CHANNELS, RUNS].concat());
    models(&text);
    runs(&text);
    scenarios(&text);
}

fn models(text: &dyn Fn(&str, &str)) {
    let model = |name: &str, from: &str, to: &str| {
        text(&format!("o-{name}.toml"), &[&SERVO.replacen(from, to, 1), CHANNELS, RUNS].concat());
    };
    model("nan", "138.0", "nan");
    model("comma", "138.0", "138,0");
    model("colon", "b0 = 138.0", "b0: 138.0");
    model("key-twice", "a1 =", "b1 = 0.7\na1 =");
    model("fit", "a1 =", "fit = [\"b2\"]\na1 =");
    model("fit-text", "a1 =", "fit = \"b0\"\na1 =");
    model("bandwidth", "a1 =", "bandwidth_hz = -5\na1 =");
    model("bandwidth-high", "a1 =", "bandwidth_hz = 1e6\na1 =");
    model("table", "[model]", "[modle]");
}

fn runs(text: &dyn Fn(&str, &str)) {
    let run = |name: &str, runs: &str| text(&format!("o-{name}.toml"), &[SERVO, CHANNELS, runs].concat());
    for file in ["folder.csv", "header.csv", "backwards.csv", "stopped.csv", "twice.csv", "words.csv", "empty.txt"] {
        run(file, &RUNS.replace("run.csv", file));
    }
    run("bracket", &RUNS.replace("[[runs]]", "[runs]"));
    run("one-run", &RUNS.replace("[[runs]]", "[[run]]"));
    run("bare", "[[runs]]\nfile = run.csv\n");
    run("negative", &RUNS.replace("3.7", "-3.7"));
    run("gain-huge", &RUNS.replace("3.7", "1e30"));
    run("gain-nan", &RUNS.replace("3.7", "nan"));
    run("from-text", &(RUNS.to_owned() + "from_s = \"a\"\n"));
    run("from-nan", &(RUNS.to_owned() + "from_s = nan\n"));
    run("rate-zero", &(RUNS.to_owned() + "controller_rate_hz = 0\n"));
    let channels = |name: &str, from: &str, to: &str| {
        text(&format!("o-{name}.toml"), &[SERVO, &CHANNELS.replacen(from, to, 1), RUNS].concat());
    };
    channels("unit-none", "\"reference\", unit = \"mm\"", "\"reference\"");
    channels("unit-kind", "\"reference\", unit = \"mm\"", "\"reference\", unit = \"g\"");
    channels("slope", "\"reference\", unit = \"mm\"", "\"reference\", unit = \"mm\", differentiate = true");
}

fn scenarios(text: &dyn Fn(&str, &str)) {
    text("o-scenario.toml", "name = \"s\"\ncontroler = \"strong\"\n");
    text("o-list.toml", "controller = [\"strong\"]\n");
    text("o-rate.toml", "name = \"s\"\nrate_hz = nan\n");
    text("o-open.toml", "[plant\n");
    text("o-bell.toml", &SERVO.replace("138.0", "138.0\u{7}"));
}

/// Each by both commands that read experiments.
pub(super) const EXPERIMENTS: [Case; 30] = [
    ("o-empty.toml", &["line 1", "`model` is missing"]),
    ("folder.toml", &["folder.toml", "it is a folder; name a file"]),
    ("o-folder.csv.toml", &["folder.csv", "it is a folder; name a file"]),
    ("o-empty.txt.toml", &["empty.txt", "is empty"]),
    ("o-header.csv.toml", &["header.csv", "no rows of numbers"]),
    ("o-words.csv.toml", &["words.csv", "no rows of numbers", "[text]"]),
    ("o-backwards.csv.toml", &["backwards.csv", "does not advance", "right column"]),
    ("o-stopped.csv.toml", &["stopped.csv", "does not advance"]),
    ("o-twice.csv.toml", &["twice.csv, line 1", "`reference`", "2 columns have this name"]),
    ("o-nan.toml", &["line 4", "is NaN"]),
    ("o-comma.toml", &["line 4", "the decimal sign is a point"]),
    ("o-colon.toml", &["line 4", "expected `=`"]),
    ("o-key-twice.toml", &["line 5", "duplicate key"]),
    ("o-fit.toml", &["line 5", "`b2`", "did you mean"]),
    ("o-fit-text.toml", &["line 5", "`model.fit`", "an array is expected"]),
    ("o-bandwidth.toml", &["line 5", "above zero"]),
    ("o-bandwidth-high.toml", &["`bandwidth_hz`", "below 100 Hz"]),
    ("o-table.toml", &["line 1", "did you mean `model`"]),
    ("o-bracket.toml", &["line 11", "[[runs]]"]),
    ("o-one-run.toml", &["line 11", "did you mean `runs`"]),
    ("o-bare.toml", &["line 12", "must be quoted"]),
    ("o-negative.toml", &["line 13", "`runs.controller.kp`", "above zero"]),
    ("o-gain-huge.toml", &["line 13", "1e30", "at most 1e9"]),
    ("o-gain-nan.toml", &["line 13", "is NaN"]),
    ("o-from-text.toml", &["line 14", "a number is expected"]),
    ("o-from-nan.toml", &["line 14", "is NaN"]),
    ("o-rate-zero.toml", &["line 14", "above zero"]),
    ("o-unit-none.toml", &["line 9", "`unit` is missing"]),
    ("o-unit-kind.toml", &["line 9", "`g` is no unit of reference"]),
    ("o-slope.toml", &["line 9", "only velocity"]),
];

/// Whole command lines.
pub(super) const COMMANDS: [Case; 53] = [
    ("run --record folder.csv", &["folder.csv", "it is a folder; name a file"]),
    ("run --record constant.txt --dt 0.01 --unit g", &["constant.txt", "every one of its 500", "ground motion"]),
    ("run --record nan.txt --dt 0.01 --unit g", &["nan.txt, line 1", "no gaps"]),
    ("run --record row.csv", &["row.csv", "1 sample(s)", "at least 16"]),
    ("run --record x-plain.toml", &["x-plain.toml", "not recognised"]),
    ("run o-scenario.toml", &["o-scenario.toml, line 2", "did you mean `controller`"]),
    ("run o-list.toml", &["o-list.toml, line 1", "is a list where"]),
    ("run o-rate.toml", &["o-rate.toml, line 2", "50 to 20000"]),
    ("run o-open.toml", &["o-open.toml, line 1", "expected `]`"]),
    ("run s-do.toml", &["s-do.toml, line 1", "each with `do`"]),
    ("run s-both.toml", &["s-both.toml", "leave one out"]),
    ("run s-rate.toml", &["s-rate.toml, line 1", "50 to 20000"]),
    ("run m-b0.toml", &["m-b0.toml, line 1", "given by --table"]),
    ("run x-plain.toml", &["x-plain.toml", "`identify` and `diagnose`"]),
    ("run good.AT2", &["good.AT2", "given by --record"]),
    ("run --table o-bell.toml", &["o-bell.toml, line 4", "not valid TOML"]),
    ("run --table folder.toml", &["folder.toml", "it is a folder; name a file"]),
    ("run --table good.AT2", &["good.AT2, line 1", "not valid TOML"]),
    ("run --table x-plain.toml", &["x-plain.toml, line 7", "`channels`"]),
    ("run --scale-to g", &["--scale-to", "such as 0.74g"]),
    ("run --scale-to nang", &["--scale-to", "positive number"]),
    ("run --controller storng", &["storng", "'strong'"]),
    ("run --controller", &["a value is required", "--controller"]),
    ("run --recrod good.AT2", &["--recrod", "--record"]),
    ("run good.AT2 plain.txt", &["plain.txt", "Usage"]),
    ("modify good.AT2 --velocity 24.2cm/s", &["--velocity 24.2cm/s", "write the number alone, 24.2"]),
    ("modify good.AT2 --stroke 120mm", &["--stroke 120mm", "write the number alone, 120"]),
    ("modify good.AT2 --method taut --out folder.csv", &["--out folder.csv", "it is a folder; name a file"]),
    ("modify x-plain.toml", &["x-plain.toml", "not recognised"]),
    ("modify", &["RECORD", "Usage"]),
    ("rum", &["rum", "'run'"]),
    ("diagnose run.csv", &["run.csv, line 1", "an experiment is TOML"]),
    ("diagnose x-plain.toml --with none.toml", &["none.toml", "no such file"]),
    ("diagnose x-plain.toml --with m-b0.toml", &["m-b0.toml, line 1", "`runs` is missing"]),
    ("diagnose x-plain.toml --next run.csv", &["--next run.csv", "name a folder"]),
    ("diagnose x-plain.toml --model folder.csv", &["--model folder.csv", "it is a folder; name a file"]),
    ("diagnose s-key.toml", &["s-key.toml, line 1", "`model` is missing"]),
    ("identify good.AT2", &["good.AT2, line 1", "an experiment is TOML"]),
    ("design good.AT2", &["good.AT2, line 1", "a model is TOML"]),
    ("design x-plain.toml", &["x-plain.toml, line 7", "`channels`"]),
    ("compare run.csv none.csv", &["none.csv", "check its name"]),
    ("compare good.AT2 x-plain.toml", &["ground-motion record", "expected two experiments"]),
    ("compare run.csv run.csv", &["name one file"]),
    ("qualify good.AT2 --standard ac156 --sds 1g", &["--sds 1g", "write the number alone, 1"]),
    ("qualify good.AT2 --standard AC156 --sds 1", &["AC156", "'ac156'"]),
    ("qualify --synthesise x.xlsx --standard ac156 --sds 1", &["x.xlsx", ".csv, .rpc"]),
    ("learn --runs 1.5", &["--runs 1.5", "whole number"]),
    ("learn --velocity -1", &["--velocity -1", "0.001 to 10 m/s"]),
    ("faults --runs 1e9", &["--runs 1e9", "in digits"]),
    ("table1 --records run.csv", &["run.csv", "expects a folder"]),
    ("device status --port run.csv", &["run.csv", "it is no serial port", "device list"]),
    ("live folder.csv", &["folder.csv", "it is a folder; name a file"]),
    ("effects coulomb_frction", &["did you mean `coulomb_friction`"]),
];
