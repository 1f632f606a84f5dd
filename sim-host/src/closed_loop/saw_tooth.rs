//! The saw-tooth of Fig. 6: what a sine becomes whose velocity lies beyond the limit, and the spikes at its corners.

use super::Trace;

/// What a saturated response shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SawTooth {
    /// Steepest slope of the displacement over a whole tick, m/s: the limit, where it is met.
    pub slope: f64,
    /// Peak acceleration of the table over that of the reference, 1.
    pub spike_ratio: f64,
    /// Share of the time at the limit, 1.
    pub saturated: f64,
    /// Peak displacement, m.
    pub peak: f64,
}

impl SawTooth {
    /// Reads a response to a sine of `amplitude` (m) at `frequency` (Hz), its first half left out.
    pub(crate) fn of(trace: &Trace, (amplitude, frequency): (f64, f64)) -> Self {
        let from = trace.displacement.len() / 2;
        let largest = |values: &[f64]| values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let slopes = trace.displacement[from..].windows(2).map(|w| (w[1] - w[0]).abs() / trace.dt);
        let commanded = amplitude * (std::f64::consts::TAU * frequency).powi(2);
        let flags = &trace.flags[from..];
        Self {
            slope: slopes.fold(0.0, f64::max),
            spike_ratio: largest(&trace.acceleration[from..]) / commanded,
            saturated: flags.iter().filter(|f| f.saturated).count() as f64 / flags.len().max(1) as f64,
            peak: largest(&trace.displacement[from..]),
        }
    }
}
