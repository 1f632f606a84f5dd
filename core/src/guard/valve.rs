//! Whether the table does what the valve is told: a valve that is stuck, shut or hard over.
//!
//! ```text
//! w[k] = lag(clamp(gain u, -V, +V), valve lag)                 the velocity that the command asks for, m/s
//! r[k] = r[k-1] + dt (v - w) - (dt / memory) r[k-1]            displacement that it does not explain, m
//! ```
//! u is the command beyond zero flow (m), V the velocity limit in force. `|r| > mismatch` trips. No command stops a valve
//! stuck hard over: this trip opens the relay of the hydraulic block at once.

use serde::{Deserialize, Serialize};

use crate::block::{Block, BlockError, require};
use crate::filter::Lag;
use crate::filter::lag::LagState;
use crate::scalar::Scalar;

/// When the valve is not believed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValveMonitor {
    lag: Lag,
    dt: f32,
    keep: f32,
    mismatch: f32,
}

/// What the monitor remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ValveMonitorState {
    velocity: LagState,
    unexplained: f32,
}

impl ValveMonitor {
    /// A monitor of a valve with the given `lag` (s) at ticks of `dt` (s).
    pub fn new(settings: &ValveMonitorSettings, lag: f32, dt: f32) -> Result<Self, BlockError> {
        let memory = require("guard.valve.memory", settings.memory, 0.01, 100.0)?;
        Ok(Self {
            lag: Lag::new(lag, dt)?,
            dt,
            keep: 1.0 - (dt / memory).min(1.0),
            mismatch: require("guard.valve.mismatch", settings.mismatch, 1e-5, 10.0)?,
        })
    }

    /// One tick: speed asked for (m/s), limit in force (m/s) and measured velocity (m/s). True: the valve is not
    /// believed.
    #[inline(always)]
    pub fn advance(&self, state: &mut ValveMonitorState, asked: f32, limit: f32, velocity: f32) -> bool {
        let expected = self.lag.advance(&mut state.velocity, asked.bounded(limit));
        state.unexplained = self.keep * state.unexplained + self.dt * (velocity - expected);
        state.unexplained.abs() > self.mismatch
    }
}
