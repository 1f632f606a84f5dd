//! Whether the table does what the valve is told: a valve that is stuck, shut or hard over.
//!
//! ```text
//! w[k] = lag(clamp(gain u, -V, +V), valve lag)                 the velocity that the command asks for, m/s
//! r[k] = r[k-1] + dt (v - w) - (dt / memory) r[k-1]            displacement that it does not explain, m
//! f[k] = f[k-1] + clamp(x - f[k-1], -2 dt Vmax, +2 dt Vmax)      the LVDT less its spikes, m
//! c[k] = c[k-1] + f[k] - f[k-1] - dt w - (dt / 25 memory) c[k-1]   way of the LVDT that the command does not explain, m
//! d[k]: the same as c with Vmax for V and 50 memory                   m
//! s[k] = s[k-1] + dt clamp(gain u, -V, +V) - (dt / 5 memory) s[k-1]     while the LVDT stays within mismatch / 20, else 0
//! ```
//! u is the command beyond zero flow (m), V the velocity limit in force, Vmax the one that is set. `|r| > mismatch` trips, and so does
//! `|c| > 2 mismatch`: an LVDT that creeps, of which neither the accelerometer nor a loop that is closed over it sees
//! anything. An even speed below 8 % of mismatch / memory may be an unknown null. From `|d| > mismatch` on nobody knows
//! whether it is the LVDT or what limits the table that is wrong: a table that does less than it is told looks saturated, and an
//! LVDT that creeps against its motion looks the same. So the table may be at x or at x - d, and it trips where the envelope,
//! with its stopping distance, would not let it be at x - d. So does `|s| > mismatch / 2`: a table that is told to move and by its LVDT does not. That is a valve that is shut, or an LVDT that
//! stands still while the table moves evenly, of which the accelerometer sees nothing; an even speed below a tenth of
//! mismatch / memory is not seen, so that an unknown null does not trip a table at rest. No command stops a valve stuck hard
//! over, and none is right without an LVDT: this trip opens the relay of the hydraulic block at once.
//!
//! A gain of the table by its LVDT that changes during a test trips as well (`gain`).

use super::gain::{GainState, GainWitness};
use crate::block::{Block, BlockError, require};
use crate::filter::Lag;
use crate::filter::lag::LagState;
use crate::math::Magnitude;
use crate::scalar::Scalar;

/// How much longer what creeps is remembered, and how much farther it may go.
const SLOW: (f32, f32) = (25.0, 2.0);

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
    mismatch: Magnitude,
    /// The same for what creeps: what is kept from turn to turn, farthest that the LVDT is followed in a turn, and limit, m.
    slow_keep: f32,
    step: f32,
    velocity_limit: f32,
    possible_keep: f32,
    slow_limit: Magnitude,
    /// The same for a table that stands still: what is kept from turn to turn, band and limit, m.
    still_keep: f32,
    still_band: Magnitude,
    still_limit: Magnitude,
    gain: GainWitness,
}

/// What the monitor remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ValveMonitorState {
    velocity: LagState,
    unexplained: f32,
    /// The LVDT less its spikes, m, and what of its way the command does not explain, m.
    followed: Option<f32>,
    crept: f32,
    /// The same by the velocity limit that is set, and its lag.
    possible: f32,
    unlimited: LagState,
    /// Where the LVDT has stood since it last moved, m, and what it was told to move since, m.
    stood: f32,
    told: f32,
    gain: GainState,
}

/// What the command says of an LVDT that creeps.
///
/// ```
/// use shakedown_core::blocks::guard::{Creep, ValveMonitor, ValveMonitorState};
/// use shakedown_core::settings::ValveMonitorSettings;
///
/// let monitor = ValveMonitor::new(&ValveMonitorSettings::default(), 0.017, 0.242, 1e-3)?;
/// assert_eq!(monitor.creep(&ValveMonitorState::default()), Creep::None);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Creep {
    /// It does not.
    None,
    /// It may have, this far, m: the table would be so far below its reading.
    Possible(f32),
    /// It has.
    Certain,
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
        let slow_keep = 1.0 - (dt / (SLOW.0 * memory)).min(1.0);
        Ok(Self {
            lag: Lag::new(lag, dt)?,
            dt,
            keep,
            mismatch: Magnitude::new(mismatch),
            slow_keep,
            step: 2.0 * velocity_limit * dt,
            velocity_limit,
            possible_keep: 1.0 - (0.5 * dt / (SLOW.0 * memory)).min(1.0),
            slow_limit: Magnitude::new(SLOW.1 * mismatch),
            still_keep: 1.0 - (0.2 * dt / memory).min(1.0),
            still_band: Magnitude::new(0.05 * mismatch),
            still_limit: Magnitude::new(0.5 * mismatch),
            gain: GainWitness::new(dt),
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
        let followed = state.followed.unwrap_or(displacement);
        let step = (displacement - followed).bounded(self.step);
        state.followed = Some(followed + step);
        state.crept = self.slow_keep * state.crept + step - self.dt * expected;
        let most = self.lag.advance(&mut state.unlimited, wanted.bounded(self.velocity_limit));
        state.possible = self.possible_keep * state.possible + step - self.dt * most;
        let changed = self.gain.advance(&mut state.gain, wanted, limit, expected, velocity);
        state.unexplained = self.keep * state.unexplained + self.dt * (velocity - expected);
        if self.still_band.holds(displacement - state.stood) {
            state.told = self.still_keep * state.told + self.dt * asked;
        } else {
            state.stood = displacement;
            state.told = 0.0;
        }
        changed || !(self.mismatch.holds(state.unexplained) && self.still_limit.holds(state.told))
    }

    /// Between two of these: how far the LVDT has crept, m, by what the command does not explain over the longer time; and whether
    /// that is believed.
    #[inline(always)]
    pub fn creep(&self, state: &ValveMonitorState) -> Creep {
        if !self.slow_limit.holds(state.crept) {
            Creep::Certain
        } else if !self.mismatch.holds(state.possible) {
            Creep::Possible(state.possible)
        } else {
            Creep::None
        }
    }
}
