//! What no motion within a table's limits can pass at a period, of any length and any shape.
//!
//! The absolute acceleration of an oscillator is `integral h(t - s) x''(s) ds`, h its impulse response, the table at rest before. By
//! parts, with |x''| <= A, |x'| <= V, |x| <= X and TV the total variation over t > 0:
//! ```text
//! |.| <= A TV(s)                                             s the step response, s' = h
//! |.| <= V (|h(0)| + TV(h))
//! |.| <= |h(0)| V + X (|h'(0)| + TV(h'))
//! ```
//! The least of them holds. All three responses are exp(-d t) (a cos w t + b sin w t) but for a constant, whose extremes shrink by
//! exp(-pi d / w) each half cycle, so the variations are closed forms.

use super::super::super::fit::Limits;
use std::f64::consts::{PI, TAU};

/// exp(-d t) (a cos w t + b sin w t).
#[derive(Debug, Clone, Copy)]
struct Ringing {
    a: f64,
    b: f64,
    decay: f64,
    damped: f64,
}

impl Ringing {
    /// Total variation over t > 0.
    fn variation(&self) -> f64 {
        let Self { a, b, decay: d, damped: w } = *self;
        // The derivative is exp(-d t) ((w b - d a) cos w t - (d b + w a) sin w t).
        let angle = (w * b - d * a).atan2(d * b + w * a).rem_euclid(PI);
        let angle = if angle < 1e-12 { PI } else { angle };
        let first = (-d * angle / w).exp() * (a * angle.cos() + b * angle.sin());
        let shrink = (-d * PI / w).exp();
        (first - a).abs() + first.abs() * (1.0 + shrink) / (1.0 - shrink)
    }
}

/// The bound on the absolute spectral acceleration, m/s2, and the limit it follows from, at a period, s.
pub fn reachable(period: f64, damping: f64, limits: &Limits) -> (f64, &'static str) {
    let natural = TAU / period;
    let (d, w) = (damping * natural, natural * (1.0 - damping * damping).sqrt());
    let ringing = |a: f64, b: f64| Ringing { a, b, decay: d, damped: w };
    // h = exp(-d t) (2 d cos + (w - d^2 / w) sin), its integral 1 - exp(-d t) (cos - d / w sin).
    let (jump, rise) = (2.0 * d, w - d * d / w);
    let by_velocity = limits.velocity * (jump + ringing(jump, rise).variation());
    let slope = (w * rise - d * jump, -d * rise - w * jump);
    let by_stroke =
        limits.stroke.map(|x| jump * limits.velocity + x * (slope.0.abs() + ringing(slope.0, slope.1).variation()));
    let most = [limits.acceleration, limits.stall].into_iter().flatten().fold(f64::INFINITY, f64::min);
    let by_acceleration = most * ringing(-1.0, d / w).variation();
    let all = [
        (by_velocity, "velocity"),
        (by_stroke.unwrap_or(f64::INFINITY), "stroke"),
        (by_acceleration, if limits.stall.is_some_and(|s| s <= most) { "flow under load" } else { "acceleration" }),
    ];
    all.into_iter().fold((f64::INFINITY, "none"), |least, next| if next.0 < least.0 { next } else { least })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::fit::spectrum::Oscillator;
    use crate::motion::spectrum::response_spectrum;

    fn only(velocity: f64, stroke: Option<f64>, acceleration: Option<f64>) -> Limits {
        Limits { stroke, acceleration, ..Limits::velocity(velocity) }
    }

    #[test]
    fn the_velocity_bound_is_the_one_that_fits_use() {
        for period in [0.05, 0.3, 1.5] {
            let (bound, limit) = reachable(period, 0.05, &only(0.3, None, None));
            let known = 0.3 * Oscillator::new(period, 0.05).variation();
            // That one leaves the jump of h out, which adds 2 d V.
            let jump = 0.3 * 2.0 * 0.05 * TAU / period;
            assert!(
                limit == "velocity" && bound >= known * (1.0 - 1e-9) && bound <= known + jump + 1e-9,
                "{bound} {known}"
            );
        }
    }

    /// Resonance of a switching acceleration, and of a switching displacement, comes near each bound and never passes it.
    #[test]
    fn switching_comes_near_every_bound_and_passes_none() {
        let (period, dt) = (0.4, 5e-4);
        let half = |k: usize| (k as f64 * dt / (period / 2.0)) as usize;
        let square = |k: usize| if half(k).is_multiple_of(2) { 1.0 } else { -1.0 };
        let acceleration: Vec<f64> = (0..80_000).map(|k| 2.0 * square(k)).collect();
        let s_a = |a: &[f64]| response_spectrum(a, dt, 0.05, &[period]).unwrap().s_a[0];
        let (bound, _) = reachable(period, 0.05, &only(1e3, None, Some(2.0)));
        let got = s_a(&acceleration);
        assert!(got <= bound && got > 0.98 * bound, "{got} {bound}");
        // A smooth oscillation of the stroke reaches pi / 4 of what a switching one would.
        let x = 0.01;
        let sine: Vec<f64> =
            (0..80_000).map(|k| -x * (TAU / period).powi(2) * (TAU / period * f64::from(k) * dt).sin()).collect();
        let (bound, limit) = reachable(period, 0.05, &only(x * TAU / period * 1.01, Some(x), None));
        let got = s_a(&sine);
        assert!(got <= bound && got > 0.7 * bound, "{got} {bound} {limit}");
    }
}
