//! Dry contact before and while it slides: the state that dry friction remembers.
//!
//! Asperities bend like bristles before a contact slides. Dahl's model of it depends on travel alone: over travel in one
//! direction the bristles' share of the sliding force approaches one as `1 - exp(-travel/length)`. So it is exact for
//! steps of any length and needs no smoothed sign, and a table at rest rests: it neither creeps nor chatters.
//!
//! Source: P. R. Dahl, "A solid friction model", Aerospace Corporation TOR-0158(3107-18)-1 (1968).

use crate::scalar::Scalar;

/// Bristles between two surfaces.
#[derive(Debug, Clone)]
pub(super) struct Bristles<S> {
    /// Travel over which they bend before they slide, m.
    length: S,
    /// Share of the sliding force they carry, -1 to 1, where they were seen last.
    share: S,
    /// Displacement there, m; none before the first step.
    place: Option<S>,
}

impl<S: Scalar> Bristles<S> {
    /// Unbent bristles that slide after bending over `length` metres.
    pub(super) fn new(length: S) -> Self {
        Self { length, share: S::from(0.0), place: None }
    }

    /// The share of the sliding force they carry with the table at `displacement` (m).
    pub(super) fn share(&self, displacement: S) -> S {
        let travel = displacement - self.place.unwrap_or(displacement);
        let end = S::from(if travel.value() < 0.0 { -1.0 } else { 1.0 });
        end + (self.share - end) * (-(travel.abs() / self.length)).exp()
    }

    /// Remembers where they are.
    pub(super) fn settle(&mut self, displacement: S) {
        self.share = self.share(displacement);
        self.place = Some(displacement);
    }

    /// The rate at which a table held by `force` per mass (m/s2) swings on them, 1/s.
    pub(super) fn rate(&self, force: f64) -> f64 {
        2.0 * (force.abs() / self.length.value().max(1e-9)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over a reversal from sliding the share falls as `2 exp(-travel/length) - 1`, whatever the steps.
    #[test]
    fn a_reversal_depends_on_travel_alone() {
        let after = |steps: usize| {
            let mut bristles = Bristles::<f64>::new(1e-5);
            bristles.settle(0.0);
            bristles.settle(1e-3);
            (1..=steps).for_each(|k| bristles.settle(1e-3 - 2e-5 * k as f64 / steps as f64));
            bristles.share(1e-3 - 2e-5)
        };
        let exact = 2.0 * (-2.0f64).exp() - 1.0;
        assert!((after(1) - exact).abs() < 1e-12 && (after(7) - exact).abs() < 1e-12, "{} {exact}", after(7));
    }
}
