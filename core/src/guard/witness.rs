//! The accelerometer as a second witness of displacement: integrated over a window, and held against the LVDT within what the
//! two sensors' stated errors explain.
//!
//! ```text
//! e = s^3/(s + p)^3 x_lvdt - 1/(s + p)^3 a          p = 2 pi frequency: the innovation of an observer with poles at p
//! B = delay V + 0.27 bias / p^2 + 6 noise sqrt(0.1875 dt / p^5) + scale max|s^3/(s + p)^3 x_lvdt|
//! |lag(e, 50 ms)| > B: LVDT and accelerometer contradict each other
//! ```
//! s^3/(s + p)^3 looks back over about 2/p (0.6 s at 0.5 Hz). A drift of the LVDT that begins at w m/s makes e = 0.23 w / p at
//! its peak, a gain error g makes g times the motion above p: what a closed loop does about either changes nothing in e,
//! because both sensors ride on the same table. The terms of B are the most that each stated error makes of e: a delay
//! between the sensors at the table's speed V, a step of the accelerometer's zero, six standard deviations of its noise, and
//! a difference in scale, of which the largest motion of late is remembered. A motion slower than p is not seen, and a spike
//! is left to the monitor of noise.
//!
//! While the table is held without oil the witness follows the fast observer, so that a test begins with what that has learned
//! of the accelerometer's zero. What moves evenly by then is followed as well and is seen no more: a table is not armed while its
//! reading moves. A reading that is missed widens B by what the table may have done meanwhile.

use core::f32::consts::TAU;

use crate::block::{Block, BlockError, require};
use crate::filter::Lag;
use crate::filter::lag::LagState;
use crate::filter::{MotionObserver, MotionState};
use crate::math::{self, max};

/// Stated errors of LVDT and accelerometer, and the window over which they are compared.
///
/// ```
/// use shakedown_core::settings::WitnessSettings;
///
/// // Two sensors whose scales agree within 2 %.
/// let settings = WitnessSettings { scale: 0.02, ..WitnessSettings::default() };
/// assert_eq!(settings.frequency, 0.5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct WitnessSettings {
    /// Below this the accelerometer is not believed, Hz.
    pub frequency: f32,
    /// Largest difference between the two sensors' scales, 1.
    pub scale: f32,
    /// Largest delay between the two sensors, s.
    pub delay: f32,
    /// Largest step of the accelerometer's zero during a test, m/s2.
    pub bias: f32,
    /// Standard deviation of the accelerometer's noise at each tick, m/s2.
    pub noise: f32,
}

impl Default for WitnessSettings {
    fn default() -> Self {
        Self { frequency: 0.5, scale: 0.05, delay: 0.004, bias: 0.1, noise: 0.3 }
    }
}

impl WitnessSettings {
    /// What delay, step of the zero and noise explain of the innovation on a table of `velocity_limit` (m/s) at ticks of `dt` (s), m.
    pub(crate) fn explained(&self, velocity_limit: f32, dt: f32) -> [f32; 3] {
        let p = TAU * self.frequency;
        let of_noise = 6.0 * self.noise * math::sqrt(0.1875 * dt / p) / (p * p);
        [self.delay * velocity_limit, 0.27 * self.bias / (p * p), of_noise]
    }
}

/// The witness's configuration.
///
/// ```
/// use shakedown_core::blocks::guard::{DisplacementWitness, WitnessState};
/// use shakedown_core::settings::WitnessSettings;
///
/// let witness = DisplacementWitness::new(&WitnessSettings::default(), 0.242, 1e-3)?;
/// let mut state = WitnessState::default();
/// // The LVDT jumps to 50 mm and the accelerometer shows nothing.
/// assert!((0..500).any(|_| witness.advance(&mut state, 0.05, 0.0)));
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplacementWitness {
    observer: MotionObserver,
    /// What does not depend on the motion, m.
    fixed: f32,
    scale: f32,
    /// What is kept from tick to tick of the largest motion of late, 1.
    keep: f32,
    /// Innovation per step of the velocity, s.
    per_velocity: f32,
    dt: f32,
    mean: Lag,
}

/// What the witness remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WitnessState {
    both: MotionState,
    displacement: MotionState,
    largest: f32,
    slack: f32,
    mean: LagState,
}

impl DisplacementWitness {
    /// A witness of a table of `velocity_limit` (m/s) at ticks of `dt` (s).
    pub fn new(settings: &WitnessSettings, velocity_limit: f32, dt: f32) -> Result<Self, BlockError> {
        let s = settings;
        let frequency = require("guard.witness.frequency", s.frequency, 0.1, highest_frequency(dt))?;
        let p = TAU * frequency;
        require("guard.witness.delay", s.delay, 0.0, 1.0)?;
        require("guard.witness.bias", s.bias, 0.0, 100.0)?;
        require("guard.witness.noise", s.noise, 0.0, 100.0)?;
        let [of_delay, of_bias, of_noise] = s.explained(velocity_limit, dt);
        Ok(Self {
            observer: MotionObserver::crossover(frequency, dt)?,
            fixed: of_delay + of_bias + of_noise,
            scale: require("guard.witness.scale", s.scale, 0.0, 1.0)?,
            keep: 1.0 - (0.2 * p * dt).min(1.0),
            per_velocity: 0.231 / p,
            dt,
            mean: Lag::new(0.05, dt)?,
        })
    }

    /// Follows the `fast` observer of a table that no oil moves, at `displacement` (m).
    #[inline]
    pub fn follow(&self, state: &mut WitnessState, fast: &MotionState, displacement: f32) {
        *state = WitnessState { both: *fast, displacement: MotionState::at(displacement), ..WitnessState::default() };
    }

    /// Whether a drift of which an even `velocity` (m/s) is already followed may be missed: above a quarter of the slowest drift that is
    /// seen to begin, too little of it may be left to see.
    #[inline]
    pub(crate) fn may_miss(&self, velocity: f32) -> bool {
        4.0 * self.per_velocity * velocity.abs() > self.fixed
    }

    /// One tick: displacement (m) and acceleration (m/s2) as read. True: they contradict each other.
    #[inline]
    pub fn advance(&self, state: &mut WitnessState, displacement: f32, acceleration: f32) -> bool {
        self.observer.advance(&mut state.both, displacement, acceleration);
        self.observer.advance(&mut state.displacement, displacement, 0.0);
        state.largest = max(state.largest * self.keep, state.displacement.innovation.abs());
        state.slack *= self.keep;
        self.mean.advance(&mut state.mean, state.both.innovation).abs() > self.bound(state)
    }

    /// One tick without a reading: the table goes on as it went, but for the last `acceleration` (m/s2) and as much again.
    #[cold]
    pub fn coast(&self, state: &mut WitnessState, acceleration: f32) {
        self.observer.coast(&mut state.both);
        self.observer.coast(&mut state.displacement);
        state.slack += self.per_velocity * self.dt * (2.0 * acceleration.abs() + 1.0);
    }

    /// The most that the stated errors explain now, m.
    #[inline]
    pub fn bound(&self, state: &WitnessState) -> f32 {
        self.fixed + self.scale * state.largest + state.slack
    }
}

/// Highest frequency of a witness at ticks of `dt` (s), Hz: as for any observer.
fn highest_frequency(dt: f32) -> f32 {
    0.05 / dt
}
