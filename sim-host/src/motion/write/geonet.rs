//! GeoNet `.V2A`: one component, ten values a line in columns eight wide, mm/s², mm/s and mm.

use super::{WriteError, blocks, stated, trimmed};
use crate::motion::Record;
use std::fmt::Write as _;

pub(super) fn render(record: &Record) -> Result<String, WriteError> {
    let [a, v, x] = blocks(record, 1000.0, 8, 3)?;
    let (n, dt) = (record.acceleration.len(), record.dt);
    let mut text = String::new();
    let _ = writeln!(text, "Corrected accelerogram {}, written by shakedown", record.name);
    let _ = writeln!(text, "{}", stated(record, "station", "Site unknown"));
    text.push_str("\n\n\n\n\n\n");
    let _ = writeln!(text, "{}", stated(record, "epicentre", "Epicentre unknown"));
    let _ = writeln!(text, "Number of points  {n}    Duration {:.2} sec", n as f64 * dt);
    let _ = writeln!(text, "Instrument corrected data at {} sec intervals", trimmed(dt));
    let _ = writeln!(text, "{}", stated(record, "filter", "Band-pass filter transition bands unknown"));
    let _ = writeln!(text, "Component {}", record.component);
    for (name, unit, block) in [("Acceleration", "mm/s/s", &a), ("Velocity", "mm/s", &v), ("Displacement", "mm", &x)] {
        let (peak, time) = block.peak(dt);
        let _ = writeln!(text, "{name}:  peak {peak} {unit} at {time:.2} sec");
    }
    // The numeric header: nothing of it is known after a change, so its ten lines hold zeros.
    for _ in 0..10 {
        let _ = writeln!(text, "{}", "       0".repeat(10));
    }
    for block in [a, v, x] {
        block.put(&mut text, 10);
    }
    Ok(text)
}
