//! The end of a drive whose form fills up with zeros: a slow return, so that nothing steps.

use super::{Drive, Quantity};
use crate::motion::peak;

/// Shortest return, s.
const SHORTEST: f64 = 2.0;
/// Fastest, as a share of the drive's own speed.
const SLOWLY: f64 = 0.05;
/// An end this near to zero, as a share of the peak, is zero.
const NOTHING: f64 = 1e-6;
/// A drive is at rest at its end where its speed there is no more than this share of its largest.
const RESTS: f64 = 1e-2;

impl Drive {
    /// Lets a displacement that ends at rest away from zero go back there, along a polynomial of fifth degree; gives the time that it
    /// takes, s. None where nothing was added: it ends at zero, it is none of displacement, or it ends in motion.
    pub(crate) fn return_to_zero(&mut self) -> Option<f64> {
        let speed: Vec<f64> = self.values.windows(2).map(|w| (w[1] - w[0]) / self.dt).collect();
        let (end, fastest) = (*self.values.last()?, peak(&speed));
        let rests = speed.last()?.abs() <= RESTS * fastest;
        if self.quantity != Quantity::Displacement || end.abs() <= NOTHING * peak(&self.values) || !rests {
            return None;
        }
        // The polynomial's largest speed is 15/8 of its mean.
        let time = (1.875 * end.abs() / (SLOWLY * fastest)).max(SHORTEST);
        let count = (time / self.dt).ceil();
        self.values.extend((1..=count as usize).map(|k| {
            let s = k as f64 / count;
            end * (1.0 - s * s * s * (10.0 - 15.0 * s + 6.0 * s * s))
        }));
        Some(count * self.dt)
    }
}
