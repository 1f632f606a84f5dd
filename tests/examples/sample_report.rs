//! Writes a report with one of everything, to look at: `cargo run -p shakedown-tests --example sample_report FILE`.

fn main() -> std::io::Result<()> {
    let path = std::env::args_os().nth(1).unwrap_or_else(|| "shakedown-report-sample.html".into());
    shakedown_tests::sample::page().write(path.as_ref())
}
