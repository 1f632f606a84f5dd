//! `shakedown device` against the image, through a pseudo-terminal: what the recording says is what the device did.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU16, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::common::{bench::Bench, image, near_field, seen::Codes, setup, tool};
use rustix::fs::{OFlags, fcntl_setfl};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use shakedown::recording::{Channel, Experiment, file};
use shakedown_core::Mode;
use shakedown_core::link::{Setup, Source};
use shakedown_replay::{Tick, World};

/// Codes of the output in one step of a converter of 12 bit.
const DAC_STEP: f32 = 16.0;
/// Most that the board makes up for when it was kept from running.
const CATCH_UP: Duration = Duration::from_millis(50);

/// The board at one end of a pseudo-terminal, at the pace of the clock on the wall.
struct Wired {
    master: File,
    bench: Bench,
    codes: Vec<Codes>,
    /// Both clocks when it was up.
    start: Instant,
    begun: u64,
    over: Arc<AtomicBool>,
    /// It ticks, and has sent telemetry: what a host will ask is not the first that the emulator has to translate.
    up: Arc<AtomicBool>,
    /// The relay is closed.
    armed: Arc<AtomicBool>,
}

impl World for Wired {
    fn tick(&mut self, tick: Tick<'_>) -> bool {
        if let (Some(output), Some(last)) = (tick.output, self.codes.last_mut()) {
            (last.output, last.relay) = (output, tick.relay);
            self.bench.advance(output, tick.relay);
            self.armed.store(tick.relay, Ordering::Relaxed);
        }
        if tick.relay && self.bench.played.is_none() {
            self.bench.played = Some(0);
        }
        *tick.inputs = self.bench.codes();
        for (input, shown) in tick.inputs[1..].iter_mut().zip(&SHOWN) {
            let code = shown.load(Ordering::Relaxed);
            *input = if code == 0 { *input } else { code };
        }
        self.codes.push(Codes { inputs: *tick.inputs, output: 0, relay: false });
        let mut bytes = [0; 1024];
        if let Ok(read) = self.master.read(&mut bytes) {
            tick.line.to_device.extend(&bytes[..read]);
        }
        let sent = self.master.write(tick.line.from_device.make_contiguous()).unwrap_or(0);
        tick.line.from_device.drain(..sent);
        if self.codes.len() == 200 {
            self.up.store(true, Ordering::Relaxed);
            self.start = Instant::now();
            self.begun = tick.time;
        }
        let (device, wall) = (Duration::from_nanos(tick.time - self.begun), self.start.elapsed());
        match device.checked_sub(wall) {
            Some(ahead) => std::thread::sleep(ahead),
            // Later than this it stays late: a device that made up for it would ask more of the host than any real one.
            None if wall > device + CATCH_UP => self.start += wall.saturating_sub(device + CATCH_UP),
            None => {}
        }
        !self.over.load(Ordering::Relaxed)
    }
}

/// Codes of LVDT, accelerometer and existing command in place of the bench's, where they are not 0.
static SHOWN: [AtomicU16; 3] = [const { AtomicU16::new(0) }; 3];

/// One device at a time: the host's patience is by the clock on the wall, so the board must keep up with it.
static ALONE: Mutex<()> = Mutex::new(());

/// Runs `host` while the image runs at the other end of the port that it is given, the paper's table wired to it.
fn with_device(host: impl FnOnce(&Path)) -> Wired {
    with_bench(Bench::new(setup(Mode::Controller), Vec::new()), |port, _| host(port))
}

/// The same with that bench; `host` is told of the relay too.
fn with_bench(bench: Bench, host: impl FnOnce(&Path, &AtomicBool)) -> Wired {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    // A test that failed may have left some.
    for shown in &SHOWN {
        shown.store(0, Ordering::Relaxed);
    }
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let port = PathBuf::from(ptsname(&master, Vec::new()).unwrap().into_string().unwrap());
    fcntl_setfl(&master, OFlags::NONBLOCK).unwrap();
    let mut terminal = tcgetattr(&master).unwrap();
    terminal.make_raw();
    tcsetattr(&master, OptionalActions::Now, &terminal).unwrap();
    // Held open, so that the line does not hang up between two commands.
    let _held = File::options().read(true).write(true).open(&port).unwrap();
    let [over, up, armed] = [(); 3].map(|()| Arc::new(AtomicBool::new(false)));
    let world = Wired {
        master: File::from(master),
        bench,
        codes: Vec::new(),
        start: Instant::now(),
        begun: 0,
        over: Arc::clone(&over),
        up: Arc::clone(&up),
        armed: Arc::clone(&armed),
    };
    let device = std::thread::spawn(move || shakedown_replay::run(&image(), world).unwrap().world);
    while !up.load(Ordering::Relaxed) {
        assert!(!device.is_finished(), "the image did not run");
        std::thread::sleep(Duration::from_millis(10));
    }
    host(&port, &armed);
    over.store(true, Ordering::Relaxed);
    device.join().unwrap()
}

/// Of runs that are not about the day's proof test.
const NO_PROOF: &str = "--without-proof-test";

fn begun(words: &[&str]) -> Child {
    begun_in(Path::new("."), words)
}

fn begun_in(folder: &Path, words: &[&str]) -> Child {
    let mut command = Command::new(tool());
    command
        .args(words)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Times that a host is begun anew which gave up: its patience is by the clock on the wall, and a machine that is busy keeps
/// the emulated board from running for longer than that.
const TRIES: usize = 5;

fn gave_up(output: &Output) -> bool {
    String::from_utf8_lossy(&output.stderr).contains("does not answer")
}

/// Begins that host until it has armed the device.
fn once_armed(begin: impl Fn() -> Child, armed: &AtomicBool) -> Child {
    let mut tries = 1..=TRIES;
    loop {
        let mut child = begin();
        while child.try_wait().unwrap().is_none() {
            if armed.load(Ordering::Relaxed) {
                return child;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        let output = child.wait_with_output().unwrap();
        let again = gave_up(&output) && tries.next().is_some();
        assert!(again, "not armed: {}", String::from_utf8_lossy(&output.stderr));
    }
}

fn shakedown(words: &[&str], typed: &str) -> Output {
    let mut tries = 1..=TRIES;
    loop {
        let mut child = begun(words);
        child.stdin.take().unwrap().write_all(typed.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        if output.status.success() {
            return output;
        }
        let again = gave_up(&output) && tries.next().is_some();
        assert!(again, "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn the_recording_says_what_the_device_did() {
    let folder = tempfile::tempdir().unwrap();
    let record = near_field(3);
    let (reference, out) = (written(folder.path(), &record), folder.path().join("run"));
    let (reference, out) = (reference.to_str().unwrap(), out.to_str().unwrap());
    let world = with_device(|port| {
        let page = format!("{out}/page.html");
        shakedown(
            &["device", "--port", port.to_str().unwrap(), "run", reference, "--out", out, "--report", &page, NO_PROOF],
            "",
        );
        assert!(std::fs::read_to_string(page).unwrap().contains("displacement [mm]"));
    });

    let experiment = Experiment::load(&Path::new(out).join("experiment.toml")).unwrap();
    let run = &experiment.runs[0];
    assert!(run.channels.get(Channel::Displacement).is_some() && run.channels.get(Channel::Command).is_some());
    let wanted = ["time", "reference", "displacement", "acceleration", "command"];
    let table = file::read(&Path::new(out).join("recording.csv"), &wanted).unwrap();
    let played: Vec<f32> = table.columns[1].iter().map(|&x| x as f32).collect();
    assert_eq!(played[..record.len()], record[..], "every point, in order, once");
    // Sample for sample: the codes that stood at the converters, from the tick in which the first point was played.
    let wiring = setup(Mode::Controller).wiring;
    let rows = |place: usize| table.columns[place].iter().map(|&x| x as f32);
    let at = |start: usize| {
        let codes = world.codes.get(start..start + table.columns[0].len())?;
        let same = codes.iter().zip(rows(2)).all(|(c, x)| wiring.displacement.to_si(c.inputs[1]) == x)
            && codes.iter().zip(rows(3)).all(|(c, a)| wiring.acceleration.to_si(c.inputs[2]) == a)
            && codes
                .iter()
                .zip(rows(4))
                .all(|(c, u)| (wiring.output.to_si(c.output) - u).abs() <= 8.0 * DAC_STEP * wiring.output.per_code);
        same.then_some(start)
    };
    assert!((0..world.codes.len()).find_map(at).is_some(), "the recording is none of what the device did");
}

/// A record, fitted and written as a drive, played by the device: its telemetry says what the drive's file does.
#[test]
fn a_drive_that_was_written_is_what_the_device_plays() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let mut record = String::from("time [s],acceleration [m/s2]\n");
    for k in 0..400 {
        let t = f64::from(k) * 0.01;
        record += &format!("{t:.2},{:.6}\n", 2.0 * (7.0 * t).sin() * (-((t - 2.0) / 0.6).powi(2)).exp());
    }
    std::fs::write(at("record.csv"), record).unwrap();
    shakedown(&["modify", &at("record.csv"), "--method", "taut", "--out", &at("drive.csv")], "");
    let text = std::fs::read_to_string(at("drive.csv")).unwrap();
    let second = |line: &str| line.split_once(',').and_then(|(_, mm)| mm.parse::<f64>().ok());
    let drive: Vec<f64> =
        text.lines().filter(|line| !line.starts_with('#')).filter_map(second).map(|mm| mm * 1e-3).collect();
    let out = at("run");
    with_device(|port| {
        shakedown(&["device", "--port", port.to_str().unwrap(), "run", &at("drive.csv"), "--out", &out, NO_PROOF], "");
    });
    let table = file::read(&Path::new(&out).join("recording.csv"), &["reference"]).unwrap();
    let played = &table.columns[0];
    assert!(drive.len() > 10_000 && played.len() >= drive.len(), "{} of {}", played.len(), drive.len());
    let peak = drive.iter().fold(0.0_f64, |p, x| p.max(x.abs()));
    let worst = drive.iter().zip(played).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("drive and telemetry: {:.1e} of the peak apart at most, over {} samples", worst / peak, drive.len());
    assert!(peak > 0.01 && worst <= 1e-6 * peak, "{worst} m of {peak} m");
}

/// A file with `record`, m, at 1 kHz.
fn written(folder: &Path, record: &[f32]) -> PathBuf {
    let mut text = String::from("time [s],reference [m]\n");
    for (tick, x) in record.iter().enumerate() {
        text += &format!("{},{x}\n", tick as f64 / 1000.0);
    }
    let path = folder.join("reference.csv");
    std::fs::write(&path, text).unwrap();
    path
}

/// The setup of a device in front of the valve of an existing controller, and the file that it is written to.
fn guarding(folder: &Path) -> (Setup, PathBuf) {
    let mut guarding = setup(Mode::Guard);
    guarding.wiring.source = Source::Analog;
    let path = folder.join("guard.toml");
    std::fs::write(&path, toml::to_string(&guarding).unwrap()).unwrap();
    (guarding, path)
}

/// What was recorded of the table's displacement, m, and the longest it was from where it began.
fn recorded(out: &Path) -> (Vec<f64>, f64) {
    let table = file::read(&out.join("recording.csv"), &["displacement"]).unwrap();
    let x = table.columns[0].clone();
    let farthest = x.iter().map(|x| (x - table.columns[0][0]).abs()).fold(0.0, f64::max);
    (x, farthest)
}

/// An existing controller moves the table for as long as the device is armed; the host arms it, listens, and disarms it.
#[test]
fn a_test_of_what_stands_at_the_converter_runs_for_its_time() {
    let folder = tempfile::tempdir().unwrap();
    let ((guarding, file), out) = (guarding(folder.path()), folder.path().join("run"));
    let record: Vec<f32> = near_field(12).split_off(6000);
    let world = with_bench(Bench::new(guarding, record), |port, _| {
        let (port, file, out) = (port.to_str().unwrap(), file.to_str().unwrap(), out.to_str().unwrap());
        let begun = Instant::now();
        shakedown(&["device", "--port", port, "run", "--seconds", "2.5", "--setup", file, "--out", out, NO_PROOF], "");
        assert!(begun.elapsed() > Duration::from_millis(2500), "it was stopped before its time");
    });
    let (x, farthest) = recorded(&out);
    // A board that is emulated may fall behind the clock on the wall, and is stopped by it all the same.
    assert!((500..4000).contains(&x.len()), "{} records", x.len());
    assert!(farthest > 0.01, "the table stood: {farthest} m");
    assert!(!world.codes.iter().rev().nth(1).unwrap().relay, "it was left armed");
}

/// An interrupt stops the test, disarms and keeps what was heard: a lab that wants its table to stop gets all of that.
#[test]
fn an_interrupt_stops_a_test_and_keeps_its_telemetry() {
    let folder = tempfile::tempdir().unwrap();
    let ((guarding, file), out) = (guarding(folder.path()), folder.path().join("run"));
    let world = with_bench(Bench::new(guarding, near_field(12).split_off(6000)), |port, armed| {
        let (port, file, out) = (port.to_str().unwrap(), file.to_str().unwrap(), out.to_str().unwrap());
        let words = ["device", "--port", port, "run", "--seconds", "3600", "--setup", file, "--out", out, NO_PROOF];
        let child = once_armed(|| begun(&words), armed);
        std::thread::sleep(Duration::from_secs(1));
        let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(String::from_utf8_lossy(&output.stdout).contains("until the end was asked for"));
    });
    let (x, _) = recorded(&out);
    assert!((300..3000).contains(&x.len()), "{} records", x.len());
    assert!(!world.codes.iter().rev().nth(1).unwrap().relay, "it was left armed");
}

/// A host that is killed leaves the device as it is, under its guard, and on the disk what it had heard. The next run asks what is to
/// become of that before anything moves, and so does one that has nowhere to record.
#[test]
fn a_killed_host_leaves_the_guard_and_what_it_had_heard() {
    let folder = tempfile::tempdir().unwrap();
    let ((guarding, file), out) = (guarding(folder.path()), folder.path().join("run"));
    let part = out.join("recording.part.csv");
    let world = with_bench(Bench::new(guarding, near_field(12).split_off(6000)), |port, armed| {
        let (port, file) = (port.to_str().unwrap(), file.to_str().unwrap());
        let run = |out: &Path| {
            let out = out.to_str().unwrap();
            begun(&["device", "--port", port, "run", "--seconds", "3600", "--setup", file, "--out", out, NO_PROOF])
        };
        for place in [Path::new(file).join("run"), PathBuf::from("/dev/null/run")] {
            let output = run(&place).wait_with_output().unwrap();
            assert!(!output.status.success());
            assert!(String::from_utf8_lossy(&output.stderr).contains("cannot write"));
        }
        assert!(!armed.load(Ordering::Relaxed), "armed without a place for the recording");
        let mut child = once_armed(|| run(&out), armed);
        std::thread::sleep(Duration::from_secs(1));
        child.kill().unwrap();
        child.wait().unwrap();
        let heard = std::fs::read_to_string(&part).unwrap();
        assert!((300..3000).contains(&heard.lines().count()), "{} lines", heard.lines().count());
        let output = run(&out).wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains("recording.part.csv: was left by a run"));
        assert_eq!(std::fs::read_to_string(&part).unwrap(), heard);
        assert!(armed.load(Ordering::Relaxed), "the guard let go");
    });
    assert!(world.codes.iter().rev().nth(1).unwrap().relay, "the guard let go");
}

/// A record that the device would not play, and a test without one that it would not run: refused before anything moves.
#[test]
fn a_run_of_what_the_device_does_not_listen_to_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (_, file) = guarding(folder.path());
    let (reference, out) = (written(folder.path(), &near_field(1)), folder.path().join("run"));
    let (file, reference, out) = (file.to_str().unwrap(), reference.to_str().unwrap(), out.to_str().unwrap());
    let world = with_device(|port| {
        let run = ["device", "--port", port.to_str().unwrap(), "run", "--out", out];
        for (words, says) in [
            (&[reference, "--setup", file][..], "streamed"),
            (&["--seconds", "1"], "analog"),
            (&["--seconds", "0", "--setup", file], "--seconds"),
        ] {
            let output = begun(&[&run[..], words].concat()).wait_with_output().unwrap();
            assert_eq!(output.status.code(), Some(2), "{words:?}");
            assert!(String::from_utf8_lossy(&output.stderr).contains(says), "{words:?}");
        }
    });
    assert!(world.codes.iter().all(|codes| !codes.relay));
}

#[test]
fn the_steps_with_oil_measure_what_the_table_does() {
    let folder = tempfile::tempdir().unwrap();
    let (notes, record) = (folder.path().join("notes.toml"), written(folder.path(), &near_field(2)));
    with_device(|port| {
        let words = ["device", "--port", port.to_str().unwrap(), "commission"];
        let files = ["--out", notes.to_str().unwrap(), "--record", record.to_str().unwrap()];
        // Dry, then held, pushed, tilted, and the record at a tenth.
        let (dry, no_proof) = ("0\nyes\n\n\n\n\n\n\n\n\n0\n5\nyes\n", "yes\n");
        let typed = format!("{dry}{no_proof}{}", "yes\nyes\n\n\nyes\nstop\n");
        shakedown(&[&words[..], &files].concat(), &typed);
    });
    let notes: toml::Table = std::fs::read_to_string(&notes).unwrap().parse().unwrap();
    let number = |step: &str, key: &str| notes[step][key].as_float().unwrap();
    assert!(number("step-9", "creeps_by").abs() < 1e-4 && number("step-9", "null_bias").abs() < 1e-4);
    assert_eq!(notes["step-10"]["polarity"].as_str(), Some("right"));
    assert!((number("step-10", "moved_by") - 0.002).abs() < 2e-4);
    // 120 mm less 5 mm, less 18 mm of stopping distance at 0.242 m/s.
    assert!((number("limit-switches", "no_farther_than") - 0.097).abs() < 1e-4);
    assert_eq!(notes["step-12-tenth"]["ended"].as_str(), Some("done"));
    assert!(!notes.contains_key("step-12-third"));
}

/// A proof test whose stop does nothing is not passed, and a run asks before it begins without one; nothing moves either way.
#[test]
fn a_proof_test_that_fails_is_said_and_a_run_asks_for_one() {
    let folder = tempfile::tempdir().unwrap();
    let (reference, out) = (written(folder.path(), &near_field(1)), folder.path().join("run"));
    let world = with_bench(Bench::new(setup(Mode::Controller), Vec::new()), |port, armed| {
        let port = port.to_str().unwrap();
        let within = |words: &[&str], typed: &str| {
            let words = [&["device", "--port", port], words].concat();
            let mut child = begun_in(folder.path(), &words);
            child.stdin.take().unwrap().write_all(typed.as_bytes()).unwrap();
            child.wait_with_output().unwrap()
        };
        let run = ["run", reference.to_str().unwrap(), "--out", out.to_str().unwrap()];
        let never = within(&run, "");
        assert_eq!(never.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&never.stderr).contains("was never done here"));
        let failed = within(&["commission", "--daily"], "\n\n\n\n\n\nyes\nyes\n");
        assert_eq!(failed.status.code(), Some(1));
        assert!(String::from_utf8_lossy(&failed.stderr).contains("step 1, 3, 5;"), "{failed:?}");
        let not_passed = within(&run, "no\n");
        assert!(String::from_utf8_lossy(&not_passed.stderr).contains("was not passed"));
        // The relay opens at the end of the safe ramp, which the host does not wait for.
        let asked = Instant::now();
        while armed.load(Ordering::Relaxed) && asked.elapsed() < Duration::from_secs(5) {
            std::thread::sleep(Duration::from_millis(10));
        }
    });
    let kept: toml::Table = std::fs::read_to_string(folder.path().join("proof-test.toml")).unwrap().parse().unwrap();
    assert_eq!((kept["passed"].as_bool(), kept["step"].as_array().map(Vec::len)), (Some(false), Some(8)));
    assert!(!out.exists(), "a run began");
    assert!(world.codes.iter().any(|codes| codes.relay), "the relay was never tried");
    assert!(!world.codes.iter().rev().nth(1).unwrap().relay, "it was left armed");
}

/// An existing command that is shorted reads zero whatever its controller asks for, which the proof test finds and nothing else.
#[test]
fn a_proof_test_finds_a_command_that_is_shorted() {
    let folder = tempfile::tempdir().unwrap();
    let (guarding, file) = guarding(folder.path());
    with_bench(Bench::new(guarding, Vec::new()), |port, _| {
        let port = port.to_str().unwrap();
        shakedown(&["device", "--port", port, "set", file.to_str().unwrap()], "");
        // +2 V at 3276 codes a volt; this device's stop and switches do nothing.
        for (code, failed) in [(0, "step 1, 3, 5, 7;"), (32_768 + 6552, "step 1, 3, 5;")] {
            SHOWN[2].store(code, Ordering::Relaxed);
            let mut child = begun_in(folder.path(), &["device", "--port", port, "commission", "--daily"]);
            child.stdin.take().unwrap().write_all(b"\n\n\n\n\n\n\n\nyes\nyes\n").unwrap();
            let said = child.wait_with_output().unwrap();
            assert!(String::from_utf8_lossy(&said.stderr).contains(failed), "{said:?}");
        }
        SHOWN[2].store(0, Ordering::Relaxed);
    });
}

/// Name of an option byte, and whether it is as the board asks.
fn option(byte: &toml::Value) -> (&str, bool) {
    (byte["name"].as_str().unwrap(), byte["as_wanted"].as_bool().unwrap())
}

/// Reads what the tool says until it holds `end`.
fn until(out: &mut impl std::io::Read, end: &str) -> String {
    let (mut said, mut byte) = (String::new(), [0]);
    while !said.contains(end) {
        assert_eq!(out.read(&mut byte).unwrap(), 1, "it ended after: {said}");
        said.push(char::from(byte[0]));
    }
    said
}

/// The codes come from the image, the readings from who holds the reference; what is kept says when, by what, and the setup it makes.
#[test]
fn a_calibration_is_kept_with_its_date_and_reference() {
    let folder = tempfile::tempdir().unwrap();
    with_bench(Bench::new(setup(Mode::Controller), Vec::new()), |port, _| {
        let port = port.to_str().unwrap();
        let mut child = begun_in(folder.path(), &["device", "--port", port, "commission", "--calibrate"]);
        let (mut ask, mut out) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
        until(&mut out, "certificate?");
        writeln!(ask, "gauge blocks, 2026-118").unwrap();
        for (reading, codes) in [("-50.0", 22_000), ("0", 32_800), ("50.1", 43_600)] {
            until(&mut out, "[mm]?");
            SHOWN[0].store(codes, Ordering::Relaxed);
            writeln!(ask, "{reading}").unwrap();
        }
        let said = until(&mut out, "[m/s2]?");
        assert!(said.contains("wiring.displacement = { zero = "), "{said}");
        // The accelerometer lies still, which is no calibration; the LVDT's is kept.
        writeln!(ask, "9.81\n0\n-9.81").unwrap();
        let ended = child.wait_with_output().unwrap();
        SHOWN[0].store(0, Ordering::Relaxed);
        assert_eq!(ended.status.code(), Some(1));
        assert!(String::from_utf8_lossy(&ended.stderr).contains("the code hardly changed"), "{ended:?}");

        // The setup in force is another, and the accelerometer was never calibrated: said before the first step.
        let child = begun_in(folder.path(), &["device", "--port", port, "commission"]);
        let said = String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap();
        assert!(said.contains("displacement: the setup in force has another scale than calibration.toml"), "{said}");
        assert!(said.contains("acceleration was never calibrated here"), "{said}");
    });
    let kept: toml::Table = std::fs::read_to_string(folder.path().join("calibration.toml")).unwrap().parse().unwrap();
    let lvdt = &kept["displacement"];
    let number = |key: &str| lvdt[key].as_float().unwrap();
    // 10,800 codes on 50 mm, and a tenth of a millimetre more on the one side: 0.03 mm off a line, whose slope is the sum of products over
    // that of squares, 1,081,080 by 5010.0067 in mm.
    assert!((number("per_code") - 5.010_006_667 / 1_081_080.0).abs() < 1e-14, "{kept}");
    assert!((number("nonlinearity") - 0.1e-3 / 3.0).abs() < 2e-6, "{kept}");
    assert_eq!(lvdt["reference"].as_str(), Some("gauge blocks, 2026-118"));
    assert!(lvdt["date"].as_str().unwrap().starts_with("20") && lvdt["seconds"].as_integer().unwrap() > 1_700_000_000);
    assert!(!kept.contains_key("acceleration"));
}

#[test]
fn a_setup_comes_back_as_it_was_written_and_commissioning_records_what_it_measured() {
    let folder = tempfile::tempdir().unwrap();
    let (file, back, notes) =
        (folder.path().join("a.toml"), folder.path().join("b.toml"), folder.path().join("notes.toml"));
    let wanted = Setup { telemetry_every: 2, ..setup(Mode::Guard) };
    std::fs::write(&file, toml::to_string(&wanted).unwrap()).unwrap();
    with_device(|port| {
        let port = port.to_str().unwrap();
        shakedown(&["device", "--port", port, "set", file.to_str().unwrap()], "");
        shakedown(&["device", "--port", port, "get", "--out", back.to_str().unwrap()], "");
        let status = shakedown(&["device", "--port", port, "status", "--json", "-"], "");
        assert!(String::from_utf8_lossy(&status.stdout).contains("\"state\": \"off\""));
        let typed = "0.0\nyes\n\n\n\n\n\n\n\n\n0.001\n5.002\nyes\n";
        shakedown(&["device", "--port", port, "commission", "--out", notes.to_str().unwrap()], typed);
    });
    let read: Setup = toml::from_str(&std::fs::read_to_string(&back).unwrap()).unwrap();
    assert_eq!(read, wanted);
    let notes: toml::Table = std::fs::read_to_string(&notes).unwrap().parse().unwrap();
    assert_eq!(notes["step-3"]["displacement_code"].as_float(), Some(32768.0));
    assert_eq!(notes["step-7b"]["output_code"].as_integer(), Some(49152));
    assert_eq!(notes["step-7b"]["typed"].as_str(), Some("5.002"));
    // A chip from the factory lacks two of the option bytes that the board asks for.
    let options: Vec<(&str, bool)> = notes["option-byte"].as_array().unwrap().iter().map(option).collect();
    let kept = [("RDP", true), ("nWRP10", true), ("nWRP11", true)];
    assert_eq!(options, [&[("BOR_LEV", false), ("WDG_SW", false)][..], &kept].concat());
}
