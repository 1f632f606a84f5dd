//! Fuzzing without a nightly compiler: libFuzzer's instrumentation by plain code-generation flags.

use crate::output::say;
use crate::shell::{Problem, command, metadata_of, run as execute, top};

/// How long a target runs where nothing else is said, s.
const SECONDS: u32 = 60;
/// Most memory a target may take, MiB: readers promise to stay below what a file of any size needs.
const MEMORY: u32 = 1024;
/// The target that is no parser.
const COMMAND_LINE: &str = "command-line";
/// What cargo-fuzz passes too.
const FLAGS: &str = "--cfg fuzzing -Ccodegen-units=1 -Cpasses=sancov-module \
    -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
    -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares";

/// The chore: runs one target or all, each for so many seconds.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    if let Some((name, rest)) = words.split_first()
        && name == COMMAND_LINE
    {
        return command_line(rest);
    }
    let known = targets()?;
    let (chosen, seconds) = match words {
        [] => (known.clone(), SECONDS),
        [target] => (vec![target.clone()], SECONDS),
        [target, seconds] => {
            let seconds =
                seconds.parse().map_err(|_| Problem::Usage(format!("`{seconds}` is no number of seconds")))?;
            (vec![target.clone()], seconds)
        }
        _ => return Err(Problem::Usage("fuzz takes a target and a number of seconds".into())),
    };
    if let Some(unknown) = chosen.iter().find(|target| !known.contains(target)) {
        return Err(Problem::Usage(format!(
            "there is no target `{unknown}`; there are: {}, {COMMAND_LINE}",
            known.join(", ")
        )));
    }
    let folder = build()?;
    for target in &chosen {
        fuzz(target, seconds, &folder)?;
    }
    Ok(())
}

/// The command line has no parser of ours to be instrumented: the binary is run with words drawn from its own help.
fn command_line(words: &[String]) -> Result<(), Problem> {
    let seconds: u32 = match words {
        [] => SECONDS,
        [seconds] => seconds.parse().map_err(|_| Problem::Usage(format!("`{seconds}` is no number of seconds")))?,
        _ => return Err(Problem::Usage("fuzz command-line takes a number of seconds".into())),
    };
    let line = "cargo test --locked --package shakedown-tests --test command_line -- --nocapture";
    execute(command(&line.split(' ').collect::<Vec<_>>()).env("SHAKEDOWN_FUZZ_SECONDS", seconds.to_string()))
}

/// Whether all targets compile, which no other workspace asks. The engine is not built for it: nothing is linked.
pub(crate) fn lints() -> Result<(), Problem> {
    let words = ["cargo", "clippy", "--locked", "--manifest-path", "fuzz/Cargo.toml", "--", "-D", "warnings"];
    let target = top().join("fuzz/target");
    execute(command(&words).env("CARGO_TARGET_DIR", target).env("CUSTOM_LIBFUZZER_PATH", "none/libfuzzer.a"))
}

/// The names of all targets.
fn targets() -> Result<Vec<String>, Problem> {
    let metadata = metadata_of("fuzz/Cargo.toml", false)?;
    let targets = metadata["packages"][0]["targets"].as_array().into_iter().flatten();
    Ok(targets.filter_map(|target| target["name"].as_str().map(String::from)).collect())
}

/// Builds all targets with instrumentation and gives the folder they are in.
fn build() -> Result<String, Problem> {
    // With a target named, build scripts and macros of the host stay without instrumentation.
    let host = crate::shell::read(&mut command(&["rustc", "--print", "host-tuple"]))?;
    let host = host.trim();
    let words = ["cargo", "build", "--release", "--locked", "--manifest-path", "fuzz/Cargo.toml", "--target", host];
    let target = top().join("fuzz/target");
    execute(command(&words).env("CARGO_TARGET_DIR", target).env("RUSTFLAGS", FLAGS))?;
    Ok(format!("fuzz/target/{host}/release"))
}

fn fuzz(target: &str, seconds: u32, folder: &str) -> Result<(), Problem> {
    let (found, artifacts) = (format!("fuzz/target/corpus/{target}"), format!("fuzz/artifacts/{target}/"));
    for folder in [&found, &artifacts] {
        std::fs::create_dir_all(top().join(folder)).map_err(|e| Problem::Failed(format!("{folder}: {e}")))?;
    }
    say(&format!("fuzzing {target} for {seconds} s; a finding would be written to {artifacts}"));
    let program = top().join(folder).join(target);
    execute(command(&[&program.to_string_lossy(), &found, &format!("fuzz/corpus/{target}")]).args([
        format!("-max_total_time={seconds}"),
        format!("-rss_limit_mb={MEMORY}"),
        format!("-artifact_prefix={artifacts}"),
        "-timeout=10".into(),
        "-print_final_stats=1".into(),
        "-verbosity=0".into(),
    ]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_has_seeds() {
        for target in targets().unwrap() {
            let seeds = std::fs::read_dir(top().join("fuzz/corpus").join(&target)).map_or(0, Iterator::count);
            assert!(seeds > 0, "fuzz/corpus/{target} is empty");
        }
    }

    #[test]
    fn an_unknown_target_is_refused() {
        assert!(matches!(run(&["nonsense".into()]), Err(Problem::Usage(_))));
    }
}
