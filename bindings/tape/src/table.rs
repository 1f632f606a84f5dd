//! A table of four operations, and numbers without a pattern.

use shakedown_core::blocks::math;
use shakedown_core::settings::InnerLoop;
use shakedown_core::{Mode, Relay, Sample, Settings};

/// Xorshift (Marsaglia 2003), the same on every machine.
#[derive(Debug)]
pub(crate) struct Noise(u32);

impl Noise {
    pub(crate) const fn new(seed: u32) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9) | 1)
    }

    /// Evenly in -1 to 1.
    pub(crate) fn next(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        (self.0 >> 8) as f32 / 8_388_608.0 - 1.0
    }
}

/// A valve that lags, a limit, sensors.
#[derive(Debug)]
pub(crate) struct Table {
    x: f32,
    v: f32,
    a: f32,
    /// Where the valve is stuck, m, if it is.
    pub(crate) stuck: Option<f32>,
    closed: bool,
    noise: Noise,
}

/// Largest speed, m/s.
const LIMIT: f32 = 0.2;

impl Table {
    pub(crate) const fn new() -> Self {
        Self { x: 0.002, v: 0.0, a: 0.0, stuck: None, closed: false, noise: Noise::new(103) }
    }

    pub(crate) fn sample(&mut self, reference: f32, before: f32) -> Sample {
        let displacement = math::floor(self.x * 25_000.0) / 25_000.0;
        let acceleration = self.a + 0.1 * self.noise.next();
        Sample {
            velocity: self.v,
            pressure_difference: 2e5 * self.a,
            reference_velocity: (reference - before) * 1000.0,
            reference_acceleration: 0.2 * self.noise.next(),
            external: 8.0 * (reference - displacement),
            second_displacement: displacement + 1e-4 * self.noise.next(),
            relay_closed: self.closed,
            ..Sample::new(reference, displacement, acceleration)
        }
    }

    /// One tick under what the device put out.
    pub(crate) fn advance(&mut self, settings: &Settings, output: f32, relay: Relay) {
        let valve = match (settings.mode, settings.inner_loop) {
            (Mode::Modifier, _) => 8.0 * (output - self.x),
            (_, InnerLoop::Hardwired) => output - self.x,
            (_, InnerLoop::Absent) => output,
        };
        let before = self.v;
        self.closed = relay == Relay::Closed;
        let flow = if self.closed { 2.4 * self.stuck.unwrap_or(valve) } else { 0.0 };
        self.v += 0.06 * (flow - self.v);
        self.v = self.v.clamp(-LIMIT, LIMIT);
        self.x += 1e-3 * self.v;
        self.a = 1000.0 * (self.v - before);
    }
}
