//! Numbers for a run, from the campaign's seed and the run's number alone.

use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub struct FaultRng {
    generator: ChaCha8Rng,
    /// Numbers that come before the generator's own, last first.
    script: Vec<f64>,
}

impl FaultRng {
    /// The stream `number` of `seed`.
    pub fn new(seed: u64, number: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(number);
        Self { generator, script: Vec::new() }
    }

    /// The same, with these numbers in [0, 1) before its own.
    pub fn scripted(seed: u64, number: u64, mut script: Vec<f64>) -> Self {
        script.reverse();
        Self { script, ..Self::new(seed, number) }
    }

    /// Uniform in [0, 1), 53 bits.
    pub fn unit(&mut self) -> f64 {
        let own = |generator: &mut ChaCha8Rng| (generator.next_u64() >> 11) as f64 / 9_007_199_254_740_992.0;
        self.script.pop().unwrap_or_else(|| own(&mut self.generator))
    }

    /// Uniform from `low` to `high`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in its logarithm from `low` to `high`, both above zero.
    pub fn scale(&mut self, low: f64, high: f64) -> f64 {
        (self.uniform(low.ln(), high.ln())).exp()
    }

    /// A whole number below `count`, which is not zero.
    pub fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// True this share of the time.
    pub fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }

    /// 1 or -1.
    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// Of mean 0 and variance 1, near enough Gaussian.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }

    /// Any 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.generator.next_u64()
    }
}
