//! Plays of several widths about the gap's: a worn joint that closes over a part of it.

use crate::lab::law::{Law, Now};

const PLAYS: usize = 12;

/// The joint. Memories: place within each play (m).
#[derive(Debug, Clone, Copy)]
pub struct Hysteron {
    half: [f64; PLAYS],
}

impl Hysteron {
    /// Plays whose widths spread evenly over `spread` of the gap (m) on either side of it.
    pub fn new(gap: f64, spread: f64) -> Self {
        let at = |i: usize| 2.0 * i as f64 / (PLAYS - 1) as f64 - 1.0;
        Self { half: std::array::from_fn(|i| 0.5 * gap * (1.0 + spread * at(i))) }
    }
}

impl Law for Hysteron {
    fn memories(&self) -> usize {
        PLAYS
    }

    fn remember(&self, _: &Now, input: f64, h: f64, m: &mut [f64]) {
        for (place, half) in m.iter_mut().zip(&self.half) {
            *place = (*place + input * h).clamp(-half, *half);
        }
    }

    fn out(&self, _: &Now, input: f64, _: &[f64], m: &[f64]) -> f64 {
        // A play passes the motion over the last hundredth of its width.
        let passed = m.iter().zip(&self.half).map(|(place, half)| {
            let filled = place * input.signum() / half;
            ((filled - 0.98) / 0.02).clamp(0.0, 1.0)
        });
        input * passed.sum::<f64>() / PLAYS as f64
    }
}
