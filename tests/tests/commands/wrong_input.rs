//! Wrong input, a line a case over all commands: exit status 2, one short message that names the option or the file, the place
//! and the remedy, in plain words; nothing printed as a result and nothing left behind.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use shakedown_tests::binary::shakedown;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// The longest message that is read by anybody, bytes.
const LONGEST: usize = 2500;

/// Words of the parser and of the solver, which tell a person nothing.
const JARGON: [&str; 8] = [
    "invalid float literal",
    "invalid digit found",
    "target type",
    "18446744073709551615.",
    "InsufficientProgress",
    "os error",
    "panicked",
    "to pass '-",
];

const SERVO: &str = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n";
const CHANNELS: &str = "[channels]\ntime = { column = \"time\", unit = \"s\" }\nreference = { column = \"reference\", unit = \"mm\" }\n\
    displacement = { column = \"displacement\", unit = \"mm\" }\n";
const RUNS: &str = "[[runs]]\nfile = \"run.csv\"\ncontroller = { kp = 3.7, ki = 0.6 }\n";

fn rows(count: u32, of: impl Fn(u32) -> String) -> String {
    (0..count).map(|k| of(k) + "\n").collect()
}

/// A folder with every file that the cases name.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let put = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    let text = |name: &str, text: &str| put(name, text.as_bytes());
    let wave = |k: u32| f64::from(k % 7) - 3.0;
    let at2 = |count: u32, dt: &str, values: &str| {
        format!(
            "PEER NGA\nSomewhere, 90\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= {count}, DT= {dt} SEC\n{values}"
        )
    };
    let good = rows(200, |k| format!("{:.4}", 0.01 * wave(k)));
    text("good.AT2", &at2(200, ".0100", &good));
    text("short.AT2", &at2(2, ".0100", "0.1 -0.1\n"));
    text("zero.AT2", &at2(200, ".0100", &rows(200, |_| "0".into())));
    text("tiny.AT2", &at2(200, "1e-9", &good));
    text("count.AT2", &at2(201, ".0100", &good));
    text("gap.AT2", &at2(200, ".0100", &good.replacen("-0.0300", "NaN", 1)));
    text("velocity.AT2", &at2(200, ".0100", &good).replace("ACCELERATION", "VELOCITY"));
    text("zeros.txt", &rows(200, |_| "0.0".into()));
    text("huge.txt", &rows(200, |k| if k == 3 { "1e300".into() } else { "0.1".into() }));
    text("plain.txt", &good);
    text("comma.txt", &good.replace('.', ","));
    text("two.csv", &format!("time,acc\n{}", rows(200, |k| format!("0,{k:03},{},5", k % 3))));
    text(
        "ms.csv",
        &format!("time [ms],acc [g]\n{}", rows(200, |k| format!("{:.3},{}", f64::from(k) * 0.005, wave(k)))),
    );
    text("slow.csv", &format!("time [s],acc [g]\n{}", rows(200, |k| format!("{},{}", k * 5, wave(k)))));
    text("years.csv", &format!("time [year],acc [g]\n{}", rows(200, |k| format!("{k},{}", wave(k)))));
    text(
        "speed.csv",
        &format!("time [s],vel [m/s]\n{}", rows(200, |k| format!("{},{}", f64::from(k) * 0.01, wave(k)))),
    );
    text(
        "jump.csv",
        &format!("time [s],acc [g]\n{}0.5,1\n", rows(20, |k| format!("{},{}", f64::from(k) * 0.01, wave(k)))),
    );
    text(
        "ragged.csv",
        &format!("time [s],acc [g]\n{}0.2,1,2\n", rows(20, |k| format!("{},{}", f64::from(k) * 0.01, wave(k)))),
    );
    text(
        "word.csv",
        &format!("time [s],acc [g]\n{}0.2,lots\n", rows(20, |k| format!("{},{}", f64::from(k) * 0.01, wave(k)))),
    );
    text("three.csv", &format!("time [s],x [g],y [g]\n{}", rows(20, |k| format!("{},1,2", f64::from(k) * 0.01))));
    text("wide.txt", &(vec!["1.5"; 400_000].join(" ") + "\n").repeat(2));
    let utf16: Vec<u8> = "0.1\n".repeat(99).encode_utf16().flat_map(u16::to_le_bytes).collect();
    put("utf16.txt", &utf16);
    put(
        "utf16.toml",
        &[&[0xff, 0xfe][..], &SERVO.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>()].concat(),
    );
    text("letter.txt", "Dear Sir,\nplease find attached\n");
    put("program", b"\x7fELF\x02\x01\x01\0\0\x01\x02\x03\x04\x05\x06\x07");
    text("empty.txt", "");
    text(
        "drive.csv",
        "# shakedown drive 1\n# quantity = displacement\n# unit = mm\n# unit_in_si = 0.001\n# dt_s = 0.005\n\
        time [s],displacement [mm]\n0,0\n0.005,1\n0.010,0\n",
    );
    text(
        "broken-drive.csv",
        "# shakedown drive 1\n# quantity = displacement\n# unit = mm\n# unit_in_si = 1\n# dt_s = 0.001\n\
        time [s],displacement [mm]\n0,0\n0.001,1\n",
    );
    text("file", "");
    for (name, stated) in [
        ("t-stroke", "stroke = 120"),
        ("t-key", "storke = 0.1"),
        ("t-valve", "valve_unit = \"A\""),
        ("t-controller", "controller = \"fast\""),
    ] {
        text(&format!("{name}.toml"), &format!("{SERVO}[table]\n{stated}\n"));
    }
    text("rrs-falls.csv", "1,0.5\n0.5,1\n");
    text("rrs-word.csv", "1,0.5\n2,lots\n");
    recordings(&text, &put);
    models(&text);
    scenarios(&text);
    folder
}

fn recordings(text: &dyn Fn(&str, &str), put: &dyn Fn(&str, &[u8])) {
    let row = |k: u32| {
        let t = f64::from(k) * 0.005;
        format!("{t:.3},{:.4},{:.4}", 20.0 * (3.0 * t).sin(), 19.0 * (3.0 * t - 0.2).sin())
    };
    let header = "time [s],reference [mm],displacement [mm]\n";
    let good = header.to_owned() + &rows(600, row);
    text("run.csv", &good);
    text("copy.csv", &good);
    text("inf.csv", &good.replacen("0.500,", "0.500,inf,", 1).replacen("0.500,inf,19.9499,", "0.500,inf,", 1));
    text("spike.csv", &(good.clone() + "3.000,1e300,0\n"));
    text("cut.csv", &(good.clone() + "3.000,1\n"));
    text("few.csv", &(header.to_owned() + &rows(5, row)));
    text("twenty.csv", &(header.to_owned() + &rows(20, row)));
    text("nameless.csv", &rows(600, row));
    let with = |of: &dyn Fn(u32, &str) -> String| {
        let line = |k: u32| of(k, &row(k));
        header.to_owned() + &rows(600, line)
    };
    let cells = |row: &str| row.split(',').map(str::to_owned).collect::<Vec<_>>();
    text("still.csv", &with(&|_, row| format!("{},0,0", cells(row)[0])));
    text("blind.csv", &with(&|_, row| format!("{},{},NaN", cells(row)[0], cells(row)[1])));
    let hole = |from: u32, to: u32| {
        with(&move |k, row| {
            let cells: Vec<&str> = row.split(',').collect();
            if (from..to).contains(&k) { format!("{},NaN,NaN", cells[0]) } else { row.to_owned() }
        })
    };
    text("hole.csv", &hole(200, 260));
    text("gap19.csv", &hole(200, 219));
    put("unmarked.csv", &good.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>());
    put("broken.tdms", b"TDSm\x0e\0\0\0");
    put("broken.rpc", b"FORMAT\0\0\0\0");
    put("broken.h5", b"\x89HDF\r\n\x1a\nnothing");
    put("broken.mat", b"MATLAB 7.3 MAT-file, and then nothing");
    let runs = |file: &str| RUNS.replace("run.csv", file);
    let whole = |model: &str, channels: &str, runs: &str| [model, channels, runs].concat();
    for name in [
        "inf.csv",
        "spike.csv",
        "cut.csv",
        "few.csv",
        "twenty.csv",
        "still.csv",
        "blind.csv",
        "hole.csv",
        "gap19.csv",
        "nameless.csv",
        "unmarked.csv",
        "broken.tdms",
        "broken.rpc",
        "broken.h5",
        "broken.mat",
        "none.csv",
    ] {
        text(&format!("x-{name}.toml"), &whole(SERVO, CHANNELS, &runs(name)));
    }
    text("x-typo.toml", &whole(&SERVO.replace("b0 =", "bo ="), CHANNELS, RUNS));
    text("x-kind.toml", &whole(&SERVO.replace("servo", "servos"), CHANNELS, RUNS));
    text("x-nokind.toml", &whole("[model]\nb0 = 1.0\n", CHANNELS, RUNS));
    text("x-channel.toml", &whole(SERVO, &CHANNELS.replace("displacement =", "dispalcement ="), RUNS));
    text("x-column.toml", &whole(SERVO, &CHANNELS.replace("\"displacement\"", "\"displ\""), RUNS));
    text("x-shared.toml", &whole(SERVO, &CHANNELS.replace("\"displacement\"", "\"reference\""), RUNS));
    text(
        "x-unit.toml",
        &whole(SERVO, &CHANNELS.replace("\"displacement\", unit = \"mm\"", "\"displacement\", unit = \"m\""), RUNS),
    );
    text("x-unknown-unit.toml", &whole(SERVO, &CHANNELS.replace("unit = \"mm\"", "unit = \"furlong\""), RUNS));
    text(
        "x-noise.toml",
        &whole(
            SERVO,
            &CHANNELS.replace("\"displacement\", unit = \"mm\"", "\"displacement\", unit = \"mm\", noise = 1e-300"),
            RUNS,
        ),
    );
    text(
        "x-negative-noise.toml",
        &whole(
            SERVO,
            &CHANNELS.replace("\"displacement\", unit = \"mm\"", "\"displacement\", unit = \"mm\", noise = -1"),
            RUNS,
        ),
    );
    text("x-notime.toml", &whole(SERVO, &CHANNELS.replace("time = { column = \"time\", unit = \"s\" }\n", ""), RUNS));
    text("x-use.toml", &whole(SERVO, CHANNELS, &(RUNS.to_owned() + "use = \"hold\"\n")));
    text("x-both.toml", &whole(SERVO, CHANNELS, &format!("{RUNS}use = \"fit\"\n{RUNS}use = \"holdout\"\n")));
    let copied = format!("{RUNS}use = \"fit\"\n{}use = \"holdout\"\n", RUNS.replace("run.csv", "copy.csv"));
    text("x-copy.toml", &whole(SERVO, CHANNELS, &copied));
    text("x-window.toml", &whole(SERVO, CHANNELS, &(RUNS.to_owned() + "from_s = 2.0\nto_s = 1.0\n")));
    text("x-outside.toml", &whole(SERVO, CHANNELS, &(RUNS.to_owned() + "from_s = 200.0\n")));
    text("x-gains.toml", &whole(SERVO, CHANNELS, &RUNS.replace("kp = 3.7", "kpp = 3.7")));
    text("x-noruns.toml", &whole(SERVO, CHANNELS, ""));
    text("x-nochannels.toml", &whole(SERVO, "", RUNS));
    text("x-text.toml", &(whole(SERVO, CHANNELS, RUNS) + "[text]\ndecimal = \"dot\"\n"));
    text("x-open.toml", &whole(SERVO, CHANNELS, "[[runs]]\nfile = \"run.csv\"\n"));
    text("x-syntax.toml", "name = \"x\n");
    text("x-utf8.toml", "# \u{0}\n");
}

fn models(text: &dyn Fn(&str, &str)) {
    let model = |name: &str, from: &str, to: &str| text(&format!("m-{name}.toml"), &SERVO.replace(from, to));
    model("b0", "138.0", "-100.0");
    model("b0-huge", "138.0", "1e300");
    model("a1-huge", "57.65", "1e300");
    model("a1-negative", "57.65", "-1.0");
    model("limit", "0.242", "1e-12");
    model("limit-negative", "0.242", "-0.2");
    model("text", "138.0", "\"much\"");
    let effect = |name: &str, id: &str, parameters: &str| {
        text(&format!("m-{name}.toml"), &format!("{SERVO}effects = [\"{id}\"]\n[effects.{id}]\n{parameters}\n"));
    };
    effect("frequency", "payload_resonance", "mass_ratio = 0.5\nfrequency = 0\ndamping = 0.02");
    effect("mass-ratio", "payload_resonance", "mass_ratio = 1e9\nfrequency = 5.0\ndamping = 0.02");
    effect("delay", "command_delay", "time = 100.0");
    effect("negative", "leakage", "coefficient = -1.0");
    effect("key", "command_delay", "tiem = 0.01");
    text("m-effect.toml", &format!("{SERVO}effects = [\"coulomb\"]\n"));
    text("m-twice.toml", &format!("{SERVO}effects = [\"leakage\", \"leakage\"]\n"));
    text("m-unlisted.toml", &format!("{SERVO}[effects.leakage]\ncoefficient = 0.01\n"));
    text("m-rigid.toml", "[model]\nkind = \"rigid-mass\"\nmass = 95.0\n");
    text("m-rigid-zero.toml", "[model]\nkind = \"rigid-mass\"\nmass = 0.0\n");
    text("m-incomplete.toml", &format!("{SERVO}effects = [\"coulomb_friction\"]\n"));
}

fn scenarios(text: &dyn Fn(&str, &str)) {
    text("s-key.toml", "controller = \"strong\"\nvelocity = 1\n");
    text("s-controller.toml", "name = \"a test\"\ncontroller = \"fast\"\n");
    text("s-record.toml", "controller = \"strong\"\n[record]\nfile = \"nope.AT2\"\n");
    text("s-step.toml", "name = \"s\"\n[sensors]\ndisplacement_step = -4e-5\n");
    text("s-huge-step.toml", "[sensors]\ndisplacement_step = 1e300\n");
    text("s-noise.toml", "[sensors]\nacceleration_noise = nan\n");
    text("s-steps.toml", "steps = 3\n");
    text("s-rate.toml", "rate_hz = 1.0\n");
    text("s-plant.toml", "[plant]\na1 = -1.0\n");
    text("s-fit.toml", "fit = \"cut\"\n");
    text("s-both.toml", "controller = \"strong\"\nsettings = \"a.toml\"\n");
    text("s-scale.toml", "conditioning = [{ do = \"scale\", factor = 1e300 }]\n");
    text("s-do.toml", "conditioning = [{ do = \"sclae\", factor = 1.0 }]\n");
    text("s-table.toml", "table = \"m-b0.toml\"\n");
}

/// A command line and what its message must hold.
type Case = (&'static str, &'static [&'static str]);

/// Values of options.
const OPTIONS: [Case; 58] = [
    ("run --record plain.txt --unit g --dt -0.005", &["sampling interval", "-0.005"]),
    ("run --record plain.txt --unit g --dt 0,005", &["--dt 0,005", "write 0.005"]),
    ("run --record plain.txt --unit g --dt abc", &["--dt abc", "expected a number"]),
    ("run --record plain.txt --unit g --dt 1e-12", &["sampling interval", "1.0000e-12"]),
    ("run --record plain.txt --unit g --dt 0", &["sampling interval is 0"]),
    ("run --record plain.txt --unit g --dt inf", &["sampling interval is inf"]),
    ("run --record plain.txt --unit furlong --dt 0.01", &["`furlong`", "expected m/s2"]),
    ("run --record plain.txt --dt 0.01", &["--unit"]),
    ("run --record plain.txt --unit g", &["--dt"]),
    ("run --seed -1", &["--seed -1", "not negative"]),
    ("run --seed abc", &["--seed abc", "whole number"]),
    ("run --seed 1e23", &["--seed 1e23", "whole number"]),
    ("run --seed 99999999999999999999999", &["--seed", "at most"]),
    ("run --seed 3 --record good.AT2", &["--seed", "--record"]),
    ("run --dt 0.01", &["--dt", "--record"]),
    ("run --decimal comma", &["--decimal", "--record"]),
    ("run --record good.AT2 --decimal comma", &["PEER AT2", "--decimal"]),
    ("run --record good.AT2 --channel 7", &["good.AT2", "no channel `7`"]),
    ("run --record three.csv --channel z", &["no channel `z`", "x", "y"]),
    ("run --record three.csv", &["several columns", "--channel"]),
    ("run --scale-to -1g", &["--scale-to", "-1g", "positive"]),
    ("run --scale-to 1e9g", &["--scale-to", "1e9g", "at most"]),
    ("run --scale-to 0.74", &["--scale-to", "no unit"]),
    ("run --scale-to 0.74lb", &["--scale-to", "lb"]),
    ("run --controller fast", &["fast"]),
    ("run --fit cut", &["cut"]),
    ("modify good.AT2 --trim -1,5", &["--trim -1,5", "0 to 1.990 s"]),
    ("modify good.AT2 --trim 1,0.5", &["--trim 1,0.5", "FROM below TO"]),
    ("modify good.AT2 --trim 100,200", &["--trim 100,200", "1.990 s"]),
    ("modify good.AT2 --trim 1", &["--trim", "two numbers"]),
    ("modify good.AT2 --seed 4", &["--seed", "leave it out"]),
    ("modify near-field-strong --unit g", &["--unit", "generated"]),
    ("modify near-field-strong --channel 2", &["--channel", "generated"]),
    ("modify near-field-huge", &["near-field-huge", "near-field-strong", "far-field"]),
    ("modify good.AT2 --stroke 1e-9", &["--stroke 1e-9", "0.0001 to 5 m"]),
    ("modify good.AT2 --stroke 120", &["--stroke 120", "did you mean 0.12 m?"]),
    ("modify good.AT2 --velocity 242", &["--velocity 242", "did you mean 0.242 m/s?"]),
    ("modify good.AT2 --velocity 0", &["--velocity 0", "expected"]),
    ("modify good.AT2 --velocity -0.2", &["--velocity -0.2", "expected"]),
    ("modify good.AT2 --velocity nan", &["--velocity NaN", "expected"]),
    ("modify good.AT2 --preview 1e9", &["--preview 1e9", "60 s"]),
    ("modify good.AT2 --preview 0.5 --method clip", &["--preview", "leave one of them out"]),
    ("modify good.AT2 --band 0.1,0.5", &["--band", "--objective spectrum"]),
    ("modify good.AT2 --jerk 5 --method taut", &["--jerk", "--method convex"]),
    ("modify good.AT2 --method quick", &["quick"]),
    ("modify good.AT2 --target -1 --method clip", &["--target -1", "above zero"]),
    ("modify good.AT2 --out drive.mat", &["drive.mat", ".csv, .rpc"]),
    ("modify good.AT2 --out drive", &["no extension", ".csv, .rpc"]),
    ("modify good.AT2 --out drive.AT2 --drive displacement", &["--drive displacement", ".AT2 holds acceleration"]),
    ("modify good.AT2 --out drive.AT2 --drive-unit mm", &["--drive-unit mm", "in g"]),
    ("modify good.AT2 --out drive.csv --drive-unit V", &["--drive-unit V", "--volts-per-metre"]),
    ("modify good.AT2 --out drive.csv --drive-unit furlong", &["furlong", "expected m, cm, mm"]),
    ("modify good.AT2 --out drive.csv --volts-per-metre 80", &["--volts-per-metre", "drive in V"]),
    ("modify good.AT2 --out drive.csv --rate 1e9", &["--rate 1e9", "expected"]),
    ("modify good.AT2 --rate 100", &["--out"]),
    ("modify good.AT2 --out good.AT2", &["name one file"]),
    ("learn --runs 0", &["--runs 0", "1 to 50"]),
    ("learn --velocity 242", &["--velocity 242", "expected"]),
];

/// A described table and qualification.
const TABLES: [Case; 19] = [
    ("run --table t-stroke.toml", &["t-stroke.toml, line 8", "`table.stroke`", "0.0001 to 5 m"]),
    ("modify good.AT2 --table t-stroke.toml", &["t-stroke.toml, line 8", "`table.stroke`"]),
    ("learn --table t-key.toml", &["t-key.toml, line 8", "did you mean `stroke`"]),
    ("run --table t-valve.toml", &["t-valve.toml, line 8", "V, mA, %"]),
    ("run --table t-controller.toml", &["`fast`", "current strong"]),
    ("learn --table t-controller.toml", &["fast", "current strong"]),
    ("device status", &["--port", "device list"]),
    ("device --port none status", &["none", "device list"]),
    ("qualify good.AT2", &["--standard"]),
    ("qualify good.AT2 --standard ac157", &["ac157", "ac156"]),
    ("qualify good.AT2 --standard ac156", &["--sds", "design spectral acceleration"]),
    ("qualify good.AT2 --standard ac156 --sds -1", &["--sds -1", "expected"]),
    ("qualify good.AT2 --standard ac156 --sds 1 --level high", &["--level", "leave it out"]),
    ("qualify good.AT2 --standard ieee344", &["--rrs", "frequency [Hz]"]),
    ("qualify good.AT2 --standard ieee344 --rrs rrs-falls.csv", &["rrs-falls.csv", "line 2", "does not rise"]),
    ("qualify good.AT2 --standard ieee344 --rrs rrs-word.csv", &["rrs-word.csv", "line 2", "lots"]),
    ("qualify good.AT2 --standard ac156 --sds 1", &["good.AT2", "100 Hz", "33.3 Hz"]),
    ("qualify none.AT2 --standard ac156 --sds 1", &["none.AT2", "no such file"]),
    ("qualify --standard ac156 --sds 1", &["RECORD"]),
];

/// Options of the other commands.
const OTHERS: [Case; 36] = [
    ("sweep --flow=-1", &["--flow -1", "expected"]),
    ("sweep slew-rate --flow -1", &["--flow -1", "expected"]),
    ("sweep --area 0", &["--area 0", "expected"]),
    ("sweep slew-rate --drop-ratio 0", &["--drop-ratio 0", "expected"]),
    ("sweep bode --gains -1,0", &["--gains -1,0", "not stable"]),
    ("sweep bode --gains 1,1e9", &["--gains", "not stable"]),
    ("sweep bode --gains 3.7", &["Kp,Ki"]),
    ("sweep bode --record good.AT2", &["--record", "trade-off"]),
    ("sweep bode --seed 3", &["--seed", "trade-off"]),
    ("sweep bode --step 0", &["--step"]),
    ("sweep bode --amplitudes 0", &["--amplitudes"]),
    ("sweep bode --to 1e9", &["--to"]),
    ("sweep everything", &["everything"]),
    ("faults --runs 0", &["--runs 0", "at least 1"]),
    ("faults --runs -5", &["--runs -5", "expected"]),
    ("faults --out file --runs 1", &["--out file", "name a folder"]),
    ("faults --records none --runs 1", &["none"]),
    ("faults --class no-such --runs 1", &["no-such"]),
    ("faults --shard 3/2 --out f --runs 1", &["3/2"]),
    ("prove --cases 0", &["--cases 0", "1 to"]),
    ("prove --cases many", &["--cases many", "whole number"]),
    ("prove --out file --cases 1", &["--out file", "name a folder"]),
    ("prove merge none", &["none"]),
    ("prove --examiner 3", &["--examiner", "3"]),
    ("prove --stratum odd --cases 1", &["--stratum 'odd'", "null", "single, gross"]),
    ("prove --kind odd --cases 1", &["no case"]),
    ("prove --examiner 1 --kind spring --cases 1", &["--kind", "examiner 2"]),
    ("prove --examinee no-such-program --cases 1", &["--examinee", "no-such-program"]),
    ("design m-rigid.toml", &["m-rigid.toml", "servo"]),
    ("design m-b0.toml --spread -1", &["--spread -1", "0 to 0.95"]),
    ("design m-b0.toml --rate 1", &["--rate 1", "200"]),
    ("design none.toml", &["none.toml"]),
    ("effects coulomb", &["did you mean `coulomb_friction`"]),
    ("effects nothing-like-it", &["no effect is called"]),
    ("table1 --records none", &["none"]),
    ("init none", &["none", "name a folder"]),
];

/// The bench watched live, and figures.
const LIVE: [Case; 15] = [
    ("live --seconds 0", &["--seconds 0", "expected 0.1"]),
    ("live --seconds nan", &["--seconds NaN", "expected"]),
    ("live --listen 99999", &["--listen", "99999"]),
    ("live --speed 2", &["--recording"]),
    ("live --run 2", &["--recording"]),
    ("live none.csv", &["none.csv", "no such file", "name"]),
    ("live three.csv", &["three.csv", "reference"]),
    ("live --port none", &["none", "device list"]),
    ("live run.csv --port none", &["--out DIR", "recorded"]),
    ("live --port none --for 0", &["--for 0", "expected"]),
    ("live --table m-b0.toml", &["m-b0.toml", "above zero"]),
    ("live --table m-rigid.toml", &["m-rigid.toml", "servo"]),
    ("live --recording none.toml", &["none.toml", "no such file", "name"]),
    ("live --recording x-typo.toml", &["line 4", "did you mean `b0`"]),
    ("effects leakage --figures file", &["--figures", "name a folder"]),
];

/// Files of records.
const RECORDS: [Case; 24] = [
    ("run --record none.AT2", &["none.AT2", "no such file"]),
    ("run --record short.AT2", &["short.AT2", "2 sample(s)", "at least 16"]),
    ("run --record zero.AT2", &["zero.AT2", "is zero"]),
    ("run --record zeros.txt --dt 0.01 --unit g", &["zeros.txt", "is zero"]),
    ("run --record tiny.AT2", &["tiny.AT2", "line 4", "sampling interval"]),
    ("run --record count.AT2", &["count.AT2", "NPTS = 201", "200 values"]),
    ("run --record gap.AT2", &["gap.AT2", "line 5", "not finite"]),
    ("run --record velocity.AT2", &["velocity.AT2", "VELOCITY"]),
    ("run --record huge.txt --dt 0.01 --unit g", &["huge.txt, line 4:", "9.8066e300"]),
    ("run --record comma.txt --dt 0.01 --unit g", &["comma.txt", "2 ways", "--decimal"]),
    ("run --record two.csv --unit g", &["two.csv", "names 2 columns", "decimal comma"]),
    ("run --record ms.csv", &["ms.csv", "Hz", "correct the unit"]),
    ("run --record slow.csv", &["slow.csv", "Hz", "correct the unit"]),
    ("run --record years.csv", &["years.csv", "`year`", "s or ms"]),
    ("run --record speed.csv", &["speed.csv", "`m/s`"]),
    ("run --record jump.csv", &["jump.csv", "line 22", "resample"]),
    ("run --record ragged.csv", &["ragged.csv", "line 22", "3"]),
    ("run --record word.csv", &["word.csv", "line 22", "`lots`"]),
    ("run --record wide.txt --dt 0.01 --unit g", &["wide.txt", "400000 in all", "--channel"]),
    ("run --record utf16.txt --dt 0.01 --unit g", &["utf16.txt", "UTF-16", "save it as UTF-8"]),
    ("run --record letter.txt", &["letter.txt", "not recognised"]),
    ("run --record program", &["program", "not text"]),
    ("run --record empty.txt", &["empty.txt", "empty"]),
    ("table1 --records .", &["KJM000"]),
];

/// Drives, models and scenarios.
const MODELS: [Case; 36] = [
    ("run --record drive.csv", &["drive.csv", "200.000 Hz", "--rate 1000"]),
    ("run --record drive.csv --fit convex", &["drive.csv", "leave --fit out"]),
    ("run --record drive.csv --scale-to 0.5g", &["drive.csv", "leave --scale-to out"]),
    ("run --record drive.csv --conditioning plain", &["drive.csv", "leave --conditioning out"]),
    ("run --record broken-drive.csv", &["broken-drive.csv", "one mm is 0.001"]),
    ("modify drive.csv", &["drive.csv", "is a drive"]),
    ("run --table m-b0.toml", &["m-b0.toml", "line 4", "`model.b0`", "above zero"]),
    ("run --table m-b0-huge.toml", &["m-b0-huge.toml", "line 4", "1e300"]),
    ("run --table m-a1-huge.toml", &["m-a1-huge.toml", "line 5", "1e300"]),
    ("run --table m-a1-negative.toml", &["m-a1-negative.toml", "line 5"]),
    ("run --table m-limit.toml", &["m-limit.toml", "line 6", "1e-12"]),
    ("run --table m-limit-negative.toml", &["m-limit-negative.toml", "line 6"]),
    ("run --table m-text.toml", &["m-text.toml", "line 4", "a number"]),
    ("run --table m-frequency.toml", &["m-frequency.toml", "payload_resonance.frequency", "above zero"]),
    ("run --table m-mass-ratio.toml", &["m-mass-ratio.toml", "payload_resonance.mass_ratio", "1e9"]),
    ("run --table m-delay.toml", &["m-delay.toml", "command_delay.time", "far beyond"]),
    ("run --table m-negative.toml", &["m-negative.toml", "leakage.coefficient", "cannot be negative"]),
    ("run --table m-key.toml", &["m-key.toml", "tiem", "did you mean `time`"]),
    ("run --table m-effect.toml", &["m-effect.toml", "did you mean `coulomb_friction`"]),
    ("run --table m-twice.toml", &["m-twice.toml", "listed twice"]),
    ("run --table m-unlisted.toml", &["m-unlisted.toml", "not in `effects`"]),
    ("run --table m-rigid-zero.toml", &["m-rigid-zero.toml", "line 3", "above zero"]),
    ("run --table m-rigid.toml", &["m-rigid.toml", "servo"]),
    ("run --table m-incomplete.toml", &["m-incomplete.toml", "coulomb_friction", "missing"]),
    ("run --table utf16.toml", &["utf16.toml", "UTF-16", "UTF-8"]),
    ("run s-key.toml", &["s-key.toml, line 2", "`velocity`"]),
    ("run s-controller.toml", &["s-controller.toml, line 2", "`fast`"]),
    ("run s-record.toml", &["nope.AT2", "s-record.toml, line 3"]),
    ("run s-step.toml", &["s-step.toml, line 3", "displacement_step"]),
    ("run s-huge-step.toml", &["s-huge-step.toml, line 2", "displacement_step", "1e300"]),
    ("run s-noise.toml", &["s-noise.toml, line 2", "acceleration_noise"]),
    ("run s-steps.toml", &["s-steps.toml, line 1", "even"]),
    ("run s-plant.toml", &["s-plant.toml, line 2", "a1"]),
    ("run s-fit.toml", &["s-fit.toml, line 1", "clip"]),
    ("run s-scale.toml", &["step 1"]),
    ("run s-table.toml", &["m-b0.toml", "above zero"]),
];

/// Experiments and recordings, each by both commands that read them.
const EXPERIMENTS: [Case; 33] = [
    ("x-inf.csv.toml", &["inf.csv", "infinite", "NaN"]),
    ("x-spike.csv.toml", &["spike.csv", "line 602", "1e300"]),
    ("x-cut.csv.toml", &["cut.csv", "line 602", "2 fields"]),
    ("x-few.csv.toml", &["few.csv", "5 samples"]),
    ("x-blind.csv.toml", &["blind.csv", "displacement", "column"]),
    ("x-nameless.csv.toml", &["nameless.csv", "line 1", "header"]),
    ("x-unmarked.csv.toml", &["unmarked.csv", "UTF-16", "UTF-8"]),
    ("x-broken.tdms.toml", &["broken.tdms", "cut off"]),
    ("x-broken.rpc.toml", &["broken.rpc", "cut off"]),
    ("x-broken.h5.toml", &["broken.h5", "HDF5"]),
    ("x-broken.mat.toml", &["broken.mat", "HDF5"]),
    ("x-none.csv.toml", &["line 12", "no file none.csv"]),
    ("x-typo.toml", &["line 4", "bo", "did you mean `b0`"]),
    ("x-kind.toml", &["line 2", "did you mean `servo`"]),
    ("x-nokind.toml", &["line 1", "`kind` is missing"]),
    ("x-channel.toml", &["dispalcement", "did you mean `displacement`"]),
    ("x-column.toml", &["run.csv", "did you mean `displacement`"]),
    ("x-shared.toml", &["channels.displacement", "takes the column of reference"]),
    ("x-unit.toml", &["run.csv", "[mm]", "`m`"]),
    ("x-unknown-unit.toml", &["`furlong`", "line"]),
    ("x-noise.toml", &["noise", "1e-300"]),
    ("x-negative-noise.toml", &["noise", "above zero"]),
    ("x-notime.toml", &["`time` is missing"]),
    ("x-use.toml", &["`hold`", "line"]),
    ("x-both.toml", &["held out here", "from_s"]),
    ("x-copy.toml", &["line 16", "copy.csv holds the same samples as run.csv", "from_s"]),
    ("x-window.toml", &["after `from_s`"]),
    ("x-outside.toml", &["the file runs from"]),
    ("x-gains.toml", &["kp", "line"]),
    ("x-noruns.toml", &["`runs` is missing"]),
    ("x-nochannels.toml", &["`channels` is missing"]),
    ("x-text.toml", &["`dot`", "point or comma"]),
    ("x-open.toml", &["`command` is missing"]),
];

/// Recordings that can be read and not believed: what the findings must hold, and what they must not claim beside it.
const UNFIT: [(&str, &[&str], &[&str]); 3] = [
    ("x-twenty.csv.toml", &["twenty.csv", "too short", "at least 100"], &["swapped"]),
    ("x-still.csv.toml", &["still.csv", "nothing moves", "name a recording"], &["swapped"]),
    ("x-hole.csv.toml", &["hole.csv", "60 samples (0.300 s)", "up to 0.15 s", "from_s"], &["swapped"]),
];

fn listing(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// What is wrong with how a command line was refused.
fn faults(folder: &Path, line: &str, parts: &[&str], before: &[String]) -> Vec<String> {
    let mut arguments: Vec<&str> = line.split(' ').collect();
    if !matches!(arguments[0], "prove") && !line.starts_with("init") {
        arguments.extend(["--json", "out.json", "--report", "out.html"]);
    }
    let output = shakedown().current_dir(folder).args(arguments).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    let mut wrong = Vec::new();
    if output.status.code() != Some(2) {
        wrong.push(format!("status {:?}", output.status.code()));
    }
    if !output.stdout.is_empty() {
        wrong.push("printed a result".to_owned());
    }
    if message.matches("error: ").count() != 1 {
        wrong.push("not one message".to_owned());
    }
    if message.len() > LONGEST {
        wrong.push(format!("a message of {} bytes", message.len()));
    }
    wrong.extend(JARGON.iter().filter(|word| message.contains(*word)).map(|word| format!("says `{word}`")));
    wrong.extend(parts.iter().filter(|part| !message.contains(*part)).map(|part| format!("does not say `{part}`")));
    if listing(folder) != before {
        wrong.push("left something behind".to_owned());
    }
    let short: String = message.chars().take(400).collect();
    if wrong.is_empty() { wrong } else { vec![format!("{line}: {}\n    {short}", wrong.join(", "))] }
}

#[test]
fn every_wrong_input_is_refused_with_file_place_and_remedy() {
    let folder = folder();
    let before = listing(folder.path());
    let plain = [&OPTIONS[..], &TABLES, &OTHERS, &LIVE, &RECORDS, &MODELS].concat();
    let read = ["identify", "diagnose"]
        .into_iter()
        .flat_map(|command| EXPERIMENTS.iter().map(move |(file, parts)| (format!("{command} {file}"), *parts)));
    let cases: Vec<(String, &[&str])> =
        plain.iter().map(|(line, parts)| ((*line).to_owned(), *parts)).chain(read).collect();
    assert!(cases.len() >= 150, "{} cases", cases.len());
    let wrong: Vec<String> =
        cases.iter().flat_map(|(line, parts)| faults(folder.path(), line, parts, &before)).collect();
    assert!(wrong.is_empty(), "{} of {} cases:\n{}", wrong.len(), cases.len(), wrong.join("\n"));
}

/// What can be read but not believed is a verdict and no error; a short gap is bridged.
#[test]
fn recordings_that_cannot_be_believed_are_a_verdict() {
    let folder = folder();
    let diagnosed = |file: &str| {
        let output = shakedown().current_dir(folder.path()).args(["diagnose", file, "--json", "-"]).output().unwrap();
        assert!(output.status.success(), "{file}: {}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()
    };
    for (file, said, unsaid) in UNFIT {
        let found = diagnosed(file);
        let findings = found["findings"].to_string();
        assert_eq!(found["verdict"], "bad-data", "{file}: {findings}");
        assert!(said.iter().all(|part| findings.contains(part)), "{file}: {findings}");
        assert!(!unsaid.iter().any(|part| findings.contains(part)), "{file}: {findings}");
        // No figure of a fit to them is given either.
        let output = shakedown().current_dir(folder.path()).args(["identify", file]).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{file}: {message}");
        assert!(said.iter().all(|part| message.contains(part)), "{file}: {message}");
    }
    assert_ne!(diagnosed("x-gap19.csv.toml")["verdict"], "bad-data");
}

/// A folder that is made is said to be.
#[test]
fn a_folder_that_a_result_makes_is_said() {
    let folder = TempDir::new().unwrap();
    let line = ["effects", "leakage", "--json", "new/deep/x.json"];
    let output = shakedown().current_dir(folder.path()).args(line).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && message.contains("new/deep: there is no such folder; it is made"), "{message}");
    assert!(folder.path().join("new/deep/x.json").exists());
    let again = shakedown().current_dir(folder.path()).args(line).output().unwrap();
    assert!(again.stderr.is_empty(), "{}", String::from_utf8_lossy(&again.stderr));
}
