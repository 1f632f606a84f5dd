//! Strength of a motion: Arias intensity, significant duration, jerk.

use super::super::STANDARD_GRAVITY;
use std::f64::consts::PI;

/// Arias intensity and the duration that holds most of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intensity {
    /// Arias intensity `pi / (2 g) integral of a^2`, m/s (Arias, 1970).
    pub arias: f64,
    /// When 5 % of it has come, s.
    pub start: f64,
    /// Significant duration D5-95, from 5 to 95 % of it, s (Trifunac and Brady, 1975).
    pub d5_95: f64,
}

/// The intensity of an acceleration, m/s², sampled every `dt` s and linear between samples.
pub(crate) fn intensity(acceleration: &[f64], dt: f64) -> Intensity {
    let mut running = vec![0.0];
    for w in acceleration.windows(2) {
        // The exact integral of the square of a straight line.
        let area = dt * (w[0] * w[0] + w[0] * w[1] + w[1] * w[1]) / 3.0;
        running.push(running[running.len() - 1] + area);
    }
    let total = running[running.len() - 1];
    let when = |share: f64| {
        let wanted = share * total;
        let after = running.partition_point(|&x| x < wanted).max(1);
        match (running.get(after - 1), running.get(after)) {
            (Some(a), Some(b)) if b > a => (after as f64 - 1.0 + (wanted - a) / (b - a)) * dt,
            _ => 0.0,
        }
    };
    let start = when(0.05);
    Intensity { arias: PI / (2.0 * STANDARD_GRAVITY) * total, start, d5_95: when(0.95) - start }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_gives_its_closed_form() {
        let found = intensity(&vec![2.0; 1001], 0.01);
        assert!((found.arias - PI / (2.0 * STANDARD_GRAVITY) * 40.0).abs() < 1e-9);
        assert!((found.start - 0.5).abs() < 1e-9 && (found.d5_95 - 9.0).abs() < 1e-9);
        let quiet = intensity(&[0.0; 5], 0.01);
        assert_eq!((quiet.arias, quiet.d5_95), (0.0, 0.0));
        assert_eq!(intensity(&[], 0.01).arias, 0.0);
    }
}
