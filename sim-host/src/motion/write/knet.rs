//! K-NET ASCII: integer counts, eight a line. The counts carry no offset, which the memo says, so that a reader that knows
//! takes no mean out.

use super::{rows, stated};
use crate::motion::{Record, peak};
use std::fmt::Write as _;

/// What the memo says where the mean of the counts is part of the motion.
pub(in crate::motion) const NO_OFFSET: &str = "counts carry no offset";
/// Counts of the largest acceleration that the scale is chosen for, 23 bits.
const FULL_SCALE: f64 = 8_388_608.0;

pub(super) fn render(record: &Record) -> String {
    let largest = peak(&record.acceleration) * 100.0;
    let range = (largest * 1.05).ceil().max(1.0);
    let counts: Vec<f64> = record.acceleration.iter().map(|a| (a * 100.0 / range * FULL_SCALE).round()).collect();
    let rate = 1.0 / record.dt;
    let exact = record.acceleration.len() as f64 * record.dt;
    // The network writes whole seconds; a reader takes none for a broken file.
    let duration = if exact < 1.0 { exact } else { exact.round() };
    let mut text = String::new();
    let mut line = |key: &str, value: &str| {
        let _ = writeln!(text, "{key:<18}{value}");
    };
    for (label, key) in [
        ("Origin Time", "origin time"),
        ("Lat.", "latitude"),
        ("Long.", "longitude"),
        ("Depth. (km)", "depth"),
        ("Mag.", "magnitude"),
        ("Station Code", "station"),
        ("Record Time", "record time"),
    ] {
        line(label, stated(record, key, ""));
    }
    line("Sampling Freq(Hz)", &format!("{rate}Hz"));
    line("Duration Time(s)", &duration.to_string());
    line("Dir.", &record.component);
    line("Scale Factor", &format!("{range}(gal)/{FULL_SCALE}"));
    line("Max. Acc. (gal)", &format!("{:.3}", peak(&counts) * range / FULL_SCALE));
    line("Last Correction", "");
    line("Memo.", NO_OFFSET);
    rows(&mut text, counts.iter().map(|c| format!("{:>8} ", *c + 0.0)), 8);
    text
}
