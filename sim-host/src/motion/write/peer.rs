//! PEER `.AT2`, NGA header, five values a line in columns fifteen wide.

use super::{rows, stated, trimmed};
use crate::motion::{Record, STANDARD_GRAVITY};
use std::fmt::Write as _;

pub(super) fn render(record: &Record) -> String {
    let mut text = String::new();
    let title = format!("{}, written by shakedown, {}", record.name, record.component);
    let _ = writeln!(text, "{}", stated(record, "database", "PEER NGA STRONG MOTION DATABASE RECORD"));
    let _ = writeln!(text, "{}", stated(record, "title", &title));
    text.push_str("ACCELERATION TIME SERIES IN UNITS OF G\n");
    let _ = writeln!(text, "NPTS= {:6}, DT= {} SEC,", record.acceleration.len(), trimmed(record.dt));
    rows(&mut text, record.acceleration.iter().map(|a| fortran(a / STANDARD_GRAVITY)), 5);
    text
}

/// A number as Fortran's `E15.7` writes it, `.dddddddE+ee`.
fn fortran(value: f64) -> String {
    let plain = format!("{:.6e}", value.abs());
    let (mantissa, exponent) = plain.split_once('e').unwrap_or(("0.000000", "0"));
    let exponent = exponent.parse::<i32>().unwrap_or(0) + i32::from(value != 0.0);
    let sign = if value < 0.0 { "-" } else { "" };
    format!("{:>15}", format!("{sign}.{}E{exponent:+03}", mantissa.replace('.', "")))
}
