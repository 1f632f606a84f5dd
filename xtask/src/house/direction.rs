//! Dependencies point one way, between crates and between the rooms of the host crate.

use super::File;
use crate::boards;
use crate::shell::{Problem, metadata};
use serde_json::Value;

/// What each crate of the workspace may use of the workspace. `shakedown-truth` is a leaf that shares nothing.
const CRATES: &[(&str, &[&str])] = &[
    ("shakedown-core", &[]),
    ("shakedown-truth", &[]),
    ("shakedown-rehearsal", &["shakedown-core"]),
    ("shakedown-firmware", &["shakedown-core", "shakedown-rehearsal"]),
    // The twin of `live` is the firmware's own loop and link server; the library alone, without a board.
    ("shakedown", &["shakedown-core", "shakedown-truth", "shakedown-replay", "shakedown-firmware"]),
    (
        "shakedown-replay",
        &["shakedown-core", "shakedown", "shakedown-firmware", "shakedown-rehearsal", "shakedown-second-opinion"],
    ),
    ("shakedown-tests", &["shakedown-core", "shakedown", "shakedown-truth"]),
    ("shakedown-no-panic", &["shakedown-core"]),
    ("shakedown-law-cost", &["shakedown-core"]),
    ("shakedown-hil", &["shakedown-core", "shakedown-firmware"]),
    ("shakedown-beside", &["shakedown-core", "shakedown-firmware"]),
    ("shakedown-second-opinion", &["shakedown-core", "shakedown-firmware"]),
    ("shakedown-tape", &["shakedown-core"]),
    ("shakedown-c", &["shakedown-core"]),
    ("shakedown-twin", &["shakedown-core", "shakedown", "shakedown-c"]),
    ("shakedown-python", &["shakedown-core", "shakedown"]),
    ("xtask", &[]),
];

/// What every board may use; none uses another.
const A_BOARD: &[&str] = &["shakedown-core", "shakedown-firmware"];

/// Whose tests run on a board, and use its package.
const ON_A_BOARD: &[&str] = &["shakedown-hil"];

/// The rooms of the host crate, each of which may use those before it: `diagnose` uses `identify` uses `closed_loop`
/// uses `plant`.
const ROOMS: &[&[&str]] = &[
    &["scalar", "files", "digits"],
    &["plant", "motion", "recording"],
    &["closed_loop"],
    &["identify"],
    &["diagnose"],
    &["device", "faults", "prove"],
    &["live"],
];

/// Who may use `report`: the command line, `prove`, whose page is as long as its scoring, and `blocks`, which hands it on.
const DRAWS: &[&str] = &["blocks", "cli", "prove", "report"];

/// Names crates that use what they must not.
pub(super) fn crates() -> Result<Vec<String>, Problem> {
    let metadata = metadata(false)?;
    let packages: Vec<&Value> = metadata["packages"].as_array().into_iter().flatten().collect();
    let ours = |name: &str| packages.iter().any(|p| p["name"] == name);
    let mut breaches = Vec::new();
    for package in &packages {
        let name = package["name"].as_str().unwrap_or_default();
        let of_board = boards::holds(package).then_some(&A_BOARD);
        let Some(allowed) = of_board.or(CRATES.iter().find(|(of, _)| *of == name).map(|(_, allowed)| allowed)) else {
            breaches.push(format!("crate {name}: what it may use is not said in {}", file!()));
            continue;
        };
        let used = package["dependencies"].as_array().into_iter().flatten().filter_map(|d| d["name"].as_str());
        let board = |used: &str| packages.iter().any(|p| p["name"] == used && boards::holds(p));
        let wrong = used
            .filter(|used| ours(used) && !allowed.contains(used))
            .filter(|used| !(ON_A_BOARD.contains(&name) && board(used)));
        breaches.extend(wrong.map(|used| format!("crate {name} uses {used}, which it must not")));
    }
    Ok(breaches)
}

/// Names rooms of the host crate that use a room above or beside their own without leave.
pub(super) fn modules(files: &[File]) -> Vec<String> {
    let floor = |room: &str| ROOMS.iter().position(|rooms| rooms.contains(&room));
    let mut breaches = Vec::new();
    for file in files {
        let Some(rest) = file.path.strip_prefix("sim-host/src/").filter(|rest| !rest.ends_with("tests.rs")) else {
            continue; // a test may look wherever it likes
        };
        let room = rest.split(['/', '.']).next().unwrap_or_default();
        let used =
            file.text.split("crate::").skip(1).map(|rest| rest.split(|c: char| !is_name(c)).next().unwrap_or(""));
        for used in used {
            let upwards = matches!((floor(room), floor(used)), (Some(at), Some(of)) if of > at);
            let report = used == "report" && !DRAWS.contains(&room);
            if upwards || report {
                breaches.push(format!("{}: {room} uses crate::{used}, which stands above it", file.path));
            }
        }
    }
    breaches.dedup();
    breaches
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_room_that_looks_upstairs_is_named() {
        let file = |path: &str, text: &str| File { path: path.into(), text: text.into() };
        let plant = file("sim-host/src/plant/oil.rs", "use crate::scalar::Scalar;\nuse crate::diagnose::Verdict;\n");
        let motion = file("sim-host/src/motion.rs", "use crate::report::Page;\n");
        let command = file("sim-host/src/cli/run.rs", "use crate::report::Page;\n");
        let breaches = modules(&[plant, motion, command]);
        assert_eq!(breaches.len(), 2, "{breaches:?}");
        assert!(breaches[0].contains("crate::diagnose") && breaches[1].contains("crate::report"), "{breaches:?}");
    }
}
