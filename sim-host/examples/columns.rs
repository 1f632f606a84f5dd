//! Every column of a recording, or the acceleration of a ground-motion record, as the readers see it: CSV with all digits, for
//! comparison with other readers. `cargo run -p shakedown --example columns FILE [CHANNEL]`.
#![allow(clippy::print_stdout, reason = "an example prints what it read")]

use shakedown::fit::read::{self, Options};
use shakedown::recording::file;
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let path = PathBuf::from(words.next().ok_or("name a file")?);
    let channel = words.next().unwrap_or_default();
    let Ok(channel) = channel.parse();
    match read::record(&path, &Options { channel, ..Options::default() }) {
        Ok(record) if record.format != shakedown::fit::Format::Columns => {
            println!("time [s],acceleration [m/s2]");
            for (k, a) in record.acceleration.iter().enumerate() {
                println!("{:.17e},{a:.17e}", k as f64 * record.dt);
            }
            return Ok(());
        }
        Ok(_) | Err(_) => {}
    }
    let headings = file::headings(&path)?;
    let mut columns = Vec::new();
    for heading in headings.iter().filter(|h| !h.text.is_empty()) {
        // Columns that are no numbers, or of another length, have no place here.
        if let Ok(table) = file::read(&path, &[&heading.text]) {
            columns.push((heading.text.clone(), table.columns.into_iter().next().unwrap_or_default()));
        }
    }
    let longest = columns.iter().map(|(_, c)| c.len()).max().ok_or("holds no column of numbers")?;
    println!("{}", columns.iter().map(|(name, _)| name.replace(',', ";")).collect::<Vec<_>>().join(","));
    for k in 0..longest {
        let cell = |c: &Vec<f64>| c.get(k).map_or_else(String::new, |x| format!("{x:.17e}"));
        println!("{}", columns.iter().map(|(_, c)| cell(c)).collect::<Vec<_>>().join(","));
    }
    Ok(())
}
