//! Two-degree-of-freedom tracking: the identified model run backwards, and feedback of what is left.
//!
//! ```text
//! reference -> trajectory -+-> feedforward ------+-> flow map^-1 -> valve^-1 -> deadband^-1 -> command
//!                          +-> errors -> feedback ^        |
//! LVDT, accelerometer -> Kalman -^-> disturbance -^ <------+ flow made
//! pressure difference -> damping ----------------^
//! ```
//! Everything up to the flow map is in the flow's own unit, piston velocity (m/s): the feedback asks for flow, and what
//! the valve and its supply make of a command is inverted behind it. The table moves [`Tracking::lag`] ticks and a half
//! behind the reference, which is what the trajectory's rates and the command's own delay need to see ahead.
//!
//! The parts are one file each. Gains follow from two frequencies: `bandwidth`, that of the feedback, and `disturbance`,
//! below which everything the model lacks is observed and corrected.

pub(crate) mod disturbance;
pub(crate) mod flow;
pub(crate) mod friction;
pub(crate) mod oil;
pub(crate) mod pressure;
mod settings;
pub(crate) mod trajectory;
pub(crate) mod valve;

pub use settings::{NoiseSettings, NotchSettings, Surroundings, TrackingSettings};

use crate::block::Block;
use crate::filter::second_order::SecondOrderState;
use crate::filter::washout::WashoutState;
use crate::filter::{MotionObserver, MotionState, SecondOrder};
use crate::scalar::Scalar;
use disturbance::{Disturbance, DisturbanceState};
use flow::{FlowMap, FlowState};
use friction::Friction;
use oil::{OilColumn, OilState};
use pressure::PressureDamping;
use trajectory::{History, Stencil};
use valve::{Valve, ValveState};

/// Time in which a displacement error left alone at a change of settings is taken up, s.
const RELIEF: f32 = 0.3;
/// Largest such error, m.
const MOST_RELIEF: f32 = 0.05;

/// Ticks of delay of the command that can be allowed for.
pub(crate) const LONGEST_DELAY: u32 = 15;
const MASK: u32 = LONGEST_DELAY;

/// What the table hangs on.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Actuator {
    /// Oil that does not give: the table moves as the oil flows.
    Stiff { bandwidth: f32, disturbance: Disturbance },
    /// An oil column with a mode of its own.
    Compliant(OilColumn),
}

/// The law's configuration.
///
/// ```
/// use shakedown_core::blocks::tracking::{Surroundings, TrackingInput, TrackingState};
/// use shakedown_core::settings::TrackingSettings;
///
/// let around = Surroundings { dt: 1e-3, valve: [2.39, 0.0173], command_limit: 0.2, velocity_limit: 0.242 };
/// let law = TrackingSettings::default().law(&around)?;
/// let mut state = TrackingState::at(0.0);
/// let behind = TrackingInput { reference: 0.0, displacement: -0.01, ..TrackingInput::default() };
/// assert!(law.advance(&mut state, &behind) > 0.0); // toward the reference
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracking {
    stencil: Stencil,
    /// Ticks from the newest reference back to the one the table is held against.
    back: u32,
    delay: u32,
    half_dt: f32,
    observer: MotionObserver,
    actuator: Actuator,
    flow: FlowMap,
    valve: Valve,
    friction: Friction,
    pressure: Option<PressureDamping>,
    notch: Option<SecondOrder>,
}

/// What the law remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackingState {
    history: History,
    observer: MotionState,
    disturbance: DisturbanceState,
    oil: OilState,
    flow: FlowState,
    valve: ValveState,
    pressure: WashoutState,
    notch: SecondOrderState,
    /// Flows made in the last ticks, m/s.
    made: [f32; LONGEST_DELAY as usize + 1],
    tick: u32,
    /// What the feedback last saw (m, m/s, m/s2) and said (m/s).
    errors: [f32; 3],
    back: f32,
    /// Displacement error that a change of settings left to be taken up, m, and what is taken up in a tick.
    relief: f32,
    relief_step: f32,
}

impl Default for TrackingState {
    fn default() -> Self {
        Self::at(0.0)
    }
}

impl TrackingState {
    /// A table at rest at `displacement` (m) where its reference stands.
    pub fn at(displacement: f32) -> Self {
        Self {
            history: History::at(displacement),
            observer: MotionState::at(displacement),
            disturbance: DisturbanceState::default(),
            oil: OilState::default(),
            flow: FlowState::default(),
            valve: ValveState::default(),
            pressure: WashoutState::default(),
            notch: SecondOrderState::default(),
            made: [0.0; LONGEST_DELAY as usize + 1],
            tick: 0,
            errors: [0.0; 3],
            back: 0.0,
            relief: 0.0,
            relief_step: 0.0,
        }
    }
}

/// What the law is told at one tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TrackingInput {
    /// Reference, m.
    pub reference: f32,
    /// LVDT, m.
    pub displacement: f32,
    /// Accelerometer, m/s2; zero where there is none.
    pub acceleration: f32,
    /// Pressure difference, Pa; read where damping by it is set.
    pub pressure_difference: f32,
}

impl Tracking {
    /// Ticks, and a half, by which the table follows the reference.
    pub fn lag(&self) -> u32 {
        self.back
    }

    /// Takes over `state` from another configuration: as much of the displacement error is left alone that the feedback
    /// says now what it last said, and taken up within 0.3 s.
    pub fn adapt_state(&self, state: &mut TrackingState) {
        let (stiffness, says) = match &self.actuator {
            Actuator::Stiff { bandwidth, .. } => (*bandwidth, bandwidth * state.errors[0] - state.disturbance.flow),
            Actuator::Compliant(oil) => (oil.stiffness(), oil.feedback(&state.oil, state.errors)),
        };
        if stiffness > 0.0 {
            state.relief += (says - state.back) / stiffness;
            state.relief = state.relief.bounded(MOST_RELIEF);
            state.relief_step = state.relief.abs() * (2.0 * self.half_dt / RELIEF);
        }
    }

    /// One tick, all inputs finite and within range: command out, m.
    #[inline]
    pub fn advance(&self, state: &mut TrackingState, seen: &TrackingInput) -> f32 {
        state.history.push(seen.reference);
        let wanted = self.stencil.at(&state.history, self.back);
        let ahead = if self.delay == 0 { wanted } else { self.stencil.at(&state.history, self.back - self.delay) };
        self.observer.advance(&mut state.observer, seen.displacement, seen.acceleration);
        let now = state.observer;
        // The table is where the trajectory was half a tick ago: the flow of a tick is meant for its middle.
        let half = self.half_dt;
        let x = wanted.displacement - half * wanted.velocity - now.displacement - state.relief;
        state.relief -= state.relief.bounded(state.relief_step);
        let v = wanted.velocity - half * wanted.acceleration - now.velocity;
        let last = state.made[(state.tick.wrapping_sub(self.delay) & MASK) as usize];
        let mean = now.velocity - half * now.acceleration;
        let (forward, mut back) = match &self.actuator {
            Actuator::Stiff { bandwidth, disturbance } => {
                let lost = disturbance.advance(&mut state.disturbance, mean, last);
                state.errors = [x, v, 0.0];
                (ahead.velocity, bandwidth * x - lost)
            }
            Actuator::Compliant(oil) => {
                oil.observe(&mut state.oil, last, mean, now.acceleration);
                let a = wanted.acceleration - half * wanted.jerk - state.oil.load;
                state.errors = [x, v, a];
                (oil.forward(&ahead), oil.feedback(&state.oil, [x, v, a]))
            }
        };
        state.back = back;
        if let Some(pressure) = &self.pressure {
            back += pressure.advance(&mut state.pressure, seen.pressure_difference, wanted.acceleration);
        }
        if let Some(notch) = &self.notch {
            back = notch.advance(&mut state.notch, back);
        }
        let force = self.friction.force(ahead.velocity);
        let load = ahead.acceleration + force;
        let (open, made) = self.flow.advance(&mut state.flow, forward + back, load, now.velocity);
        let (command, passed) = self.valve.advance(&mut state.valve, open, force);
        state.tick = state.tick.wrapping_add(1);
        // A command at its limit makes less flow than was asked for.
        state.made[(state.tick & MASK) as usize] = made + (passed - open);
        self.friction.open(command)
    }
}
