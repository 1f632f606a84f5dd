//! An experiment in TOML beside a small recording: refused with a message, or read with every run in order.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shakedown::recording::Experiment;
use std::path::PathBuf;
use std::sync::LazyLock;

/// A folder with the recording that the seeds name.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("shakedown-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let row = |i: u32| format!("{},{},{}\n", f64::from(i) * 0.01, f64::from(i % 7) * 1e-3, f64::from(i % 5) * 1e-3);
    let rows: String = (0..64).map(row).collect();
    std::fs::write(folder.join("a.csv"), format!("time,reference,displacement\n{rows}")).expect("a recording");
    folder
});

fuzz_target!(|bytes: &[u8]| {
    let path = FOLDER.join("experiment.toml");
    std::fs::write(&path, bytes).expect("written");
    match Experiment::load(&path) {
        Ok(experiment) => assert!(experiment.runs.iter().all(|run| !run.is_empty())),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
