use super::*;
use std::fs;
use tempfile::TempDir;

const CHANNELS: &str = r#"
[channels]
time = { column = "time", unit = "s" }
reference = { column = "reference", unit = "mm" }
displacement = { column = "displacement", unit = "mm", noise = 0.02 }
acceleration = { column = "acceleration", unit = "g" }
"#;

const MODEL: &str = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138\na1 = 57.65\nvelocity_limit = 0.242\n";

const RUN: &str = "[[runs]]\nfile = \"a.csv\"\ncontroller = { kp = 3.7, ki = 0.6 }\n";

fn recording(rows: usize) -> String {
    let rows = (0..rows).map(|k| format!("{},{k},{},0.5\n", k as f64 * 0.01, 2 * k));
    "time,reference [mm],displacement,acceleration\n".to_owned() + &rows.collect::<String>()
}

fn load(text: &str) -> Result<Experiment, String> {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("a.csv"), recording(60)).unwrap();
    let path = folder.path().join("e.toml");
    fs::write(&path, text).unwrap();
    let shown = folder.path().display().to_string() + "/";
    Experiment::load(&path).map_err(|e| e.to_string().replace(&shown, ""))
}

#[test]
fn channels_come_in_si_on_an_even_grid() {
    let experiment = load(&[MODEL, CHANNELS, RUN, "use = \"fit\"\n"].concat()).unwrap();
    let run = &experiment.runs[0];
    assert_eq!(run.name, "a.csv");
    assert!((run.dt - 0.01).abs() < 1e-12);
    assert_eq!(run.channel(Channel::Displacement).unwrap()[3], 6.0 * 1e-3);
    assert_eq!(run.channel(Channel::Acceleration).unwrap()[0], 0.5 * 9.806_65);
    assert_eq!(run.noise.get(Channel::Displacement), Some(&(0.02 * 1e-3)));
    assert_eq!(run.law, RecordedLaw::ProportionalIntegral { kp: 3.7, ki: 0.6 });
    assert_eq!(experiment.inputs.len(), 2);
}

#[test]
fn the_loop_may_have_seen_another_noise_than_the_file_shows() {
    let with = |from: &str, to: &str| load(&[MODEL, &CHANNELS.replace(from, to), RUN].concat());
    let noise = |to: &str| with("noise = 0.02", to).map(|experiment| experiment.runs[0].loop_noise);
    assert_eq!(noise("noise = 0.02"), Ok(None));
    assert_eq!(noise("noise = 0.02, loop_noise = 0"), Ok(Some(0.0)));
    assert_eq!(noise("noise = 0.02, loop_noise = 0.5"), Ok(Some(0.5e-3)));
    assert!(noise("loop_noise = -1").unwrap_err().contains("it must not be below zero"));
    assert!(with("unit = \"g\"", "unit = \"g\", loop_noise = 0").unwrap_err().contains("around displacement"));
}

#[test]
fn one_file_can_serve_as_two_runs_that_share_no_sample() {
    let parts = "[[runs]]\nfile = \"a.csv\"\ncontroller = { kp = 1 }\nto_s = 0.3\nuse = \"fit\"\n\
                 [[runs]]\nfile = \"a.csv\"\ncontroller = { kp = 1 }\nfrom_s = 0.3\nuse = \"holdout\"\n";
    let experiment = load(&[MODEL, CHANNELS, parts].concat()).unwrap();
    let [first, second] = experiment.runs.as_slice() else { panic!("two runs") };
    assert_eq!((first.len(), second.len()), (30, 30));
    assert_eq!((second.cut, second.purpose), (true, Use::HoldOut));
    assert_ne!(first.name, second.name);
}

#[test]
fn a_recording_does_not_judge_itself_under_another_name() {
    let of = |content: &str, uses: [&str; 2]| {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("a.csv"), recording(60)).unwrap();
        fs::write(folder.path().join("b.csv"), content).unwrap();
        let run = |file: &str, more: &str| RUN.replace("a.csv", file) + more + "\n";
        let text = [MODEL, CHANNELS, &run("a.csv", uses[0]), &run("b.csv", uses[1])].concat();
        let path = folder.path().join("e.toml");
        fs::write(&path, text).unwrap();
        let shown = folder.path().display().to_string() + "/";
        Experiment::load(&path).map(drop).map_err(|e| e.to_string().replace(&shown, ""))
    };
    let (fit, held) = ("use = \"fit\"", "use = \"holdout\"");
    let seen = Err("e.toml, line 18, `runs.file`: b.csv holds the same samples as a.csv, which is fitted above and held out here, so \
                    that it would judge itself; split it with `from_s` and `to_s`, or name another"
        .to_owned());
    let copy = recording(60);
    assert_eq!(of(&copy, [fit, held]), seen);
    // The last of several runs is held out where none says.
    assert_eq!(of(&copy, ["", ""]), seen);
    // Written anew: spaces, a part of it, other times.
    assert_eq!(of(&copy.replace(',', " , "), [fit, held]), seen);
    assert_eq!(of(&recording(40), [fit, held]), seen);
    let later = (0..60).map(|k| format!("{},{k},{},0.5\n", 7.0 + f64::from(k) * 0.01, 2 * k)).collect::<String>();
    assert_eq!(of(&("time,reference [mm],displacement,acceleration\n".to_owned() + &later), [fit, held]), seen);
    // Two that are fitted count twice, and one digit makes another recording.
    assert!(of(&copy, [fit, "use = \"fit\""]).unwrap_err().contains("is fitted above already"));
    assert_eq!(of(&copy.replace(",48,", ",48.1,"), [fit, held]), Ok(()));
    // Parts of one file may not overlap.
    let parts = "[[runs]]\nfile = \"a.csv\"\ncontroller = { kp = 1 }\nto_s = 0.4\nuse = \"fit\"\n\
                 [[runs]]\nfile = \"./a.csv\"\ncontroller = { kp = 1 }\nfrom_s = 0.2\nuse = \"holdout\"\n";
    assert!(load(&[MODEL, CHANNELS, parts].concat()).unwrap_err().contains("it would judge itself"));
}

#[test]
fn milliseconds_are_not_taken_as_seconds() {
    let folder = TempDir::new().unwrap();
    let rows = (0..60).map(|k| format!("{},{k},{},0.5\n", 10 * k, 2 * k)).collect::<String>();
    fs::write(folder.path().join("a.csv"), "time,reference [mm],displacement,acceleration\n".to_owned() + &rows)
        .unwrap();
    let path = folder.path().join("e.toml");
    fs::write(&path, [MODEL, CHANNELS, RUN].concat()).unwrap();
    let refused = Experiment::load(&path).unwrap_err().to_string();
    assert!(refused.contains("steps of 10 s are 0.1 Hz") && refused.contains("unit of the time column"), "{refused}");
}

#[test]
fn a_message_names_the_place_and_the_remedy() {
    let run = |more: &str| [MODEL, CHANNELS, RUN, more].concat();
    let model = |text: &str| [text, CHANNELS, RUN].concat();
    let channels = |from: &str, to: &str| [MODEL, &CHANNELS.replace(from, to), RUN].concat();
    let cases = [
        (run("ues = \"fit\""), "e.toml, line 16, `runs.ues`: unknown key; did you mean `use`?"),
        (
            run("use = \"holdhout\""),
            "e.toml, line 16, `runs.use`: `holdhout` is not among \"fit\", \"holdout\"; did you mean `holdout`?",
        ),
        (
            run("from_s = 0.9"),
            "e.toml, line 14, `runs.file`: 0 samples between `from_s` and `to_s` (the file runs from 0 to 0.59 s)",
        ),
        (run("from_s = 0.5\nto_s = 0.2"), "e.toml, line 17, `runs.to_s`: is 0.2; it must be after `from_s`"),
        (
            model("[model]\nkind = \"server\"\n"),
            "e.toml, line 2, `model.kind`: `server` is not among servo, rigid-mass, force-balance; did you mean `servo`?",
        ),
        (
            model("[model]\nkind = \"servo\"\nb1 = 1\nb0 = 2\n"),
            "e.toml, line 1, `model`: `a1` is missing; a servo model needs",
        ),
        (
            model("[model]\nkind = \"rigid-mass\"\nmass = -3\n"),
            "e.toml, line 3, `model.mass`: is -3; it must be above zero",
        ),
        (
            model("[model]\nkind = \"rigid-mass\"\nmass = 3\nfit = [\"a1\"]\n"),
            "e.toml, line 4, `model.fit`: `a1` is not among what this model can fit (mass, viscous, gain)",
        ),
        (
            model("[model]\nkind = \"rigid-mass\"\nmass = 3\n[effects.null_bias]\noffset = 1\n"),
            "e.toml, line 4, `effects.null_bias`: `null_bias` has parameters but is not in `effects` of [model]",
        ),
        (
            channels("unit = \"g\"", "unit = \"mm\""),
            "e.toml, line 12, `channels.acceleration.unit`: `mm` is no unit of acceleration; use one of m/s2 cm/s2 mm/s2 gal g",
        ),
        (
            channels("unit = \"g\"", "unit = \"G\""),
            "e.toml, line 12, `channels.acceleration.unit`: `G` is not among m cm mm um",
        ),
        (
            channels("reference\", unit = \"mm\"", "reference\", unit = \"m\""),
            "a.csv, line 1, `reference`: the header gives the unit [mm], the experiment `m`",
        ),
        (channels("time =", "tiem ="), "e.toml, line 9, `channels.tiem`: unknown key; did you mean `time`?"),
        (
            channels("column = \"displacement\"", "column = \"displ\""),
            "a.csv, line 1, `displ`: no column `displ`; did you mean `displacement`?; there are: time, reference, displacement, acceleration",
        ),
        ("name = \"x".to_owned(), "e.toml, line 1: not valid TOML"),
        ([MODEL, CHANNELS].concat(), "e.toml, line 1: `runs` is missing; write a [[runs]] table"),
        (
            [MODEL, CHANNELS, "[[runs]]\nfile = \"b.csv\"\ncontroller = { kp = 1 }\n"].concat(),
            "e.toml, line 14, `runs.file`: there is no file b.csv",
        ),
        ([MODEL, CHANNELS, "[[runs]]\nfile = \"a.csv\"\n"].concat(), "`command` is missing; no controller is given"),
    ];
    for (text, message) in cases {
        let error = load(&text).unwrap_err();
        assert!(error.contains(message), "\n got {error}\nwant {message}");
    }
}

#[test]
fn effects_are_checked_against_what_the_library_knows() {
    let model =
        MODEL.to_owned() + "effects = [\"null_bais\"]\nfit = [\"null_bais\"]\n[effects.null_bais]\nofset = 1e-3\n";
    let unknown = load(&[&model, CHANNELS, RUN].concat()).unwrap_err();
    assert!(unknown.contains("line 9") && unknown.contains("did you mean `null_bias`?"), "{unknown}");
    let model = model.replace("bais", "bias");
    let key = load(&[&model, CHANNELS, RUN].concat()).unwrap_err();
    assert!(key.contains("did you mean `offset`?"), "{key}");
    let model = model.replace("ofset", "offset");
    let experiment = load(&[&model, CHANNELS, RUN].concat()).unwrap();
    assert!(experiment.model.fits("null_bias.offset") && !experiment.model.fits("b0"));
    let fitted =
        load(&[&model.replace("fit = [\"null_bias\"]", "fit = [\"null_bias.ofset\"]"), CHANNELS, RUN].concat());
    assert!(fitted.unwrap_err().contains("did you mean `offset`?"));
}

#[test]
fn a_model_written_is_the_model_read() {
    let folder = TempDir::new().unwrap();
    let text = MODEL.to_owned()
        + "fit = [\"b0\"]\neffects = [\"backlash\"]\nbandwidth_hz = 40\n\
        mass = { value = 5000, std = 12.5, unit = \"kg\" }\n[effects.backlash]\ngap = { value = 2e-4, std = 1e-5, low = 1e-4, high = 3e-4 }\n";
    let path = folder.path().join("table.toml");
    fs::write(&path, text).unwrap();
    let model = Model::load(&path).unwrap();
    assert_eq!(model.accuracy["backlash.gap"].low, Some(1e-4));
    fs::write(&path, model.to_toml()).unwrap();
    let again = Model::load(&path).unwrap();
    assert_eq!((&again.baseline, &again.fit, &again.accuracy), (&model.baseline, &model.fit, &model.accuracy));
    assert_eq!(again.effects[0].parameters, model.effects[0].parameters);

    fs::write(folder.path().join("a.csv"), recording(60)).unwrap();
    let experiment = folder.path().join("e.toml");
    fs::write(&experiment, "[model]\nfile = \"table.toml\"\nfit = [\"a1\"]\n".to_owned() + CHANNELS + RUN).unwrap();
    let experiment = Experiment::load(&experiment).unwrap();
    assert_eq!(experiment.model.fit, ["a1"]);
    assert_eq!(experiment.inputs.len(), 3);
}

#[test]
fn a_time_step_may_be_stated_where_the_file_has_no_time() {
    let text = [MODEL, &CHANNELS.replace("column = \"time\", unit = \"s\"", "step = 20, unit = \"ms\""), RUN].concat();
    let experiment = load(&text).unwrap();
    assert!((experiment.runs[0].dt - 0.02).abs() < 1e-12);
}

#[test]
fn the_real_experiments_are_read() {
    let data = std::env::var("SHAKEDOWN_DATA").map_or_else(|_| "../../shared/data".into(), PathBuf::from);
    let folder = data.join("recordings/shake_table");
    if !folder.exists() {
        crate::skipped::without(&folder);
        return;
    }
    for (name, samples) in [("CHY027", 6473), ("KAU039", 6220), ("TAP089", 5766)] {
        let experiment = Experiment::load(&folder.join(format!("{name}.toml"))).unwrap();
        let [fit, holdout] = experiment.runs.as_slice() else { panic!("two runs") };
        assert!((1.0 / fit.dt - 204.8).abs() < 1e-3, "{name}: {}", 1.0 / fit.dt);
        assert!(fit.len().abs_diff(samples) <= 1, "{name}: {}", fit.len());
        assert!(holdout.cut && holdout.time[0] >= fit.time[fit.len() - 1] + 0.5 * fit.dt);
        assert!(fit.clock.gaps.is_empty() && fit.clock.doubled.is_empty());
    }
}
