//! Inverse of the flow map: the valve opening, as the flow it would make of a full and stiff supply, for a flow wanted.
//!
//! ```text
//! p' = (1 - p - depth |v| / v_max) / recovery          supply pressure, relative, from the table's velocity
//! q <- q / sqrt(1 - sgn(q) load / stall)               a load takes its part of the pressure
//! r = |q| / (limit(sgn q) sqrt(p)),   held within the overdrive
//! w = sgn(q) limit r / (1 - r^n)^(1/n)
//! ```
//! q, w, v and limits in m/s, load and stall in m/s2 (force per table mass), pressures relative to a full accumulator. The
//! last line is a table of 33 points, worked out with the configuration; with `n` = 0 the limit is hard and w = q / sqrt(p).
//! Beyond 0.97 of a soft limit it goes on straight. More than the limit is asked for where the gain may be less than
//! thought: what the valve has too little of, the observers ask for here.
//! Of the square roots, that of the pressure follows it by one Newton step a tick, and that of the load is taken from its
//! series, right within 0.3 % for a load of up to half the stall against the flow and within 2 % for one with it, and held there.

use crate::block::{BlockError, require};
use crate::math;

/// What is known of the flow beyond gain and limit. Zeros switch off.
///
/// ```
/// use shakedown_core::settings::FlowSettings;
///
/// // Toward negative displacement the table is a tenth slower.
/// let flow = FlowSettings { asymmetry: 0.9, ..FlowSettings::default() };
/// assert_eq!(flow.sharpness, 0.0); // a hard limit
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct FlowSettings {
    /// Velocity limit toward negative displacement over the one toward positive, 1.
    pub asymmetry: f32,
    /// Sharpness n of a soft limit, 1; 0 for a hard one.
    pub sharpness: f32,
    /// Force per table mass at which the flow stalls, m/s2; 0 for a flow that no load slows.
    pub stall: f32,
    /// Relative supply pressure lost under sustained motion at the velocity limit, 1.
    pub droop: f32,
    /// Time constant with which the supply recovers, s.
    pub recovery: f32,
    /// How far beyond the limit the valve may be opened, as a multiple of it, 1.
    pub overdrive: f32,
}

impl Default for FlowSettings {
    fn default() -> Self {
        Self { asymmetry: 1.0, sharpness: 0.0, stall: 0.0, droop: 0.0, recovery: 1.0, overdrive: 2.5 }
    }
}

const POINTS: usize = 32;
/// Share of a soft limit beyond which its inverse is not followed.
const STEEPEST: f32 = 0.97;

/// The map's configuration.
///
/// ```
/// use shakedown_core::blocks::tracking::{FlowMap, FlowState};
/// use shakedown_core::settings::FlowSettings;
///
/// let map = FlowMap::new(&FlowSettings::default(), 0.242, 1e-3)?;
/// // A full and stiff supply: what is asked for is what comes.
/// let (open, made) = map.advance(&mut FlowState::default(), 0.1, 0.0, 0.1);
/// assert!((open - 0.1).abs() < 1e-6 && made == 0.1);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowMap {
    positive: f32,
    per_positive: f32,
    asymmetry: f32,
    per_asymmetry: f32,
    overdrive: f32,
    soft: bool,
    per_stall: f32,
    droop: f32,
    recovery_step: f32,
    table: [f32; POINTS + 1],
}

/// What the map remembers of the supply.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowState {
    pressure: f32,
    per_root: f32,
}

impl Default for FlowState {
    fn default() -> Self {
        Self { pressure: 1.0, per_root: 1.0 }
    }
}

impl FlowMap {
    /// For a velocity `limit` (m/s) toward positive displacement at ticks of `dt` (s).
    pub fn new(settings: &FlowSettings, limit: f32, dt: f32) -> Result<Self, BlockError> {
        let s = settings;
        let asymmetry = require("tracking.flow.asymmetry", s.asymmetry, 0.2, 5.0)?;
        let sharpness = require("tracking.flow.sharpness", s.sharpness, 0.0, 50.0)?;
        let soft = sharpness > 0.0;
        if soft {
            require("tracking.flow.sharpness", sharpness, 1.0, 50.0)?;
        }
        let stall = require("tracking.flow.stall", s.stall, 0.0, 1e4)?;
        let overdrive = require("tracking.flow.overdrive", s.overdrive, 1.0, 10.0)?;
        let mut table = [0.0; POINTS + 1];
        for (i, w) in table.iter_mut().enumerate() {
            let r = i as f32 / POINTS as f32 * STEEPEST;
            *w = if soft { r / math::pow(1.0 - math::pow(r, sharpness), 1.0 / sharpness) } else { r };
        }
        Ok(Self {
            positive: limit,
            per_positive: 1.0 / limit,
            asymmetry,
            per_asymmetry: 1.0 / asymmetry,
            overdrive,
            soft,
            per_stall: if stall > 0.0 { 1.0 / stall } else { 0.0 },
            droop: require("tracking.flow.droop", s.droop, 0.0, 0.95)? / limit,
            recovery_step: dt / require("tracking.flow.recovery", s.recovery, 100.0 * dt, 1000.0)?,
            table,
        })
    }

    /// One tick: flow wanted (m/s), load expected (m/s2) and velocity (m/s) in; flow to ask of the valve (m/s, as of a
    /// full supply) and the flow that will come of it (m/s) out.
    #[inline]
    pub fn advance(&self, state: &mut FlowState, flow: f32, load: f32, velocity: f32) -> (f32, f32) {
        if self.droop > 0.0 {
            self.draw(state, velocity);
        }
        let slowed = if flow > 0.0 { self.per_stall * load } else { -self.per_stall * load };
        let x = math::max(math::min(slowed, 0.5), -0.5);
        // 1 / sqrt(1 - x)
        let stretched = flow * (1.0 + x * (0.5 + x * (0.375 + x * (0.3125 + x * 0.45))));
        let (limit, per_limit) = if flow > 0.0 {
            (self.positive, self.per_positive)
        } else {
            (self.positive * self.asymmetry, self.per_positive * self.per_asymmetry)
        };
        let share = stretched.abs() * per_limit * state.per_root;
        let (share, made) =
            if share <= self.overdrive { (share, flow) } else { (self.overdrive, flow * (self.overdrive / share)) };
        let open = limit * if self.soft { self.soften(share) } else { share };
        (if flow > 0.0 { open } else { -open }, made)
    }

    /// The inverse of the soft limit.
    #[inline]
    fn soften(&self, share: f32) -> f32 {
        let place = share * (POINTS as f32 / STEEPEST);
        let index = (place as usize).min(POINTS - 1);
        let (low, high) = (self.table[index], self.table[index + 1]);
        low + (place - index as f32) * (high - low)
    }

    /// What the supply loses to this flow and gains from the pump.
    #[inline]
    fn draw(&self, state: &mut FlowState, velocity: f32) {
        let settled = math::max(1.0 - self.droop * velocity.abs(), 0.02);
        state.pressure += self.recovery_step * (settled - state.pressure);
        let y = state.per_root;
        state.per_root = y * (1.5 - 0.5 * state.pressure * y * y);
    }
}
