//! Velocity saturation, from what the sensors show.
//!
//! A table whose valve is wide open moves at constant speed: its acceleration collapses while the error says "farther".
//! That holds at the valve's rated flow, and also far below it when the supply sags, so nearness to the set limit
//! alone is no evidence and its absence no alibi:
//!
//! ```text
//! collapsed = |a| <= plateau
//! pushed    = e sgn(v) > error
//! near      = |v| >= 0.92 V(side)
//! wanting   = (d - lag a) sgn(v) > (1 + shortfall) |v|
//! evidence  = collapsed and pushed and |v| >= floor V0 and (near or wanting),     saturated once it lasts `hold`
//! ```
//! a is the observer's acceleration, low-passed (m/s2); e the displacement error (m; in guard mode the external command
//! beyond zero flow), d the speed that is asked for (m/s): the command times the valve's gain, or in modifier mode what the
//! [`external_loop`] controller is found to make of its error; lag the valve's (s). At the crest of an unsaturated swing the
//! acceleration also passes zero, but there d - lag a equals v: wanting is what tells.
//!
//! The limit in force is estimated for each direction by itself (m/s): while saturated it moves to |v| with time
//! constant `follow`; a speed above it raises it at once; otherwise it recovers to the set limit V0 with time constant
//! `recovery`, as an accumulator refills. It never leaves `floor V0` to V0.

mod external_loop;

use external_loop::{ExternalLoopEstimator, ExternalLoopState};

use crate::block::{BlockError, require, whole_ticks};
use crate::control::Blocked;
use crate::math::{Magnitude, max, min};

/// How saturation is looked for.
///
/// ```
/// use shakedown_core::Settings;
/// use shakedown_core::settings::Detection;
///
/// let detection = Detection { plateau: 0.3, ..Detection::default() };
/// assert!(Settings { saturation: Some(detection), ..Settings::default() }.validate().is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct Detection {
    /// Acceleration below which a table is held to move at constant speed, m/s2; a few times the sensor's noise.
    pub plateau: f32,
    /// Error below which nothing is asked for, m.
    pub error: f32,
    /// By how much the speed asked for must exceed the speed had, 1.
    pub shortfall: f32,
    /// Smallest limit that is thought possible, as a share of the set one, 1.
    pub floor: f32,
    /// How long the evidence must last, s.
    pub hold: f32,
    /// Time constant with which the estimate goes to a speed seen in saturation, s.
    pub follow: f32,
    /// Time constant with which the estimate recovers to the set limit, s.
    pub recovery: f32,
}

impl Default for Detection {
    fn default() -> Self {
        Self { plateau: 0.4, error: 1e-3, shortfall: 0.2, floor: 0.25, hold: 0.01, follow: 0.02, recovery: 5.0 }
    }
}

/// What a tick shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// Velocity of the table, m/s.
    pub velocity: f32,
    /// Acceleration of the table, low-passed, m/s2.
    pub acceleration: f32,
    /// What pushes it, m: displacement error, or external command beyond zero flow.
    pub error: f32,
    /// Speed that is asked for, m/s: what the command settles at behind the valve's lag.
    pub demand: f32,
}

/// The detector's configuration.
///
/// ```
/// use shakedown_core::blocks::control::Blocked;
/// use shakedown_core::blocks::guard::{Detector, Evidence};
/// use shakedown_core::settings::Detection;
///
/// let detector = Detector::new(&Detection::default(), 0.242, 0.017, 1e-3)?;
/// let mut state = detector.start();
/// // 0.24 m/s, no acceleration, 50 mm behind, 0.6 m/s asked for: the valve is wide open.
/// for _ in 0..20 {
///     detector.advance(&mut state, Evidence { velocity: 0.24, acceleration: 0.0, error: 0.05, demand: 0.6 });
/// }
/// assert_eq!(state.blocked(), Blocked::Positive);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detector {
    plateau: Magnitude,
    error: f32,
    demand_ratio: f32,
    slowest: f32,
    limit: f32,
    lag: f32,
    external_loop: ExternalLoopEstimator,
    hold: u32,
    follow: f32,
    recovery: f32,
}

/// What the detector remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetectorState {
    lasted: u32,
    positive: f32,
    negative: f32,
    blocked: Blocked,
    external_loop: ExternalLoopState,
}

impl DetectorState {
    /// A state that has seen nothing of a table of `limit` (m/s).
    pub fn at(limit: f32) -> Self {
        Self {
            lasted: 0,
            positive: limit,
            negative: limit,
            blocked: Blocked::Neither,
            external_loop: ExternalLoopState::default(),
        }
    }

    /// The direction in which the table is at its limit.
    #[inline]
    pub fn blocked(&self) -> Blocked {
        self.blocked
    }

    /// The limit now in force in the slower direction, m/s.
    #[inline]
    pub fn limit(&self) -> f32 {
        min(self.positive, self.negative)
    }

    /// The limits now in force toward positive and negative displacement, m/s.
    pub fn limits(&self) -> (f32, f32) {
        (self.positive, self.negative)
    }
}

impl Detector {
    /// A detector for a table of `velocity_limit` (m/s) whose valve has a time constant of `lag` (s, finite), at ticks of `dt` (s).
    pub fn new(settings: &Detection, velocity_limit: f32, lag: f32, dt: f32) -> Result<Self, BlockError> {
        let limit = require("velocity_limit", velocity_limit, 1e-3, 10.0)?;
        let floor = require("saturation.floor", settings.floor, 0.05, 1.0)?;
        let hold = require("saturation.hold", settings.hold, 0.0, 1.0)?;
        let follow = require("saturation.follow", settings.follow, 1e-3, 10.0)?;
        let recovery = require("saturation.recovery", settings.recovery, 0.01, 1000.0)?;
        Ok(Self {
            plateau: Magnitude::new(require("saturation.plateau", settings.plateau, 1e-3, 100.0)?),
            error: require("saturation.error", settings.error, 0.0, 1.0)?,
            demand_ratio: 1.0 + require("saturation.shortfall", settings.shortfall, 0.0, 10.0)?,
            slowest: floor * limit,
            limit,
            lag,
            external_loop: ExternalLoopEstimator::new(lag, settings.plateau, dt),
            hold: whole_ticks(hold, dt),
            follow: (dt / follow).min(1.0),
            recovery: (dt / recovery).min(1.0),
        })
    }

    /// A state that has seen nothing.
    pub fn start(&self) -> DetectorState {
        DetectorState::at(self.limit)
    }

    /// The speed that an existing controller asks for of a table with this `velocity` (m/s), `acceleration` (m/s2) and
    /// displacement `error` (m), as far as it is known yet, m/s.
    pub fn external_demand(&self, state: &mut DetectorState, velocity: f32, acceleration: f32, error: f32) -> f32 {
        self.external_loop.advance(&mut state.external_loop, velocity, acceleration, error)
    }

    /// One tick.
    #[inline(always)]
    pub fn advance(&self, state: &mut DetectorState, seen: Evidence) {
        let speed = seen.velocity.abs();
        let forward = seen.velocity >= 0.0;
        let demand = seen.demand - self.lag * seen.acceleration;
        let (error, demand, limit) = if forward {
            (seen.error, demand, &mut state.positive)
        } else {
            (-seen.error, -demand, &mut state.negative)
        };
        let pushed = error > self.error && self.plateau.holds(seen.acceleration) && speed >= self.slowest;
        if pushed && (speed >= 0.92 * *limit || demand > self.demand_ratio * speed) {
            state.lasted = state.lasted.saturating_add(1);
        } else {
            state.lasted = 0;
        }
        let mut now = *limit;
        if state.lasted > self.hold {
            state.blocked = if forward { Blocked::Positive } else { Blocked::Negative };
            now += self.follow * (speed - now);
        } else {
            state.blocked = Blocked::Neither;
            now = max(speed, now + self.recovery * (self.limit - now));
        }
        *limit = min(self.limit, now);
    }
}
