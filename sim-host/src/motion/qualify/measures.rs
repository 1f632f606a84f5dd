//! What of a motion the rules of a standard look at: its strong part, its steadiness, what two axes share.

use super::super::metrics::Intensity;
use super::super::spectrum::fourier_amplitude;

/// The strong motion of a signal.
pub(super) fn part<'a>(signal: &'a [f64], dt: f64, strength: &Intensity) -> &'a [f64] {
    let at = |t: f64| ((t / dt) as usize).min(signal.len());
    &signal[at(strength.start)..at(strength.start + strength.d5_95)]
}

/// Time from 25 to 75 % of the Arias intensity, s.
pub(super) fn middle(acceleration: &[f64], dt: f64) -> f64 {
    let total: f64 = acceleration.iter().map(|a| a * a).sum();
    let mut sum = 0.0;
    let inside = acceleration.iter().filter(|a| {
        sum += **a * **a;
        sum >= 0.25 * total && sum <= 0.75 * total
    });
    inside.count() as f64 * dt
}

/// Largest factor, either way, between the RMS of a third and of the whole, octave by octave; and where.
pub(super) fn unsteadiness(strong: &[f64], dt: f64, (low, high): (f64, f64)) -> (f64, String) {
    let third = strong.len() / 3;
    if third < 16 {
        return (f64::INFINITY, "the strong motion is too short to be cut in three".into());
    }
    let octaves = ((high / low).log2().floor() as i32).max(1);
    let power = |signal: &[f64], from: f64, to: f64| {
        let (f, a) = fourier_amplitude(signal, dt);
        let sum: f64 = f.iter().zip(&a).filter(|(f, _)| (from..to).contains(*f)).map(|(_, a)| a * a).sum();
        // Padding to a power of two makes the bins of a short part wider.
        sum * f.get(1).copied().unwrap_or(0.0) / signal.len() as f64
    };
    let mut worst = (1.0, String::new());
    for k in 0..octaves {
        let (from, to) = (low * f64::from(k).exp2(), low * f64::from(k + 1).exp2());
        let whole = power(strong, from, to);
        for (i, part) in strong.chunks_exact(third).take(3).enumerate() {
            let ratio = (power(part, from, to) / whole).sqrt();
            let factor = ratio.max(1.0 / ratio);
            if factor > worst.0 {
                worst = (factor, format!("third {} of the strong motion, {from:.1} to {to:.1} Hz", i + 1));
            }
        }
    }
    worst
}

/// Largest correlation of two signals at any shift up to half a second.
pub(super) fn correlation(a: &[f64], b: &[f64], dt: f64) -> f64 {
    let count = a.len().min(b.len());
    let size = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let whole = size(&a[..count]) * size(&b[..count]);
    let most = ((0.5 / dt) as usize).min(count.saturating_sub(1));
    let at =
        |x: &[f64], y: &[f64], lag: usize| x[lag..count].iter().zip(y).map(|(x, y)| x * y).sum::<f64>().abs() / whole;
    // Every millisecond is more than any record holds.
    let step = ((0.001 / dt) as usize).max(1);
    (0..=most).step_by(step).map(|lag| at(a, b, lag).max(at(b, a, lag))).fold(0.0, f64::max)
}
