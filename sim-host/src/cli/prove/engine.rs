//! The examinee: any program that answers `COMMAND diagnose EXPERIMENT --json -`, asked as anybody would ask it. A case that
//! brings it down costs that case only.

use super::super::{Failure, output};
use crate::prove::{Answer, Examinee};
use serde_json::Value;
use std::ffi::OsStr;
use std::io::Read as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A program and the words before its own arguments.
pub(super) struct Engine {
    words: Vec<String>,
    /// What fits the library's own equations to data without noise: this program, or the examinee where it is another
    /// version of it.
    fitter: Vec<String>,
    version: String,
}

/// What a program said, and the processor time that it took (s), where the system tells.
struct Said {
    stdout: Vec<u8>,
    seconds: Option<f64>,
}

impl Engine {
    /// This program or another command; the fingerprints of the files among its words freeze its version.
    pub(super) fn new(other: Option<&str>) -> Result<Self, Failure> {
        let own = std::env::current_exe().map_err(|e| Failure::Work(format!("cannot find this binary: {e}")))?;
        let own = vec![own.to_string_lossy().into_owned()];
        let words = other.map_or_else(|| own.clone(), split);
        if words.is_empty() {
            return Err(Failure::Input("--examinee: names no program".into()));
        }
        let mut version = ask(&words, &["--version".as_ref()]).map_or_else(
            |_| words.join(" "),
            |said| String::from_utf8_lossy(&said.stdout).lines().next().unwrap_or_default().trim().to_string(),
        );
        let fitter = if version.starts_with("shakedown ") { words.clone() } else { own };
        for file in words.iter().filter(|word| Path::new(word).is_file()) {
            version += &format!(", sha256 {}", &output::sha256(Path::new(file))?[..16]);
        }
        if other.is_some() && !version.contains("sha256") {
            ask(&words, &["--version".as_ref()]).map_err(|e| Failure::Input(format!("--examinee: {e}")))?;
        }
        Ok(Self { words, fitter, version })
    }
}

/// The words of a command; a path with blanks that is a file stays whole.
fn split(command: &str) -> Vec<String> {
    if Path::new(command).is_file() {
        return vec![command.into()];
    }
    command.split_whitespace().map(Into::into).collect()
}

fn ask(words: &[String], arguments: &[&OsStr]) -> Result<Said, String> {
    let mut command = Command::new(&words[0]);
    command.args(&words[1..]).args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    // The cases run beside one another: each keeps to one core, so that its time is its own.
    for threads in ["RAYON_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"] {
        command.env(threads, "1");
    }
    let named = |e: std::io::Error| format!("{}: {e}", words[0]);
    let mut child = command.spawn().map_err(named)?;
    let errors = child.stderr.take().map(|mut pipe| {
        std::thread::spawn(move || {
            let mut text = Vec::new();
            let _ = pipe.read_to_end(&mut text);
            text
        })
    });
    let mut stdout = Vec::new();
    if let Some(mut pipe) = child.stdout.take() {
        pipe.read_to_end(&mut stdout).map_err(named)?;
    }
    let errors = errors.and_then(|thread| thread.join().ok()).unwrap_or_default();
    let seconds = processor_time(&child);
    let status = child.wait().map_err(named)?;
    if status.success() {
        return Ok(Said { stdout, seconds });
    }
    let said = String::from_utf8_lossy(&errors);
    let message = said.lines().find(|line| line.starts_with("error")).or(said.lines().last()).unwrap_or("");
    Err(format!("{status}: {message}"))
}

/// Processor time of a child that has closed its output (s): what Linux keeps of it until it is waited for.
fn processor_time(child: &Child) -> Option<f64> {
    /// Ticks a second in which Linux counts.
    const TICKS: f64 = 100.0;
    let path = format!("/proc/{}/stat", child.id());
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(2) {
        let text = std::fs::read_to_string(&path).ok()?;
        // The name before them, in brackets, may hold blanks.
        let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
        if fields.first() == Some(&"Z") {
            let ticks = fields.get(11..15)?.iter().filter_map(|f| f.parse::<f64>().ok()).sum::<f64>();
            return Some(ticks / TICKS);
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    None
}

fn json(words: &[String], command: &str, experiment: &Path) -> Result<(Value, Option<f64>), String> {
    let said = ask(words, &[command.as_ref(), experiment.as_os_str(), "--json".as_ref(), "-".as_ref()])?;
    let value = serde_json::from_slice(&said.stdout).map_err(|e| format!("{command} --json: {e}"))?;
    Ok((value, said.seconds))
}

impl Engine {
    /// A diagnosis asked for with more arguments.
    pub(super) fn diagnose_with(&self, experiment: &Path, more: &[&OsStr]) -> Result<Value, String> {
        let mut arguments: Vec<&OsStr> =
            vec!["diagnose".as_ref(), experiment.as_os_str(), "--json".as_ref(), "-".as_ref()];
        arguments.extend(more);
        let said = ask(&self.words, &arguments)?;
        serde_json::from_slice(&said.stdout).map_err(|e| format!("diagnose --json: {e}"))
    }
}

impl Examinee for Engine {
    fn diagnose(&self, experiment: &Path) -> Result<Answer, String> {
        let start = Instant::now();
        let (diagnosis, seconds) = json(&self.words, "diagnose", experiment)?;
        Ok(Answer { diagnosis, seconds: seconds.unwrap_or_else(|| start.elapsed().as_secs_f64()) })
    }

    fn identify(&self, experiment: &Path) -> Option<Result<Value, String>> {
        Some(json(&self.fitter, "identify", experiment).map(|(value, _)| value))
    }

    fn version(&self) -> String {
        self.version.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn any_command_is_asked_and_its_processor_time_is_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let script = folder.path().join("examinee.sh");
        // Half a second of waiting costs no processor time.
        std::fs::write(&script, "sleep 0.5; echo '{\"verdict\": \"consistent\"}'\n").unwrap();
        let engine = Engine::new(Some(&format!("sh {}", script.display()))).unwrap();
        assert!(engine.version().contains("sha256"), "{}", engine.version());
        let answer = engine.diagnose(Path::new("experiment.toml")).unwrap();
        assert_eq!(answer.diagnosis["verdict"], "consistent");
        assert!(answer.seconds < 0.4, "{} s", answer.seconds);
        assert!(Engine::new(Some("no-such-program-anywhere")).is_err());
        assert!(Engine::new(Some(" ")).is_err());
    }
}
