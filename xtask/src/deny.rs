//! Licences, sources and banned crates by `deny.toml`; advisories too, where their database can be fetched.

use crate::output::say;
use crate::shell::{Problem, command, no_words, run as execute, works};

/// The chore.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    if !works(&["cargo", "deny", "--version"]) {
        return Err(Problem::Failed("cargo-deny is not here: `cargo install --locked cargo-deny` brings it".into()));
    }
    execute(&mut command(&["cargo", "deny", "--all-features", "check", "bans", "licenses", "sources"]))?;
    let advisories = execute(&mut command(&["cargo", "deny", "--all-features", "check", "advisories"]));
    if let Err(Problem::Failed(why) | Problem::Usage(why)) = advisories {
        say(&format!("advisories: {why}; without network the database cannot be had, otherwise read what it says"));
    }
    Ok(())
}
