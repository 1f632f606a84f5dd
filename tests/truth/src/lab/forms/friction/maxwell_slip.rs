//! Generalised Maxwell slip: ten elasto-sliding elements in parallel, each sticking as a spring until its share of the level
//! and then following the Stribeck curve with a rate of attraction.

use super::Levels;
use crate::lab::law::{Law, Now};

const ELEMENTS: usize = 10;
/// Attraction of a sliding element to the curve, times the level (1/s): high, as at lubricated guides.
const ATTRACTION: f64 = 400.0;

/// The contact. Memories: force of each element, and whether it slips.
#[derive(Debug, Clone, Copy)]
pub struct MaxwellSlip {
    levels: Levels,
    share: [f64; ELEMENTS],
    stiffness: [f64; ELEMENTS],
}

impl MaxwellSlip {
    /// Elements whose slip distances spread over a decade about `presliding` (m).
    pub fn new(levels: Levels, presliding: f64) -> Self {
        let share = [1.0 / ELEMENTS as f64; ELEMENTS];
        let stiffness = std::array::from_fn(|i| {
            let distance = presliding * 10.0_f64.powf(i as f64 / (ELEMENTS - 1) as f64 - 0.5);
            share[i] * levels.sliding.max(1e-9) / distance
        });
        Self { levels, share, stiffness }
    }
}

impl Law for MaxwellSlip {
    fn memories(&self) -> usize {
        2 * ELEMENTS
    }

    fn remember(&self, now: &Now, _: f64, h: f64, m: &mut [f64]) {
        let direction = now.v.signum();
        let level = self.levels.at(now.v);
        for i in 0..ELEMENTS {
            let bound = self.share[i] * level;
            let slips = m[ELEMENTS + i] != 0.0;
            if slips && m[ELEMENTS + i] != direction {
                m[ELEMENTS + i] = 0.0;
            }
            if m[ELEMENTS + i] == 0.0 {
                m[i] += self.stiffness[i] * now.v * h;
                if m[i].abs() >= bound && m[i] * direction > 0.0 {
                    m[i] = direction * m[i].abs().min(self.share[i] * self.levels.breakaway);
                    m[ELEMENTS + i] = direction;
                }
            } else {
                let aim = direction * bound;
                m[i] = aim + (m[i] - aim) * (-ATTRACTION * h).exp();
            }
        }
    }

    fn out(&self, _: &Now, input: f64, _: &[f64], m: &[f64]) -> f64 {
        input + m[..ELEMENTS].iter().sum::<f64>()
    }
}
