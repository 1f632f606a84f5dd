//! Installs what the tests need: names it first, asks where a person is there to answer, says what it left out.

use crate::firmware::GCC;
use crate::output::say;
use crate::shell::{Problem, command, no_words, run as execute, works};
use crate::toolchain::{self, TARGET};
use std::io::{BufRead as _, IsTerminal as _, Write as _};

/// Something a test needs that Cargo does not bring.
struct Need {
    name: &'static str,
    /// Which tests need it.
    used_for: &'static str,
    /// How it is installed, as a person would say it.
    from: &'static str,
    present: fn() -> bool,
    install: fn() -> Result<(), Problem>,
}

/// The second emulator.
pub(crate) const QEMU: &str = "qemu-system-arm";
/// The circuit simulator.
pub(crate) const NGSPICE: &str = "ngspice";

const NEEDS: &[Need] = &[
    Need {
        name: "rustfmt and clippy",
        used_for: "format and lints",
        from: "rustup component add rustfmt clippy",
        present: || works(&["cargo", "fmt", "--version"]) && works(&["cargo", "clippy", "--version"]),
        install: || execute(&mut command(&["rustup", "component", "add", "rustfmt", "clippy"])),
    },
    Need {
        name: "chromium",
        used_for: "opening the reports as a reader does",
        from: "apt",
        present: || ["chromium", "chromium-browser", "google-chrome"].iter().any(|name| works(&[name, "--version"])),
        install: || apt(&["chromium"]),
    },
    Need {
        name: TARGET,
        used_for: "building the firmware",
        from: "rustup target add; without it Debian's rustc-web and rust-web-src",
        present: || toolchain::find().is_some(),
        install: toolchain::install,
    },
    Need {
        name: QEMU,
        used_for: "a second opinion on the bits that the firmware computes",
        from: "apt",
        present: || works(&[QEMU, "--version"]),
        install: || apt(&[QEMU]),
    },
    Need {
        name: NGSPICE,
        used_for: "the front end's circuits (`cargo xtask front-end`)",
        from: "apt",
        present: || works(&[NGSPICE, "--version"]),
        install: || apt(&[NGSPICE]),
    },
    Need {
        name: "gcc, clang and cmake",
        used_for: "the core called from C (`cargo xtask hosts`)",
        from: "apt",
        present: || ["gcc", "clang", "cmake"].iter().all(|name| works(&[name, "--version"])),
        install: || apt(&["gcc", "libc6-dev", "clang", "cmake"]),
    },
    Need {
        name: "python3 with venv",
        used_for: "the Python wheel and the FMU (`cargo xtask hosts`)",
        from: "apt",
        present: || works(&["python3", "-c", "import venv, ensurepip"]),
        install: || apt(&["python3", "python3-venv"]),
    },
    Need {
        name: GCC,
        used_for: "the core's laws in C, to measure beside",
        from: "apt, gcc-arm-none-eabi",
        present: || works(&[GCC, "--version"]),
        install: || apt(&["gcc-arm-none-eabi"]),
    },
];

/// What could not be installed, and what does not run for the want of it.
pub(crate) struct LeftOut {
    /// What is missing.
    pub(crate) name: &'static str,
    /// What it would have been used for.
    pub(crate) used_for: &'static str,
    /// Why it is missing.
    pub(crate) why: String,
}

/// The chore: installs what is missing.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    report(&install());
    Ok(())
}

/// Installs what is missing, as far as it can be had and is wanted.
pub(crate) fn install() -> Vec<LeftOut> {
    let left_out = install_of(|_| true);
    if left_out.is_none() {
        say("Everything the tests need is here.");
    }
    left_out.unwrap_or_default()
}

/// Installs what of `names` is missing, or says what a chore that needs it cannot do without.
pub(crate) fn need(names: &[&str]) -> Result<(), Problem> {
    let left_out = install_of(|name| names.contains(&name)).unwrap_or_default();
    let line = |one: &LeftOut| format!("{} is not here (for {}): {}", one.name, one.used_for, one.why);
    let lines: Vec<String> = left_out.iter().map(line).collect();
    if lines.is_empty() { Ok(()) } else { Err(Problem::Failed(lines.join("\n"))) }
}

/// Installs what is missing among the needs of such names; what could not be, or none where nothing is missing.
fn install_of(wanted: impl Fn(&str) -> bool) -> Option<Vec<LeftOut>> {
    let missing: Vec<&Need> = NEEDS.iter().filter(|need| wanted(need.name) && !(need.present)()).collect();
    if missing.is_empty() {
        return None;
    }
    say("The tests need what this machine does not have yet:");
    for need in &missing {
        say(&format!("  {:22} for {} ({})", need.name, need.used_for, need.from));
    }
    let wanted = agreed();
    let left_out = |need: &&Need, why: String| LeftOut { name: need.name, used_for: need.used_for, why };
    let outcome = |need: &&Need| if wanted { (need.install)().err().map(message) } else { Some("not wanted".into()) };
    Some(missing.iter().filter_map(|need| outcome(need).map(|why| left_out(need, why))).collect())
}

/// Says what is missing for good.
pub(crate) fn report(left_out: &[LeftOut]) {
    for one in left_out {
        say(&format!("LEFT OUT: {} (for {}): {}", one.name, one.used_for, one.why));
    }
}

/// Asks where a person is there to answer; a machine has agreed by running this.
fn agreed() -> bool {
    let person = std::io::stdin().is_terminal() && std::io::stdout().is_terminal();
    if !person || std::env::var("CI").is_ok_and(|ci| ci == "true") {
        return true;
    }
    let mut answer = String::new();
    let _ = write!(std::io::stdout(), "Install it now? [Y/n] ").and_then(|()| std::io::stdout().flush());
    let read = std::io::stdin().lock().read_line(&mut answer).is_ok();
    read && matches!(answer.trim().to_lowercase().as_str(), "" | "y" | "yes")
}

/// Installs Debian packages, as root or by sudo.
pub(crate) fn apt(packages: &[&str]) -> Result<(), Problem> {
    if !works(&["apt-get", "--version"]) {
        return Err(Problem::Failed(format!("no apt on this machine: install {} by hand", packages.join(", "))));
    }
    let root = crate::shell::read(&mut command(&["id", "-u"])).is_ok_and(|id| id.trim() == "0");
    let apt: &[&str] = if root { &["apt-get"] } else { &["sudo", "apt-get"] };
    let with = |words: &[&str]| {
        let mut command = command(&[apt, words].concat());
        command.env("DEBIAN_FRONTEND", "noninteractive");
        execute(&mut command)
    };
    with(&["update", "-q"])?;
    with(&[&["install", "-y", "-q", "--no-install-recommends"], packages].concat())
}

fn message(problem: Problem) -> String {
    let (Problem::Usage(message) | Problem::Failed(message)) = problem;
    message
}
