//! A `shakedown live` under test, a client that states what headers it likes, and a twin at the end of a pseudo-terminal.

use rustix::fs::{OFlags, fcntl_setfl};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use serde_json::Value;
use shakedown::blocks::device::Line as _;
use shakedown::blocks::live::SoftDevice;
use shakedown::simulate::Twin;
use shakedown_tests::binary::shakedown;
use std::fs::File;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Waits until something holds.
pub(crate) fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !holds() {
        assert!(begun.elapsed() < Duration::from_mins(1), "waited a minute for {what}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// A reference of `seconds` at 1 kHz: 10 mm of sines that start and end at rest, within the paper's table.
pub(crate) fn reference(path: &Path, seconds: usize) {
    let mut text = String::from("time [s],reference [m]\n");
    for k in 0..seconds * 1000 {
        let t = k as f64 / 1000.0;
        let window = (t / 2.0).min((seconds as f64 - t) / 2.0).clamp(0.0, 1.0);
        let x = window * (0.008 * (6.0 * t).sin() + 0.002 * (31.0 * t).sin());
        text += &format!("{t:.3},{x:.7}\n");
    }
    std::fs::write(path, text).unwrap();
}

/// One request with these headers; status, and the whole answer.
pub(crate) fn http(host: &str, method: &str, path: &str, headers: &str, body: &str) -> (u16, String) {
    let mut stream = TcpStream::connect(host).unwrap();
    let length = body.len();
    let request =
        format!("{method} {path} HTTP/1.1\r\n{headers}Connection: close\r\nContent-Length: {length}\r\n\r\n{body}");
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    let answer = String::from_utf8_lossy(&answer).into_owned();
    (answer.split(' ').nth(1).unwrap_or_default().parse().unwrap_or(0), answer)
}

/// The program at work.
pub(crate) struct Live {
    process: Child,
    pub(crate) address: String,
    summary: PathBuf,
}

impl Live {
    /// Starts it in `folder` and waits for its address.
    pub(crate) fn start(folder: &Path, arguments: &[&str]) -> Self {
        let summary = folder.join("live.json");
        let mut command = shakedown();
        command.current_dir(folder).arg("live").args(arguments).args(["--json", "live.json"]);
        let mut process = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(process.stderr.take().unwrap()).lines();
        let address = loop {
            let line = lines.next().expect("it ended before it said its address").unwrap();
            if let Some(address) = line.strip_prefix("live at ") {
                break address.to_owned();
            }
        };
        std::thread::spawn(move || lines.for_each(drop));
        Self { process, address, summary }
    }

    pub(crate) fn host(&self) -> String {
        self.address.split('/').nth(2).unwrap().to_owned()
    }

    pub(crate) fn token(&self) -> String {
        self.address.split('/').nth(3).unwrap().to_owned()
    }

    fn own(&self) -> String {
        format!("Host: {0}\r\nOrigin: http://{0}\r\n", self.host())
    }

    /// Sends an order as the page does; the status it comes to.
    pub(crate) fn order(&self, body: &str) -> u16 {
        http(&self.host(), "POST", &format!("/{}/order", self.token()), &self.own(), body).0
    }

    /// Arms, confirms and starts as the page does.
    pub(crate) fn armed_and_started(&self) {
        let path = format!("/{}/order", self.token());
        let (status, answer) = http(&self.host(), "POST", &path, &self.own(), "{\"order\":\"arm\"}");
        assert_eq!(status, 200, "{answer}");
        let body = answer.rsplit("\r\n\r\n").next().unwrap();
        let number = serde_json::from_str::<Value>(body.trim()).unwrap()["confirm"].as_u64().unwrap();
        assert_eq!(self.order(&format!("{{\"order\":\"confirm\",\"number\":{number}}}")), 200);
        until("armed", || self.status()["phase"] == "armed");
        assert_eq!(self.order("{\"order\":\"start\"}"), 200);
        until("running", || self.status()["phase"] == "running");
    }

    /// What the newest frame says of the bench.
    pub(crate) fn status(&self) -> Value {
        let mut stream = TcpStream::connect(self.host()).unwrap();
        let path = format!("/{}/frames", self.token());
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {}\r\n\r\n", self.host()).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        let begun = Instant::now();
        let mut newest = Value::Null;
        // Frames that were kept come at once; the first that takes its time is the newest.
        for line in BufReader::new(stream).lines() {
            let line = line.unwrap_or_default();
            if let Some(data) = line.strip_prefix("data: ") {
                newest = serde_json::from_str(data).unwrap();
                if begun.elapsed() > Duration::from_millis(200) {
                    break;
                }
            }
        }
        newest["status"].clone()
    }

    /// Memory that the program holds, kB.
    pub(crate) fn resident(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.process.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap_or("0");
        line.split_whitespace().next().unwrap().parse().unwrap()
    }

    /// Ends it with no word of warning.
    pub(crate) fn kill(mut self) {
        self.process.kill().unwrap();
        self.process.wait().unwrap();
    }

    /// Interrupts it, as Ctrl-C does; what it says was watched.
    pub(crate) fn end(mut self) -> Value {
        let interrupted = Command::new("kill").args(["-INT", &self.process.id().to_string()]).status().unwrap();
        assert!(interrupted.success());
        let status = self.process.wait().unwrap();
        assert!(status.success(), "{status}");
        serde_json::from_str(&std::fs::read_to_string(&self.summary).unwrap()).unwrap()
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A twin at the end of a pseudo-terminal: a device that outlives its host.
pub(crate) struct Device {
    pub(crate) port: PathBuf,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Device {
    pub(crate) fn start() -> Self {
        Self::losing(0)
    }

    /// One whose line loses a byte of every so many hundred; 0 loses none.
    pub(crate) fn losing(hundreds: usize) -> Self {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        let port = PathBuf::from(ptsname(&master, Vec::new()).unwrap().into_string().unwrap());
        fcntl_setfl(&master, OFlags::NONBLOCK).unwrap();
        let mut terminal = tcgetattr(&master).unwrap();
        terminal.make_raw();
        tcsetattr(&master, OptionalActions::Now, &terminal).unwrap();
        let held = File::options().read(true).write(true).open(&port).unwrap();
        let over = Arc::new(AtomicBool::new(false));
        let ending = Arc::clone(&over);
        let thread = std::thread::spawn(move || {
            // Held open, so that the line does not hang up between two hosts.
            let _held = held;
            bridge(File::from(master), hundreds, &ending);
        });
        Self { port, over, thread: Some(thread) }
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        self.thread.take().map(JoinHandle::join);
    }
}

fn bridge(mut master: File, hundreds: usize, over: &AtomicBool) {
    let table = Twin::default();
    let mut device = SoftDevice::start(SoftDevice::setup(&table), table).unwrap();
    let (mut bytes, mut waiting, mut passed) = ([0; 4096], Vec::new(), 0);
    while !over.load(Ordering::Relaxed) {
        if let Ok(read) = master.read(&mut bytes) {
            device.write(&bytes[..read]).unwrap();
        }
        let read = device.read(&mut bytes).unwrap();
        for &byte in &bytes[..read] {
            passed += 1;
            if hundreds == 0 || passed % (100 * hundreds) != 0 {
                waiting.push(byte);
            }
        }
        let written = master.write(&waiting).unwrap_or(0);
        waiting.drain(..written);
        // What nobody reads is lost, as on a wire.
        if waiting.len() > 1 << 16 {
            waiting.clear();
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}
