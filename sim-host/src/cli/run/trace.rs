//! The run as a recording that `identify` and `diagnose` read.

use super::super::Failure;
use super::super::output::write_whole;
use crate::closed_loop::Trace;
use std::fmt::Write as _;
use std::path::Path;

/// Writes one row a tick, as the sensors gave it.
pub(super) fn write(path: &Path, trace: &Trace) -> Result<(), Failure> {
    let mut text = String::from(
        "time [s],reference [m],commanded [m],command [1],displacement [m],velocity [m/s],acceleration [m/s2],saturated [1]\n",
    );
    let columns = trace.reference.iter().zip(&trace.commanded).zip(&trace.command);
    let measured = trace.measured_displacement.iter().zip(&trace.velocity).zip(&trace.measured_acceleration);
    for (k, ((((r, c), u), ((x, v), a)), flags)) in columns.zip(measured).zip(&trace.flags).enumerate() {
        let time = k as f64 * trace.dt;
        let _ = writeln!(text, "{time:.6},{r:e},{c:e},{u:e},{x:e},{v:e},{a:e},{}", u8::from(flags.saturated));
    }
    write_whole(path, text.as_bytes())
}
