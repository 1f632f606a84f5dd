//! CSMIP Volume 2: 25 lines of text, 7 of integers, 13 of reals, then acceleration, velocity and displacement, eight values
//! a line in columns ten wide, cm/s², cm/s and cm.

use super::{WriteError, blocks, stated, trimmed};
use crate::motion::Record;
use std::fmt::Write as _;

pub(super) fn render(record: &Record) -> Result<String, WriteError> {
    let [a, v, x] = blocks(record, 100.0, 10, 5)?;
    let (n, dt) = (record.acceleration.len(), record.dt);
    let mut text = String::new();
    let _ = writeln!(text, "CORRECTED ACCELEROGRAM   {}       CHAN  1: {}", record.name, record.component);
    text.push_str("WRITTEN BY SHAKEDOWN\n");
    let _ = writeln!(text, "{}\n", stated(record, "event", "EARTHQUAKE UNKNOWN"));
    text.push('\n');
    let _ = writeln!(text, "{}\n", stated(record, "station", "STATION NO. UNKNOWN"));
    let _ = writeln!(text, "CHAN  1: {}\n", record.component);
    let _ = writeln!(text, "{}", stated(record, "hypocenter", "HYPOCENTER: UNKNOWN"));
    text.push_str("\n\n\n\n");
    let _ = writeln!(text, "{}", stated(record, "filter", "BANDPASS UNKNOWN"));
    let _ = writeln!(text, "{n:6} POINTS OF BASELINE-CORRECTED ACCEL, VELOC AND DISPL DATA");
    let _ = writeln!(text, "AT EQUALLY-SPACED INTERVALS OF {} SEC.", trimmed(dt));
    for (name, unit, block) in
        [("ACCELERATION", "CM/SEC/SEC", &a), ("VELOCITY", "CM/SEC", &v), ("DISPLACEMENT", "CM", &x)]
    {
        let (peak, time) = block.peak(dt);
        let _ = writeln!(text, "PEAK {name} = {peak} {unit} AT {time:.3} SEC.");
    }
    text.push_str("INITIAL VELOCITY  = .000 CM/SEC;   INITIAL DISPLACEMENT = .000 CM\n\n\n\n\n");
    numeric_header(&mut text);
    for (name, unit, block) in [("ACCEL", "CM/SEC/SEC", a), ("VELOC", "CM/SEC", v), ("DISPL", "CM", x)] {
        let _ = writeln!(text, "{n:6} POINTS OF {name} DATA EQUALLY SPACED AT {} SEC.  (UNITS: {unit})", trimmed(dt));
        block.put(&mut text, 8);
    }
    text.push_str("/&  ----------  END OF DATA FOR CHANNEL  1  ----------\n");
    Ok(text)
}

/// 100 integers and 100 reals, of which nothing is known after a change.
fn numeric_header(text: &mut String) {
    super::rows(text, (0..100).map(|_| "    0".to_owned()), 16);
    super::rows(text, (0..100).map(|_| "      .000".to_owned()), 8);
}
