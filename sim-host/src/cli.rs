//! The command line: one file a command, one door for output, one place where errors become exit statuses.

mod asked;
mod attained;
mod bench;
mod campaign;
mod checked;
mod compare;
mod demo;
mod described;
mod design;
mod desk;
#[cfg(unix)]
mod device;
mod diagnose;
mod effects;
mod failure;
mod faults;
mod histories;
mod identify;
mod indices;
mod init;
mod judged;
mod learn;
#[cfg(not(target_family = "wasm"))]
mod live;
mod modify;
mod output;
mod places;
mod present;
mod progress;
mod prove;
mod qualify;
#[cfg(not(target_family = "wasm"))]
mod reference;
mod replay;
mod required;
mod run;
mod shard;
mod source;
mod sweep;
mod table1;
mod traces;
mod unseen;
mod words;
mod written;

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use std::process::ExitCode;

pub(crate) use failure::Failure;

/// The table of a model file; the paper's without one.
fn table(path: Option<&std::path::Path>) -> Result<crate::closed_loop::twin::Twin, Failure> {
    use crate::closed_loop::twin::Twin;
    path.map_or_else(|| Ok(Twin::default()), Twin::load).map_err(|e| {
        let (place, text) = (path.map_or(String::new(), |path| path.display().to_string()), e.to_string());
        Failure::Input(if text.starts_with(&place) { text } else { format!("{place}: {text}") })
    })
}

/// The speed that a motion keeps, m/s: as `stated` by `--velocity`, else the table's, whose file has to state one.
fn velocity_limit(
    stated: Option<f64>,
    twin: &crate::closed_loop::twin::Twin,
    path: Option<&std::path::Path>,
) -> Result<f64, Failure> {
    let limit = stated.unwrap_or_else(|| twin.velocity_limit());
    if stated.is_some() || limit.is_finite() {
        return Ok(limit);
    }
    let place = path.map_or_else(|| "the table".to_owned(), |path| path.display().to_string());
    Err(Failure::Input(format!(
        "{place}: [model] states no velocity_limit; state it there, in m/s, or give --velocity"
    )))
}

/// Firmware, control core and host tool for hydraulic shake tables.
#[derive(Debug, Parser)]
#[command(version, about, propagate_version = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

/// What can be asked for; nothing given is `demo`.
#[derive(Debug, Subcommand)]
enum Command {
    Identify(identify::Args),
    Init(init::Args),
    Bench(bench::Args),
    Campaign(campaign::Args),
    Compare(compare::Args),
    Demo(demo::Args),
    Design(design::Args),
    Learn(learn::Args),
    #[cfg(not(target_family = "wasm"))]
    Live(Box<live::Args>),
    #[cfg(unix)]
    Device(device::Args),
    Completions(desk::Completions),
    Man(desk::Man),
    Open(desk::Open),
    Modify(Box<modify::Args>),
    Diagnose(diagnose::Args),
    Effects(effects::Args),
    Faults(faults::Args),
    Prove(prove::Args),
    Qualify(Box<qualify::Args>),
    Replay(replay::Args),
    Run(run::Args),
    Sweep(sweep::Args),
    Table1(table1::Args),
}

/// Runs what the command line asks for and turns its outcome into an exit status.
pub fn main() -> ExitCode {
    let mut command = Arguments::command();
    let mut matches = match words::matches(&mut command) {
        Ok(matches) => matches,
        Err(status) => return status,
    };
    if let Err(failure) = places::distinct(&command, &matches) {
        return failure.report();
    }
    asked::keep(&command, &matches);
    let arguments = match Arguments::from_arg_matches_mut(&mut matches) {
        Ok(arguments) => arguments,
        Err(e) => return words::refused(&e.format(&mut command)),
    };
    crate::files::clean_up_when_interrupted();
    let outcome: Result<(), Failure> = match arguments.command {
        None => demo::run(&demo::Args::default()),
        Some(command) => match command {
            Command::Identify(args) => identify::run(&args),
            Command::Init(args) => init::run(&args),
            Command::Bench(args) => bench::run(&args),
            Command::Campaign(args) => campaign::run(&args),
            Command::Compare(args) => compare::run(&args),
            Command::Demo(args) => demo::run(&args),
            Command::Design(args) => design::run(&args),
            Command::Learn(args) => learn::run(&args),
            #[cfg(not(target_family = "wasm"))]
            Command::Live(args) => live::run(&args),
            #[cfg(unix)]
            Command::Device(args) => device::run(&args),
            Command::Completions(args) => {
                desk::completions(&args);
                Ok(())
            }
            Command::Man(args) => desk::man(&args),
            Command::Open(args) => desk::open(&args),
            Command::Modify(args) => modify::run(&args),
            Command::Diagnose(args) => diagnose::run(&args),
            Command::Effects(args) => effects::run(&args),
            Command::Faults(args) => faults::run(&args),
            Command::Prove(args) => prove::run(&args),
            Command::Qualify(args) => qualify::run(&args),
            Command::Replay(args) => replay::run(&args),
            Command::Run(args) => run::run(&args),
            Command::Sweep(args) => sweep::run(&args),
            Command::Table1(args) => table1::run(&args),
        },
    };
    match outcome.and_then(|()| output::finished()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Clap's own checks are compiled out with all other dependencies' assertions: of two options of one name it takes the first.
    #[test]
    fn no_command_has_two_options_of_one_name() {
        fn repeated(command: &clap::Command) -> Vec<String> {
            let names: Vec<&str> = command.get_arguments().filter_map(clap::Arg::get_long).collect();
            let twice = names.iter().enumerate().filter(|(i, name)| names[..*i].contains(name));
            let own = twice.map(|(_, name)| format!("{} --{name}", command.get_name()));
            own.chain(command.get_subcommands().flat_map(repeated)).collect()
        }
        let command = Arguments::command();
        assert!(command.get_subcommands().count() > 20);
        assert_eq!(repeated(&command), [""; 0]);
    }
}
