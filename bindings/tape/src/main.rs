//! Writes the tape, or plays one: on this host `shakedown-tape write TAPE` and `shakedown-tape play TAPE ANSWERS`; `shakedown-tape cost`
//! prints what a sample of a run costs. Built for thumbv7em, the image that plays the file `tape` into the file `answers` by semihosting.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod device;

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let outcome = match words[..] {
        ["write", tape] => std::fs::write(tape, shakedown_tape::write()).map_err(|e| format!("{tape}: {e}")),
        ["play", tape, answers] => play(tape, answers),
        ["cost"] => cost(),
        _ => Err("usage: shakedown-tape write TAPE | shakedown-tape play TAPE ANSWERS | shakedown-tape cost".into()),
    };
    match outcome {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            std::process::ExitCode::FAILURE
        }
    }
}

#[cfg(not(target_os = "none"))]
fn play(tape: &str, to: &str) -> Result<(), String> {
    let bytes = std::fs::read(tape).map_err(|e| format!("{tape}: {e}"))?;
    let (answers, _) = shakedown_tape::play(&bytes).map_err(|e| format!("{tape}: {e}"))?;
    let bytes: Vec<u8> = answers.iter().flatten().flat_map(|word| word.to_le_bytes()).collect();
    std::fs::write(to, bytes).map_err(|e| format!("{to}: {e}"))
}

/// What a sample costs where a run of 60 s at 1 kHz is handed over at once and its commands are a new list, ns: the median over runs.
#[cfg(not(target_os = "none"))]
fn cost() -> Result<(), String> {
    use shakedown_core::{Command, Controller, Sample, Settings};
    use std::io::Write as _;
    const RUN: usize = 60_000;
    let mut controller = Controller::new(&Settings::default()).map_err(|e| e.to_string())?;
    let samples = vec![Sample { reference: 0.01, ..Sample::default() }; RUN];
    let mut costs: Vec<f64> = Vec::new();
    for _ in 0..50 {
        let begin = std::time::Instant::now();
        let commands: Vec<Command> = samples.iter().map(|sample| controller.step(sample)).collect();
        costs.push(begin.elapsed().as_secs_f64() * 1e9 / RUN as f64);
        std::hint::black_box(commands);
    }
    costs.sort_by(f64::total_cmp);
    writeln!(std::io::stdout(), "{:.1}", costs[costs.len() / 2]).map_err(|e| e.to_string())
}
