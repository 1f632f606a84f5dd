//! The `shakedown` binary: hands over to the command line of the library.

fn main() -> std::process::ExitCode {
    shakedown::cli::main()
}
