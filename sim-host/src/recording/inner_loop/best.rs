//! Which terms a law has: every set is fitted, and the one kept that explains the target best for what it costs.

use super::band::{Band, Order};
use super::fit::{Fitted, Problem, Timing};
use super::{CLEARLY, Gain, LAG, Log, ROUNDS, Term, WORTH, spread};

/// A fit with the terms it kept.
pub(super) struct Reduced {
    pub(super) gains: Vec<Gain>,
    pub(super) timing: Timing,
    pub(super) misses: f64,
}

/// What a fit leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Noise {
    /// Noise, whose power is measured frequency by frequency and weighs the fit.
    Measured,
    /// What a delay and a lag do not say of valve and table.
    Unmodelled,
}

/// The set of terms that explains the target best for what it costs: every set that holds the error is tried. Leaving terms out one at
/// a time would not do, for the table itself makes velocity, acceleration and command nearly dependent, so that of two wrong terms
/// each hides the right one.
pub(super) fn best(
    logs: &[Log],
    bands: &[Band],
    terms: &[Term],
    noise: Noise,
    target: impl Fn(&Log, &Band) -> Vec<nalgebra::Complex<f64>>,
) -> Option<Reduced> {
    let parts = logs
        .iter()
        .zip(bands)
        .map(|(log, band)| band.part(target(log, band), terms.iter().map(|term| spectrum(*term, log, band)).collect()));
    let mut whole = Problem::new(parts.collect(), terms.iter().position(|t| *t == Term::Velocity));
    let all = vec![true; terms.len()];
    let mut start = whole.search(&all, noise == Noise::Unmodelled)?;
    if noise == Noise::Measured {
        for _ in 0..ROUNDS {
            whole.weigh(&start, &all);
            start = whole.near(&all, start.timing, false)?;
        }
    }
    let count = whole.count();
    let polarity = polarity(&whole, terms);
    let mut best: Option<(f64, Vec<bool>, Fitted)> = None;
    for set in 0..1usize << terms.len() {
        let active: Vec<bool> = (0..terms.len()).map(|i| set >> i & 1 == 1).collect();
        if !terms.iter().zip(&active).any(|(t, on)| *t == Term::Error && *on) {
            continue;
        }
        let fitted = if noise == Noise::Measured {
            whole.near(&active, start.timing, false)
        } else {
            whole.search(&active, true)
        };
        // The table itself makes the command from velocity and acceleration; a loop that pushes away from its reference is that.
        let Some(fitted) = fitted.filter(|f| f.gains[0] * polarity > 0.0) else { continue };
        let size = active.iter().filter(|on| **on).count() as f64;
        let cost = match noise {
            // Twice the logarithm of the likelihood, less what the terms cost.
            Noise::Measured => fitted.squares * (count / start.squares) + WORTH * size * count.ln(),
            Noise::Unmodelled => 2.0 * fitted.misses.ln() + 2.0 * size * CLEARLY.ln(),
        };
        if best.as_ref().is_none_or(|(least, _, _)| cost < *least) {
            best = Some((cost, active, fitted));
        }
    }
    let (cost, active, mut fitted) = best?;
    if noise == Noise::Measured
        && let Some(lagging) = whole.near(&active, Timing { lag: LAG, ..fitted.timing }, true)
    {
        let size = active.iter().filter(|on| **on).count() as f64 + 1.0;
        if lagging.squares * (count / start.squares) + WORTH * size * count.ln() < cost {
            fitted = lagging;
        }
    }
    let up_to = bands.iter().map(|b| b.excited).fold(0.0, f64::max) * std::f64::consts::TAU;
    let misses = whole.missed(&fitted, &active, up_to);
    let errors = spread::errors(&whole, &active, &fitted);
    let gains = (0..terms.len()).filter(|i| active[*i]).map(|i| Gain {
        term: terms[i],
        value: fitted.gains[i],
        std: errors[i],
        share: fitted.share[i],
    });
    Some(Reduced { gains: gains.collect(), timing: fitted.timing, misses })
}

/// The sign of the motion that a positive command makes; 1 where no velocity is among the terms.
fn polarity(problem: &Problem, terms: &[Term]) -> f64 {
    // The term is the velocity's negative.
    terms.iter().position(|t| *t == Term::Velocity).map_or(1.0, |i| if problem.along(i) > 0.0 { -1.0 } else { 1.0 })
}

/// A term's spectrum in the band.
fn spectrum(term: Term, log: &Log, band: &Band) -> Vec<nalgebra::Complex<f64>> {
    let error = || -> Vec<f64> { log.reference.iter().zip(&log.displacement).map(|(r, x)| r - x).collect() };
    let negative = |x: Vec<nalgebra::Complex<f64>>| x.into_iter().map(|c| -c).collect();
    match term {
        Term::Error => band.spectrum(&error(), Order::Itself),
        Term::Integral => band.spectrum(&error(), Order::Integral),
        Term::ReferenceRate => band.spectrum(&log.reference, Order::First),
        Term::ReferenceAcceleration => band.spectrum(&log.reference, Order::Second),
        Term::Velocity => negative(band.spectrum(&log.displacement, Order::First)),
        Term::Acceleration => negative(match &log.acceleration {
            Some(measured) => band.spectrum(measured, Order::Itself),
            None => band.spectrum(&log.displacement, Order::Second),
        }),
        Term::Pressure => negative(log.pressure.as_ref().map_or_else(Vec::new, |p| band.spectrum(p, Order::Itself))),
    }
}
