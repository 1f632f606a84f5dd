//! What sensors add to a signal: white, coloured and amplitude-dependent noise, saw-tooth, hum, drift, spikes, counts and the
//! end of the range.

use crate::rng::Stream;
use std::f64::consts::TAU;

/// What one channel adds. Sizes are in the channel's SI unit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Channel {
    /// White noise, standard deviation.
    pub white: f64,
    /// Correlation from one sample to the next of the noise (1).
    pub colour: f64,
    /// Share by which the noise grows with the size of the signal's rate or value, at `scale` (1).
    pub growth: f64,
    /// Size of the signal at which the noise has grown by `growth`.
    pub scale: f64,
    /// Saw-tooth: amplitude and frequency (Hz).
    pub saw: Option<(f64, f64)>,
    /// Hum: amplitude and frequency (Hz).
    pub hum: Option<(f64, f64)>,
    /// Drift: size, and time constant in which it settles (s).
    pub drift: Option<(f64, f64)>,
    /// Spikes: size and mean number a second (1/s).
    pub spikes: Option<(f64, f64)>,
    /// One count; 0 for none.
    pub step: f64,
    /// End of the range; 0 for none.
    pub range: f64,
    /// First-order lag (s); 0 for none.
    pub lag: f64,
}

/// The sensors of a case.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sensor {
    /// Displacement (m): in the loop.
    pub displacement: Channel,
    /// Acceleration (m/s2).
    pub acceleration: Channel,
    /// Seed and number of the case.
    pub seed: (u64, u64),
}

/// The sensors of one run as it goes on.
#[derive(Debug, Clone)]
pub struct Sensing {
    displacement: Running,
    acceleration: Running,
}

impl Sensing {
    /// The sensors of run `number`, sampled every `dt` s.
    pub fn start(sensor: &Sensor, number: u64, dt: f64) -> Self {
        let stream = |purpose: u64| Stream::new(sensor.seed.0, sensor.seed.1, 0x7365_6e73_0000 + 16 * number + purpose);
        Self {
            displacement: Running::new(sensor.displacement, stream(1), dt),
            acceleration: Running::new(sensor.acceleration, stream(2), dt),
        }
    }

    /// Displacement (m) as its converter gives it, moving at `v` (m/s).
    pub fn displacement(&mut self, clean: f64, v: f64) -> f64 {
        self.displacement.sample(clean, v.abs())
    }

    /// Acceleration (m/s2) as its converter gives it.
    pub fn acceleration(&mut self, clean: f64) -> f64 {
        self.acceleration.sample(clean, clean.abs())
    }
}

/// One channel as it goes on.
#[derive(Debug, Clone)]
pub struct Running {
    channel: Channel,
    noise: Stream,
    events: Stream,
    coloured: f64,
    lagged: Option<f64>,
    phase: f64,
    saw: f64,
    sign: f64,
    k: u64,
    dt: f64,
}

impl Running {
    /// A channel sampled every `dt` s.
    pub fn new(channel: Channel, mut noise: Stream, dt: f64) -> Self {
        let phase = noise.uniform(0.0, TAU);
        let saw = noise.unit();
        let sign = noise.sign();
        let coloured = noise.normal();
        let events = Stream::new(noise.bits(), 0, 0x7370_696b);
        Self { channel, noise, events, coloured, lagged: None, phase, saw, sign, k: 0, dt }
    }

    /// The next sample, of a signal whose noise grows with `size`.
    pub fn sample(&mut self, clean: f64, size: f64) -> f64 {
        let c = self.channel;
        let t = self.k as f64 * self.dt;
        self.k += 1;
        let mut value = clean;
        if c.lag > 0.0 {
            // The value half way between two samples stands for what the lag saw.
            let before = self.lagged.unwrap_or(clean);
            value = before + (clean - before) * (1.0 - (-self.dt / c.lag).exp());
            self.lagged = Some(value);
        }
        let phi = c.colour;
        self.coloured = phi * self.coloured + (1.0 - phi * phi).sqrt() * self.noise.normal();
        let grown = if c.growth > 0.0 { 1.0 + c.growth * size / c.scale } else { 1.0 };
        value += c.white * grown * self.coloured;
        if let Some((amplitude, frequency)) = c.saw {
            value += amplitude * (2.0 * (frequency * t + self.saw).fract() - 1.0);
        }
        if let Some((amplitude, frequency)) = c.hum {
            value += amplitude * (TAU * frequency * t + self.phase).sin();
        }
        if let Some((drift, time)) = c.drift {
            value += self.sign * drift * (1.0 - (-t / time).exp());
        }
        if let Some((spike, rate)) = c.spikes
            && self.events.chance(rate * self.dt)
        {
            value += spike * self.events.sign();
        }
        if c.range > 0.0 {
            value = value.clamp(-c.range, c.range);
        }
        if c.step > 0.0 { c.step * (value / c.step + 0.5).floor() } else { value }
    }

    /// Direction in which the drift of this run goes.
    pub fn drift_sign(&self) -> f64 {
        self.sign
    }
}
