//! What sensors add: counts, white and coloured noise, pick-up too small to matter.

use crate::rng::Stream;

/// Noise of the two sensors every case has.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    /// Displacement before counting, white (m).
    pub displacement: f64,
    /// One count of the displacement (m); 0 for none.
    pub step: f64,
    /// Accelerometer (m/s2).
    pub acceleration: f64,
    /// Correlation of the accelerometer's noise from one sample to the next (1).
    pub colour: f64,
    /// Background hum: frequency (Hz) and amplitude (m/s2).
    pub hum: Option<(f64, f64)>,
    /// Seed and case, so that every run has its own noise.
    pub seed: (u64, u64),
}

/// Noise of one run as it goes on.
#[derive(Debug, Clone)]
pub struct Sensing<'a> {
    noise: &'a Noise,
    displacement: Stream,
    acceleration: Stream,
    coloured: f64,
    phase: f64,
}

impl Noise {
    /// The noise of run `number`.
    pub fn start(&self, number: u64) -> Sensing<'_> {
        let stream = |purpose: u64| Stream::new(self.seed.0, self.seed.1, 0x6e6f_0000 + 16 * number + purpose);
        let mut acceleration = stream(2);
        let phase = acceleration.uniform(0.0, std::f64::consts::TAU);
        let coloured = acceleration.normal();
        Sensing { noise: self, displacement: stream(1), acceleration, coloured, phase }
    }
}

impl Sensing<'_> {
    /// Displacement as counted: `step floor(x/step + 1/2)` (m).
    pub fn displacement(&mut self, clean: f64) -> f64 {
        let noisy = clean + self.noise.displacement * self.displacement.normal();
        let step = self.noise.step;
        if step > 0.0 { step * (noisy / step + 0.5).floor() } else { noisy }
    }

    /// Acceleration with noise (m/s2) at time `t` (s).
    pub fn acceleration(&mut self, clean: f64, t: f64) -> f64 {
        let phi = self.noise.colour;
        self.coloured = phi * self.coloured + (1.0 - phi * phi).sqrt() * self.acceleration.normal();
        let hum = self.noise.hum.map_or(0.0, |(f, a)| a * (std::f64::consts::TAU * f * t + self.phase).sin());
        clean + self.noise.acceleration * self.coloured + hum
    }
}
