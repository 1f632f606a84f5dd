//! COSMOS version 1.20: one channel of corrected acceleration, cm/s², five values a line in columns fifteen wide.

use super::{rows, stated};
use crate::motion::Record;
use std::fmt::Write as _;

const UNKNOWN: f64 = -999.0;

pub(super) fn render(record: &Record) -> String {
    let values: Vec<f64> = record.acceleration.iter().map(|a| a * 100.0).collect();
    let (n, dt) = (values.len(), record.dt);
    let peak = values.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
    let mut text = String::new();
    let _ = writeln!(text, "Corrected acceleration   (Format v01.20 with 13 text lines) Src: {}", record.name);
    text.push_str("Written by shakedown\n");
    let _ = writeln!(text, "{}\nOrigin: unknown", stated(record, "hypocenter", "Hypocenter: unknown"));
    let _ = writeln!(text, "{}\nCoords: unknown\nRecorder: unknown", stated(record, "station", "Statn No: unknown"));
    let _ = writeln!(text, "{}", stated(record, "record time", "Rcrd start time: unknown"));
    let _ = writeln!(text, "Sta Chan  1: {}\nRaw record length: unknown", record.component);
    let _ = writeln!(text, "{}\nRecord filter: unknown", stated(record, "processing", "Processed: unknown"));
    text.push_str("Values used when parameter or data value is unknown/unspecified:   -999, -999.0\n");
    text.push_str(" 100 Integer-header values follow on  10 lines, Format= (10I8)\n");
    // Corrected, acceleration, cm/s2, format 1.20.
    let integers = [2, 1, 4, 120];
    rows(&mut text, (0..100).map(|i| format!("{:8}", integers.get(i).unwrap_or(&-999))), 10);
    text.push_str(" 100 Real-header values follow on  20 lines, Format= (5E15.6)\n");
    let real = |i: usize| match i {
        33 => dt,
        34 => n as f64 * dt,
        63 => peak,
        _ => UNKNOWN,
    };
    // The interval keeps more digits than the format says: readers split at blanks.
    rows(&mut text, (0..100).map(|i| format!("{:15}", shortest(real(i)))), 5);
    text.push_str("   1 Comment line(s) follow, each starting with a \"|\":\n|\n");
    let seconds = (n as f64 * dt).round();
    let _ = writeln!(text, "{n:8} acceleration pts, approx {seconds:4} secs, units=cm/sec2(04),Format=(5E15.7)");
    rows(&mut text, values.iter().map(|v| format!("{v:15.7E}")), 5);
    text.push_str("End-of-data for Chan  1 acceleration\n");
    text
}

/// A number in fourteen characters at most, with a blank before it.
fn shortest(value: f64) -> String {
    let plain = format!(" {value}");
    if plain.len() <= 15 { plain } else { format!(" {value:.7E}") }
}
