//! Frequencies at which no motion within the limits satisfies a standard, whatever grid of points a laboratory lays.

use super::super::super::fit::Limits;
use super::super::Requirement;
use super::bound::reachable;

/// A frequency that no motion within the limits reaches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unreachable {
    /// Hz.
    pub frequency: f64,
    /// What is required there at the least, allowed dips included, m/s2.
    pub required: f64,
    /// What no motion passes, m/s2.
    pub bound: f64,
    /// Which limit it follows from.
    pub limit: &'static str,
}

/// The frequencies at which what is required is beyond what any motion reaches, dips taken into account: a single point may lie
/// below by so much, never two neighbours, never more than so many.
pub(super) fn unreachable(asked: Requirement<'_>, limits: &Limits) -> Vec<Unreachable> {
    let Requirement { standard, required, lowest } = asked;
    // A laboratory may lay the points where it likes: two of them per octave and offset are always in a band as wide as their distance.
    let each = f64::from(standard.per_octave as u32) * 12.0;
    let count = ((standard.band.1 / lowest).log2() * each + 1e-9).floor() as usize;
    let deepest = 1.0 - standard.dips.map_or(0.0, |(deep, _)| deep);
    let short = |share: f64| -> Vec<Unreachable> {
        (0..=count)
            .filter_map(|k| {
                let frequency = lowest * (k as f64 / each).exp2();
                let (bound, limit) = reachable(1.0 / frequency, required.damping, limits);
                let required = share * required.at(frequency)?;
                (bound < required).then_some(Unreachable { frequency, required, bound, limit })
            })
            .collect()
    };
    let mut found = beyond_grid(short(deepest), 1.0, each, standard.per_octave);
    if found.is_empty() {
        // Two neighbours of every grid below what is required: no dip is allowed then.
        found = beyond_grid(short(1.0), 2.0, each, standard.per_octave);
    }
    if found.is_empty() {
        let least = standard.zero_period * required.zero_period();
        let most = [limits.acceleration, limits.stall].into_iter().flatten().fold(f64::INFINITY, f64::min);
        if most < least {
            found.push(Unreachable { frequency: f64::INFINITY, required: least, bound: most, limit: "acceleration" });
        }
    }
    found
}

/// What is left of frequencies that lie so close that every grid has `points` neighbouring points in a stretch of them.
fn beyond_grid(short: Vec<Unreachable>, points: f64, each: f64, per_octave: usize) -> Vec<Unreachable> {
    let step = 1.0 / each;
    let width = points / per_octave as f64;
    let mut kept = Vec::new();
    let mut run: Vec<Unreachable> = Vec::new();
    let wide = |run: &[Unreachable]| {
        let (Some(first), Some(last)) = (run.first(), run.last()) else { return false };
        (last.frequency / first.frequency).log2() >= width - step - 1e-9
    };
    for u in short {
        if run.last().is_some_and(|before| (u.frequency / before.frequency).log2() > 1.5 * step) {
            if wide(&run) {
                kept.append(&mut run);
            }
            run.clear();
        }
        run.push(u);
    }
    if wide(&run) {
        kept.append(&mut run);
    }
    kept
}
