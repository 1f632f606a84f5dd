//! The `shakedown` binary: parses the command line and hands over to one file a command.

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
