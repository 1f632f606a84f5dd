//! Whether the table does what the valve is told: a valve that is stuck, shut or hard over.
//!
//! ```text
//! w[k] = lag(clamp(gain u, -V, +V), valve lag)                 the velocity that the command asks for, m/s
//! r[k] = r[k-1] + dt (v - w) - (dt / memory) r[k-1]            displacement that it does not explain, m
//! ```
//! u is the command beyond zero flow (m), V a velocity limit: `|r| > mismatch` trips where it says so under the limit in force as well as
//! under the one that is set, for a table that does less than it is told looks saturated. No command stops a valve stuck hard over,
//! and none is right without an LVDT: this trip opens the relay of the hydraulic block at once.
//!
//! A table that is told to move and by its LVDT does not trips as well (`still`); so does an LVDT that creeps, of which neither
//! the accelerometer nor a loop that is closed over it sees anything (`creep`), and a gain of the table by its LVDT that changes
//! during a test (`gain`).

use super::creep::{Creep, CreepState, CreepWitness};
use super::gain::{GainState, GainWitness};
use super::still::{StillMonitor, StillState};
use crate::block::{Block, BlockError, require};
use crate::filter::Lag;
use crate::filter::lag::LagState;
use crate::scalar::Scalar;

/// When the valve is not believed.
///
/// ```
/// use shakedown_core::settings::ValveMonitorSettings;
///
/// let settings = ValveMonitorSettings { mismatch: 0.01, ..ValveMonitorSettings::default() };
/// assert_eq!(settings.memory, 0.2);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct ValveMonitorSettings {
    /// Largest displacement that the command does not explain, m.
    pub mismatch: f32,
    /// Time over which it is forgotten, s.
    pub memory: f32,
}

impl Default for ValveMonitorSettings {
    fn default() -> Self {
        Self { mismatch: 0.02, memory: 0.2 }
    }
}

/// The monitor's configuration.
///
/// ```
/// use shakedown_core::blocks::guard::{ValveMonitor, ValveMonitorState};
/// use shakedown_core::settings::ValveMonitorSettings;
///
/// let monitor = ValveMonitor::new(&ValveMonitorSettings::default(), 0.017, 0.242, 1e-3)?;
/// let mut state = ValveMonitorState::default();
/// // The command asks for 0.2 m/s and the table stays where it is: the valve is shut, or the LVDT stuck.
/// assert!((0..1000).any(|_| monitor.advance(&mut state, 0.2, 0.242, 0.0, 0.0)));
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValveMonitor {
    lag: Lag,
    dt: f32,
    keep: f32,
    mismatch: f32,
    velocity_limit: f32,
    still: StillMonitor,
    gain: GainWitness,
    creep: CreepWitness,
}

/// What the monitor remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ValveMonitorState {
    velocity: LagState,
    unexplained: f32,
    /// The same under the velocity limit that is set.
    unexplained_set: f32,
    /// What the command asks for under the velocity limit that is set.
    unlimited: LagState,
    still: StillState,
    gain: GainState,
    creep: CreepState,
}

impl ValveMonitorState {
    /// Learns the table's gain anew, as after arming.
    pub(crate) fn forget_gain(&mut self) {
        self.gain = GainState::default();
    }
}

impl ValveMonitor {
    /// A monitor of a valve with the given `lag` (s), of a table of `velocity_limit` (m/s), at ticks of `dt` (s).
    pub fn new(settings: &ValveMonitorSettings, lag: f32, velocity_limit: f32, dt: f32) -> Result<Self, BlockError> {
        let memory = require("guard.valve.memory", settings.memory, 0.01, 100.0)?;
        let mismatch = require("guard.valve.mismatch", settings.mismatch, 1e-5, 10.0)?;
        let keep = 1.0 - (dt / memory).min(1.0);
        Ok(Self {
            lag: Lag::new(lag, dt)?,
            dt,
            keep,
            mismatch,
            velocity_limit,
            still: StillMonitor::new(mismatch, memory, dt),
            gain: GainWitness::new(dt),
            creep: CreepWitness::new(mismatch, memory, velocity_limit, dt),
        })
    }

    /// One tick: speed asked for (m/s), limit in force (m/s), measured velocity (m/s) and displacement (m). True: the valve
    /// is not believed.
    #[inline(always)]
    pub fn advance(
        &self,
        state: &mut ValveMonitorState,
        asked: f32,
        limit: f32,
        velocity: f32,
        displacement: f32,
    ) -> bool {
        let wanted = asked;
        let asked = asked.bounded(limit);
        let expected = self.lag.advance(&mut state.velocity, asked);
        let most = self.lag.advance(&mut state.unlimited, wanted.bounded(self.velocity_limit));
        let gain = state.gain.gain(self.gain);
        self.creep.advance(&mut state.creep, displacement, [expected, most], gain);
        let changed = self.gain.advance(&mut state.gain, wanted, limit, expected, velocity);
        state.unexplained = self.keep * state.unexplained + self.dt * (velocity - expected);
        state.unexplained_set = self.keep * state.unexplained_set + self.dt * (velocity - most);
        let ways = [state.unexplained, state.unexplained_set];
        let explained = ways.iter().any(|&way| way <= self.mismatch) && ways.iter().any(|&way| way >= -self.mismatch);
        let still = self.still.advance(&mut state.still, asked, displacement);
        changed || still || !explained
    }

    /// Between two of these: how far the LVDT has crept by what the command does not explain, and whether that is believed.
    #[inline(always)]
    pub fn creep(&self, state: &ValveMonitorState) -> Creep {
        self.creep.found(&state.creep)
    }
}
