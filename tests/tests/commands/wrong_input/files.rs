//! The files that the cases name, each wrong in one way.

use std::fs;
use tempfile::TempDir;

pub(super) const SERVO: &str = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n";
pub(super) const CHANNELS: &str = "[channels]\ntime = { column = \"time\", unit = \"s\" }\nreference = { column = \"reference\", unit = \"mm\" }\n\
    displacement = { column = \"displacement\", unit = \"mm\" }\n";
pub(super) const RUNS: &str = "[[runs]]\nfile = \"run.csv\"\ncontroller = { kp = 3.7, ki = 0.6 }\n";

pub(super) fn rows(count: u32, of: impl Fn(u32) -> String) -> String {
    (0..count).map(|k| of(k) + "\n").collect()
}

/// A folder with every file that the cases name.
pub(super) fn folder() -> TempDir {
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
    super::odd::files(folder.path());
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
