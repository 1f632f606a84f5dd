//! Velocity saturation, from what the sensors show.
//!
//! A table whose valve is wide open moves at constant speed: its acceleration collapses while the error says "farther".
//! That holds at the valve's rated flow, and also far below it when the supply sags, so nearness to the set limit
//! alone is no evidence and its absence no alibi:
//!
//! ```text
//! collapsed = |lag(a)| <= plateau
//! pushed    = e sgn(v) > error
//! near      = |v| >= 0.92 V(side)
//! wanting   = d sgn(v) > (1 + shortfall) |v|
//! evidence  = collapsed and pushed and |v| >= floor V0 and (near or wanting),     saturated once it lasts `hold`
//! ```
//! e is the displacement error (m; in guard mode the external command beyond zero flow), d the speed that is asked for
//! (m/s): the command through the valve's linear model, or in modifier mode the reference's own velocity. At the crest of
//! an unsaturated swing the acceleration also passes zero, but there d equals v: wanting is what tells.
//!
//! The limit in force is estimated for each direction by itself (m/s): while saturated it moves to |v| with time
//! constant `follow`; a speed above it raises it at once; otherwise it recovers to the set limit V0 with time constant
//! `recovery`, as an accumulator refills. It never leaves `floor V0` to V0.

use serde::{Deserialize, Serialize};

use crate::block::{Block, BlockError, require};
use crate::control::Blocked;
use crate::filter::Lag;
use crate::filter::lag::LagState;

/// How saturation is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
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
    /// Smoothing of the acceleration, s.
    pub smoothing: f32,
    /// Time constant with which the estimate goes to a speed seen in saturation, s.
    pub follow: f32,
    /// Time constant with which the estimate recovers to the set limit, s.
    pub recovery: f32,
}

impl Default for Detection {
    fn default() -> Self {
        Self {
            plateau: 0.4,
            error: 1e-3,
            shortfall: 0.2,
            floor: 0.25,
            hold: 0.01,
            smoothing: 0.008,
            follow: 0.02,
            recovery: 5.0,
        }
    }
}

/// What a tick shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// Velocity of the table, m/s.
    pub velocity: f32,
    /// Acceleration of the table, m/s2.
    pub acceleration: f32,
    /// What pushes it, m: displacement error, or external command beyond zero flow.
    pub error: f32,
    /// Speed that is asked for, m/s.
    pub demand: f32,
}

/// The detector's configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detector {
    smoothing: Lag,
    plateau: f32,
    error: f32,
    excess: f32,
    slowest: f32,
    limit: f32,
    hold: u32,
    follow: f32,
    recovery: f32,
}

/// What the detector remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetectorState {
    acceleration: LagState,
    lasted: u32,
    positive: f32,
    negative: f32,
    blocked: Blocked,
}

impl DetectorState {
    /// The direction in which the table is at its limit.
    #[inline]
    pub fn blocked(&self) -> Blocked {
        self.blocked
    }

    /// The limit now in force in the slower direction, m/s.
    #[inline]
    pub fn limit(&self) -> f32 {
        if self.positive < self.negative { self.positive } else { self.negative }
    }

    /// The limits now in force toward positive and negative displacement, m/s.
    pub fn limits(&self) -> (f32, f32) {
        (self.positive, self.negative)
    }
}

impl Detector {
    /// A detector for a table of `velocity_limit` (m/s) at ticks of `dt` (s).
    pub fn new(settings: &Detection, velocity_limit: f32, dt: f32) -> Result<Self, BlockError> {
        let limit = require("velocity_limit", velocity_limit, 1e-3, 10.0)?;
        let floor = require("saturation.floor", settings.floor, 0.05, 1.0)?;
        let hold = require("saturation.hold", settings.hold, 0.0, 1.0)?;
        let follow = require("saturation.follow", settings.follow, 1e-3, 10.0)?;
        let recovery = require("saturation.recovery", settings.recovery, 0.01, 1000.0)?;
        Ok(Self {
            smoothing: Lag::new(require("saturation.smoothing", settings.smoothing, 0.0, 1.0)?, dt)?,
            plateau: require("saturation.plateau", settings.plateau, 1e-3, 100.0)?,
            error: require("saturation.error", settings.error, 0.0, 1.0)?,
            excess: 1.0 + require("saturation.shortfall", settings.shortfall, 0.0, 10.0)?,
            slowest: floor * limit,
            limit,
            hold: (hold / dt) as u32,
            follow: (dt / follow).min(1.0),
            recovery: (dt / recovery).min(1.0),
        })
    }

    /// A state that has seen nothing.
    pub fn start(&self) -> DetectorState {
        DetectorState {
            acceleration: LagState::default(),
            lasted: 0,
            positive: self.limit,
            negative: self.limit,
            blocked: Blocked::Neither,
        }
    }

    /// One tick.
    #[inline]
    pub fn advance(&self, state: &mut DetectorState, seen: Evidence) {
        let acceleration = self.smoothing.advance(&mut state.acceleration, seen.acceleration);
        let forward = seen.velocity >= 0.0;
        let (speed, error, demand) = if forward {
            (seen.velocity, seen.error, seen.demand)
        } else {
            (-seen.velocity, -seen.error, -seen.demand)
        };
        let limit = if forward { &mut state.positive } else { &mut state.negative };

        let near = speed >= 0.92 * *limit;
        let wanting = demand > self.excess * speed;
        let flat = acceleration >= -self.plateau && acceleration <= self.plateau;
        let evidence = flat && error > self.error && speed >= self.slowest && (near || wanting);
        state.lasted = if evidence { state.lasted.saturating_add(1) } else { 0 };

        if state.lasted > self.hold {
            state.blocked = if forward { Blocked::Positive } else { Blocked::Negative };
            *limit += self.follow * (speed - *limit);
        } else {
            state.blocked = Blocked::Neither;
            *limit += self.recovery * (self.limit - *limit);
            if speed > *limit {
                *limit = speed;
            }
        }
        if *limit > self.limit {
            *limit = self.limit;
        }
    }
}
