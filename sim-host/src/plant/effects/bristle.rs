//! Dry contact before and while it slides: the state that dry friction remembers.
//!
//! Asperities bend like bristles before a contact slides. Dahl's model of it, `dz/dt = (v - |v| z)/s`, depends on travel alone:
//! over travel in one direction the bristles' share of the sliding force approaches one as `1 - exp(-travel/length)`. So it
//! is exact for steps of any length and needs no smoothed sign, and a table at rest rests: it neither creeps nor chatters.
//!
//! A loop at work never quite rests. The noise of its displacement sensor reaches the valve and shakes the contact to and
//! fro, which moves nothing on average but bends bristles back: `|v|` is its mean over that noise. A table that is pushed
//! while it is held by friction creeps by that, where it would stand.
//!
//! Source: P. R. Dahl, "A solid friction model", Aerospace Corporation TOR-0158(3107-18)-1 (1968).

use super::shaken::magnitude;
use crate::scalar::Scalar;

/// Travel over the bristles' length after which nothing is left of how they stood.
const SLID: f64 = 40.0;

/// Bristles between two surfaces.
#[derive(Debug, Clone)]
pub(super) struct Bristles<S> {
    /// Travel over which they bend before they slide, m.
    length: S,
    /// Share of the sliding force they carry, -1 to 1, where they were seen last.
    share: S,
    /// Displacement there, m; none before the first step.
    place: Option<S>,
    /// When that was, s.
    time: f64,
    /// Standard deviation of the velocity of the noise that shakes them, m/s.
    noise: f64,
}

impl<S: Scalar> Bristles<S> {
    /// Unbent bristles that slide after bending over `length` metres.
    pub(super) fn new(length: S) -> Self {
        Self { length, share: S::from(0.0), place: None, time: 0.0, noise: 0.0 }
    }

    /// Has them shaken by noise of this standard deviation, m/s.
    pub(super) fn shake(&mut self, noise: f64) {
        self.noise = noise;
    }

    /// The share of the sliding force they carry with the table at `displacement` (m) at `time` (s).
    pub(super) fn share(&self, displacement: S, time: f64) -> S {
        let travel = displacement - self.place.unwrap_or(displacement);
        let shaken = self.noise * (time - self.time).max(0.0);
        let (way, end) = if shaken > 0.0 {
            let way = magnitude(travel, S::from(shaken));
            (way, travel / way)
        } else {
            (travel.abs(), S::from(if travel.value() < 0.0 { -1.0 } else { 1.0 }))
        };
        let bent = way / self.length;
        // So far on, what was is lost in the last digit, and its derivatives are too small for the processor to be quick at.
        if bent.value() > SLID { end } else { end + (self.share - end) * (-bent).exp() }
    }

    /// Remembers where they are, and when.
    pub(super) fn settle(&mut self, displacement: S, time: f64) {
        self.share = self.share(displacement, time);
        (self.place, self.time) = (Some(displacement), time);
    }

    /// The rate at which a table held by `force` per mass (m/s2) swings on them, 1/s.
    pub(super) fn rate(&self, force: f64) -> f64 {
        2.0 * (force.abs() / self.length.value().max(1e-9)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    /// Over a reversal from sliding the share falls as `2 exp(-travel/length) - 1`, whatever the steps.
    #[test]
    fn a_reversal_depends_on_travel_alone() {
        let after = |steps: usize| {
            let mut bristles = Bristles::<f64>::new(1e-5);
            bristles.settle(0.0, 0.0);
            bristles.settle(1e-3, 0.0);
            (1..=steps).for_each(|k| bristles.settle(1e-3 - 2e-5 * k as f64 / steps as f64, 0.0));
            bristles.share(1e-3 - 2e-5, 0.0)
        };
        let exact = 2.0 * (-2.0f64).exp() - 1.0;
        assert!((after(1) - exact).abs() < 1e-12 && (after(7) - exact).abs() < 1e-12, "{} {exact}", after(7));
    }

    /// Bent bristles that noise shakes let go as those do that are moved to and fro by that noise, tick by tick.
    #[test]
    fn noise_bends_back_what_it_shakes() {
        let (length, noise, dt) = (2e-5, 5e-5, 1e-3);
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut gauss = || (0..12).map(|_| f64::from(random.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0;
        let (mut moved, mut shaken) = (Bristles::<f64>::new(length), Bristles::<f64>::new(length));
        for bristles in [&mut moved, &mut shaken] {
            bristles.settle(-1e-3, 0.0);
            bristles.settle(0.0, 0.0);
        }
        shaken.shake(noise);
        let (mut place, mut off) = (0.0, 0.0);
        for k in 1..=2000 {
            let time = f64::from(k) * dt;
            // Noise that comes back: the loop lets no place drift away.
            place = 0.9 * place + noise * dt * gauss();
            moved.settle(place, time);
            shaken.settle(0.0, time);
            off += (moved.share(place, time) - shaken.share(0.0, time)) / 2000.0;
        }
        assert!(shaken.share(0.0, 2.0) < 0.05 && off.abs() < 0.05, "{} {off}", shaken.share(0.0, 2.0));
    }
}
