//! How often 90 % intervals hold the truth: `cargo run --release -p shakedown --example coverage [SEEDS]`, 200 by default.

#![allow(clippy::print_stdout, clippy::expect_used, clippy::unwrap_used, reason = "an example prints and stops")]

#[path = "../tests/support/coverage.rs"]
mod coverage;

fn main() {
    let seeds = std::env::args().nth(1).map_or(200, |word| word.parse().expect("a number of seeds"));
    for (name, colour) in [("white noise", 0.0), ("coloured noise, x[k] = 0.9 x[k-1] + e[k]", 0.9)] {
        let counts = coverage::count(seeds, colour);
        println!("{name}, {seeds} seeds: share of 90 % intervals that hold the truth");
        println!("  {:20} {:>8} {:>8}", "parameter", "profile", "from std");
        for count in &counts {
            let share = |held: usize| 100.0 * held as f64 / count.of as f64;
            println!("  {:20} {:7.1}% {:7.1}%", count.name, share(count.profile), share(count.normal));
        }
        let (profile, normal) = coverage::total(&counts);
        println!("  {:20} {:7.1}% {:7.1}%", "all", 100.0 * profile, 100.0 * normal);
    }
}
