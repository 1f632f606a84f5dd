//! Writes the tape, or plays one: on this host `shakedown-tape write TAPE` and `shakedown-tape play TAPE ANSWERS`; built for
//! thumbv7em, the image that plays the file `tape` into the file `answers` by semihosting.
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
        _ => Err("usage: shakedown-tape write TAPE | shakedown-tape play TAPE ANSWERS".into()),
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
