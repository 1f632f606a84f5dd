//! Whether a sensor is noisier than a motion within the envelope can make it look.
//!
//! ```text
//! d[k] = (y[k] - 3 y[k-1] + 3 y[k-2] - y[k-3]) / sqrt(10)        third difference of the reading y
//! r    = lag(min(|d|, 2 limit), 50 ms),   noisy: r > limit
//! limit = noise + (2 / pi) A_w (2 sin(w dt / 2))^3 / sqrt(10)     A_w = min(A, J / w)
//! ```
//! White noise gives d the mean magnitude of its change from tick to tick, which is what `noise` states. A sine of
//! amplitude A and angular frequency w gives the second term, so the limit leaves alone every sine within acceleration A
//! and jerk J of the envelope up to w: a tenth of the rate, or the corner J / A up to which the envelope allows A, whichever
//! is higher. A single spike, such as a valve that closes at speed makes, counts for twice the limit at most.
//!
//! Above 1 kHz y is the accelerometer's mean over a millisecond, and dt that millisecond. A command that steps, as every converter's
//! does, makes the flow step by dv within a tick and the acceleration dv / dt, the more the shorter the tick is: motion of the table,
//! and no noise of its sensor.

use core::f32::consts::{FRAC_2_PI, FRAC_PI_2, TAU};

use super::{EnvelopeSettings, PlausibilitySettings, Trip};
use crate::block::{Block, BlockError, require, whole_ticks};
use crate::filter::Lag;
use crate::filter::lag::LagState;
use crate::math::{self, min};

/// 1 / sqrt(10): mean magnitude of a change from tick to tick over that of the third difference, for white noise.
const WHITE: f32 = 0.316_227_77;
/// Time over which roughness is averaged, s.
const AVERAGE: f32 = 0.05;
/// Shortest time over which acceleration is judged, s.
const SHORTEST: f32 = 1e-3;

/// The roughness of one reading: its configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Roughness {
    limit: f32,
    mean: Lag,
}

/// What it remembers: the last three readings and the mean.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct RoughnessState {
    before: [f32; 3],
    heard: u8,
    mean: LagState,
}

impl Roughness {
    fn new(limit: f32, dt: f32) -> Result<Self, BlockError> {
        Ok(Self { limit, mean: Lag::new(AVERAGE, dt)? })
    }

    /// One tick: whether the `reading` has been too rough.
    #[inline]
    fn advance(self, state: &mut RoughnessState, reading: f32) -> bool {
        let [y1, y2, y3] = state.before;
        state.before = [reading, y1, y2];
        if state.heard < 3 {
            // Where a reading begins is no change of it.
            state.heard += 1;
            return false;
        }
        let third = (reading - y3 + 3.0 * (y2 - y1)).abs() * WHITE;
        self.mean.advance(&mut state.mean, min(2.0 * self.limit, third)) > self.limit
    }

    /// Whether it was, at its last reading.
    #[inline]
    fn found(self, state: &RoughnessState) -> bool {
        self.mean.last(&state.mean) > self.limit
    }
}

/// The monitor's configuration: LVDT, and accelerometer where one is fitted.
///
/// ```
/// use shakedown_core::Trip;
/// use shakedown_core::blocks::guard::NoiseMonitor;
/// use shakedown_core::settings::{EnvelopeSettings, PlausibilitySettings};
///
/// let monitor = NoiseMonitor::new(&PlausibilitySettings::default(), &EnvelopeSettings::default(), true, 1e-3)?;
/// let mut state = Default::default();
/// // An LVDT that jumps by 20 mm at every tick.
/// let found = (0..200).find_map(|k| monitor.advance(&mut state, if k % 2 == 0 { 0.01 } else { -0.01 }, 0.0));
/// assert_eq!(found, Some(Trip::DisplacementNoisy));
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseMonitor {
    displacement: Roughness,
    acceleration: Option<Roughness>,
    /// Ticks that acceleration is averaged over, and one over that.
    ticks: u32,
    share: f32,
}

/// What the monitor remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NoiseState {
    displacement: RoughnessState,
    acceleration: RoughnessState,
    /// Sum of the acceleration's readings since the last mean, m/s2, and how many.
    sum: f32,
    summed: u32,
}

impl NoiseMonitor {
    /// A monitor of a motion within `envelope` at ticks of `dt` (s); `accelerometer` where one is fitted.
    pub fn new(
        settings: &PlausibilitySettings,
        envelope: &EnvelopeSettings,
        accelerometer: bool,
        dt: f32,
    ) -> Result<Self, BlockError> {
        let noise = require("guard.plausibility.acceleration_noise", settings.acceleration_noise, 1e-3, 1e4)?;
        let ticks = whole_ticks(SHORTEST, dt).max(1);
        let mean = ticks as f32 * dt;
        let [of_acceleration, _] = motion(envelope, mean);
        let [_, of_displacement] = motion(envelope, dt);
        let acceleration = Roughness::new(noise + of_acceleration, mean)?;
        Ok(Self {
            displacement: Roughness::new(settings.disagreement + of_displacement, dt)?,
            acceleration: accelerometer.then_some(acceleration),
            ticks,
            share: 1.0 / ticks as f32,
        })
    }

    /// One tick: displacement (m) and acceleration (m/s2) as read, and which of them is too noisy.
    #[inline]
    pub fn advance(&self, state: &mut NoiseState, displacement: f32, acceleration: f32) -> Option<Trip> {
        let displacement = self.displacement.advance(&mut state.displacement, displacement);
        let acceleration = self.acceleration.is_some_and(|of| self.judge(of, state, acceleration));
        if displacement {
            Some(Trip::DisplacementNoisy)
        } else if acceleration {
            Some(Trip::AccelerationNoisy)
        } else {
            None
        }
    }

    /// One tick of the accelerometer, of which a mean is judged.
    #[inline]
    fn judge(&self, of: Roughness, state: &mut NoiseState, acceleration: f32) -> bool {
        state.sum += acceleration;
        state.summed += 1;
        if state.summed < self.ticks {
            return of.found(&state.acceleration);
        }
        let mean = state.sum * self.share;
        (state.sum, state.summed) = (0.0, 0);
        of.advance(&mut state.acceleration, mean)
    }
}

/// Mean roughness of the acceleration (m/s2) and of the displacement (m) of the roughest sine within `envelope`.
fn motion(envelope: &EnvelopeSettings, dt: f32) -> [f32; 2] {
    let corner = envelope.jerk / envelope.acceleration;
    let angular = math::max(0.1 * TAU / dt, corner);
    let amplitude = min(envelope.acceleration, envelope.jerk / angular);
    let half = min(0.5 * angular * dt, FRAC_PI_2);
    let step = 2.0 * math::sin(half);
    let rough = FRAC_2_PI * WHITE * amplitude * step * step * step;
    [rough, rough / (angular * angular)]
}
