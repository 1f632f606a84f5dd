//! Seeded ground motions, so that everything runs with no file: a near-field velocity pulse on shaped noise.
//!
//! The pulse is that of Mavroeidis and Papageorgiou (2003), Eq. 3: over `|t - t0| <= gamma / (2 fp)`
//! ```text
//! v(t) = A/2 [1 + cos(2 pi fp (t - t0) / gamma)] cos(2 pi fp (t - t0) + nu)
//! ```
//! The noise is white, band-passed, and shaped by Jennings' envelope: a parabola up, a plateau, an exponential down. What
//! velocity and displacement are left at the end is taken out by two slow waves, so that the motion ends at rest where it
//! began. A seed gives the same record everywhere: sine, cosine and exponential are `libm`'s, not the platform's, whose last bits
//! would be other ones in a browser.

use super::condition::MAX_SAMPLES;
use super::filter::{Band, Butterworth, FilterError, Pass};
use super::{Fact, Format, Motion, Record, peak};
use libm::{cos, exp, sin};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;

/// A velocity pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pulse {
    /// Amplitude `A`, m/s.
    pub amplitude: f64,
    /// Prevailing frequency `fp`, Hz.
    pub frequency: f64,
    /// Oscillations `gamma`, over 1.
    pub oscillations: f64,
    /// Phase `nu`, rad.
    pub phase: f64,
    /// Time of the envelope's peak `t0`, s.
    pub time: f64,
}

impl Pulse {
    /// Velocity at a time (s), m/s.
    pub fn velocity(&self, time: f64) -> f64 {
        let (slow, fast, inside) = self.angles(time);
        if inside { 0.5 * self.amplitude * (1.0 + cos(slow)) * cos(fast + self.phase) } else { 0.0 }
    }

    /// Acceleration at a time (s), m/s².
    pub fn acceleration(&self, time: f64) -> f64 {
        let (slow, fast, inside) = self.angles(time);
        if !inside {
            return 0.0;
        }
        let fast = fast + self.phase;
        let bracket = sin(slow) * cos(fast) + self.oscillations * sin(fast) * (1.0 + cos(slow));
        -self.amplitude * PI * self.frequency / self.oscillations * bracket
    }

    /// Angles of envelope and oscillation, and whether the time is within the pulse.
    fn angles(&self, time: f64) -> (f64, f64, bool) {
        let fast = 2.0 * PI * self.frequency * (time - self.time);
        let slow = fast / self.oscillations;
        (slow, fast, slow.abs() <= PI)
    }
}

/// Band-passed noise under an envelope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Largest acceleration, m/s².
    pub peak: f64,
    /// Lower corner, Hz.
    pub low: f64,
    /// Upper corner, Hz.
    pub high: f64,
    /// When the envelope reaches its plateau, s.
    pub rise: f64,
    /// When it leaves it, s.
    pub fall: f64,
    /// How fast it then decays, 1/s.
    pub decay: f64,
}

impl Noise {
    /// The envelope at a time (s), 0 to 1.
    fn envelope(&self, time: f64) -> f64 {
        if time < self.rise { (time / self.rise).powi(2) } else { exp(-self.decay * (time - self.fall).max(0.0)) }
    }
}

/// What a generated record is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recipe {
    /// Its name.
    pub name: &'static str,
    /// The pulse; none for a far-field record.
    pub pulse: Option<Pulse>,
    /// The noise.
    pub noise: Noise,
    /// Length, s.
    pub duration: f64,
    /// Sampling rate, Hz.
    pub rate: f64,
}

/// A strong near-field motion, of the kind of Kobe and Rinaldi: 0.5 to 0.95 g, 0.65 to 1.2 m/s, 0.1 to 0.35 m over
/// the first twenty seeds.
pub const NEAR_FIELD_STRONG: Recipe = Recipe {
    name: "near-field-strong",
    pulse: Some(Pulse { amplitude: 0.9, frequency: 0.9, oscillations: 1.8, phase: 0.6, time: 6.0 }),
    noise: Noise { peak: 3.5, low: 0.4, high: 10.0, rise: 4.0, fall: 9.0, decay: 0.25 },
    duration: 40.0,
    rate: 200.0,
};

/// A moderate near-field motion: 0.2 to 0.45 g, 0.243 to 0.5 m/s, over what the paper's table can follow.
pub const NEAR_FIELD_MODERATE: Recipe = Recipe {
    name: "near-field-moderate",
    pulse: Some(Pulse { amplitude: 0.34, frequency: 0.7, oscillations: 1.5, phase: 0.0, time: 5.0 }),
    noise: Noise { peak: 2.0, low: 0.5, high: 10.0, rise: 3.0, fall: 8.0, decay: 0.3 },
    duration: 35.0,
    rate: 200.0,
};

/// A far-field motion, of the kind of Taft: 0.15 g, long, no pulse, within what the paper's table can follow.
pub const FAR_FIELD: Recipe = Recipe {
    name: "far-field",
    pulse: None,
    noise: Noise { peak: 1.5, low: 0.4, high: 8.0, rise: 5.0, fall: 18.0, decay: 0.12 },
    duration: 55.0,
    rate: 200.0,
};

/// Every recipe with a name.
pub const RECIPES: [Recipe; 3] = [NEAR_FIELD_STRONG, NEAR_FIELD_MODERATE, FAR_FIELD];

/// Why a record cannot be generated.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GenerateError {
    /// A noise band that cannot be made at the sampling rate.
    #[error("noise band: {0}")]
    Band(#[from] FilterError),
    /// Too few samples or too many.
    #[error("{0} samples: expected 16 to {MAX_SAMPLES}")]
    Samples(f64),
}

impl Recipe {
    /// The recipe of a name.
    pub fn named(name: &str) -> Option<Self> {
        RECIPES.into_iter().find(|r| r.name == name)
    }

    /// The record that a seed makes.
    pub fn generate(&self, seed: u64) -> Result<Record, GenerateError> {
        let samples = (self.duration * self.rate).round() + 1.0;
        if !(16.0..=MAX_SAMPLES as f64).contains(&samples) {
            return Err(GenerateError::Samples(samples));
        }
        let (count, dt) = (samples as usize, 1.0 / self.rate);
        let mut acceleration = self.noise(seed, count, dt)?;
        for (k, a) in acceleration.iter_mut().enumerate() {
            *a += self.pulse.map_or(0.0, |p| p.acceleration(k as f64 * dt));
        }
        let facts = vec![
            Fact { key: "recipe", value: self.name.to_owned(), line: 0 },
            Fact { key: "seed", value: seed.to_string(), line: 0 },
        ];
        Ok(Record {
            name: format!("{}-{seed}", self.name),
            dt,
            acceleration: ending_at_rest(&acceleration, dt),
            component: String::new(),
            format: Format::Generated,
            facts,
        })
    }

    fn noise(&self, seed: u64, count: usize, dt: f64) -> Result<Vec<f64>, FilterError> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let white: Vec<f64> = (0..count).map(|_| gaussian(&mut rng)).collect();
        let band = Butterworth { band: Band::BandPass(self.noise.low, self.noise.high), order: 3 };
        let mut shaped = band.apply(&white, dt, Pass::Causal)?;
        for (k, a) in shaped.iter_mut().enumerate() {
            *a *= self.noise.envelope(k as f64 * dt);
        }
        let scale = self.noise.peak / peak(&shaped).max(f64::MIN_POSITIVE);
        Ok(shaped.iter().map(|a| a * scale).collect())
    }
}

/// A number of mean 0 and variance 1, near enough Gaussian: twelve uniform ones, whose sum needs no function of the
/// platform.
fn gaussian(rng: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| f64::from(rng.next_u32()) / 4_294_967_296.0).sum::<f64>() - 6.0
}

/// The acceleration less the two slow waves that bring velocity and displacement back to zero at its end.
fn ending_at_rest(acceleration: &[f64], dt: f64) -> Vec<f64> {
    let n = acceleration.len();
    let end = |a: &[f64]| {
        let motion = Motion::from_acceleration(dt, a.to_vec());
        (motion.velocity[n - 1], motion.displacement[n - 1])
    };
    // Both begin and end at zero: one moves the velocity, both the displacement.
    let wave = |f: fn(f64) -> f64| -> Vec<f64> { (0..n).map(|k| f(PI * k as f64 / (n - 1) as f64)).collect() };
    let (once, twice) = (wave(|s| sin(s).powi(2)), wave(|s| sin(s) * sin(2.0 * s)));
    let ((v1, x1), (v2, x2)) = (end(&once), end(&twice));
    let (v, x) = end(acceleration);
    let determinant = v1 * x2 - v2 * x1;
    let (c1, c2) = ((v * x2 - v2 * x) / determinant, (v1 * x - v * x1) / determinant);
    acceleration.iter().zip(once.iter().zip(&twice)).map(|(a, (p, q))| a - c1 * p - c2 * q).collect()
}

#[cfg(test)]
mod tests {
    use super::super::STANDARD_GRAVITY;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn each_recipe_is_as_strong_as_it_says() {
        for (recipe, g, velocity, displacement) in [
            (NEAR_FIELD_STRONG, 0.5..0.95, 0.65..1.2, 0.1..0.35),
            (NEAR_FIELD_MODERATE, 0.2..0.45, 0.243..0.5, 0.03..0.2),
            (FAR_FIELD, 0.14..0.16, 0.05..0.242, 0.0..0.1),
        ] {
            for seed in 0..20 {
                let (x, v, a) = recipe.generate(seed).unwrap().motion().peaks();
                assert!(g.contains(&(a / STANDARD_GRAVITY)), "{} {seed}: {} g", recipe.name, a / STANDARD_GRAVITY);
                assert!(velocity.contains(&v), "{} {seed}: {v} m/s", recipe.name);
                assert!(displacement.contains(&x), "{} {seed}: {x} m", recipe.name);
            }
        }
    }

    #[test]
    fn a_seed_is_a_record_and_another_seed_another() {
        let record = NEAR_FIELD_STRONG.generate(7).unwrap();
        assert_eq!(record, NEAR_FIELD_STRONG.generate(7).unwrap());
        assert_ne!(record.acceleration, NEAR_FIELD_STRONG.generate(8).unwrap().acceleration);
        assert_eq!((record.name.as_str(), record.acceleration.len()), ("near-field-strong-7", 8001));
    }

    #[test]
    fn what_cannot_be_made_is_refused() {
        assert_eq!(Recipe { duration: 0.0, ..FAR_FIELD }.generate(1), Err(GenerateError::Samples(1.0)));
        assert!(matches!(Recipe { rate: 10.0, ..FAR_FIELD }.generate(1), Err(GenerateError::Band(_))));
        assert!(Recipe { duration: f64::NAN, ..FAR_FIELD }.generate(1).is_err());
        assert!(Recipe::named("far-field").is_some() && Recipe::named("near").is_none());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn every_seed_begins_and_ends_at_rest(seed in any::<u64>(), which in 0..3usize) {
            let motion = RECIPES[which].generate(seed).unwrap().motion();
            let last = motion.len() - 1;
            prop_assert!(motion.velocity[last].abs() < 1e-9 && motion.displacement[last].abs() < 1e-9);
            prop_assert!(motion.acceleration[0].abs() < 1e-9);
        }

        #[test]
        fn the_pulses_acceleration_is_the_derivative_of_its_velocity(
            frequency in 0.2..3.0f64, oscillations in 1.1..4.0f64, phase in -3.0..3.0f64, t in 0.0..10.0f64
        ) {
            let pulse = Pulse { amplitude: 0.8, frequency, oscillations, phase, time: 5.0 };
            let h = 1e-5;
            let slope = (pulse.velocity(t + h) - pulse.velocity(t - h)) / (2.0 * h);
            prop_assert!((slope - pulse.acceleration(t)).abs() < 1e-3, "{slope} {}", pulse.acceleration(t));
        }
    }
}
