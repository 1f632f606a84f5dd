//! The truth: a servo-hydraulic table from first principles, each piece optional, written as one continuous system of
//! equations. With no piece present it is the servo model and velocity limiter of the paper (Eq. 7, Fig. 7) or the rigid
//! mass of Eq. 1, so that a null case is one to within its noise.
//!
//! SI throughout: displacement m, velocity m/s, forces per table mass m/s2, command in m for the servo (the paper feeds it
//! a displacement error times a gain) and in the drive's own unit for the rigid mass.

mod actuator;
mod command;
mod flow;
mod oscillator;
mod sensor;
mod table;

pub use actuator::Actuator;
pub use command::{CommandStage, Hysteresis, Lag, Overlap, Underlap, Valve};
pub use flow::{Flow, Supply};
pub use oscillator::{Base, Payload};
pub use sensor::{Hum, Sensors};
pub use table::{Backlash, Friction, Stop, Table};

use crate::ode::{STATES, State};
use state as at;

/// Where each state stands in the vector.
pub mod state {
    /// Displacement of the actuator (m).
    pub const X: usize = 0;
    /// Slow part of the servo's velocity demand, z of Eq. 7 (m/s).
    pub const Z: usize = 1;
    /// Velocity, where the actuator yields or the mass is free (m/s).
    pub const V: usize = 2;
    /// Chamber pressures times area over table mass (m/s2).
    pub const P1: usize = 3;
    /// The other chamber.
    pub const P2: usize = 4;
    /// Spool position in units of the command, and its rate.
    pub const SPOOL: usize = 5;
    /// Rate of the spool.
    pub const SPOOL_RATE: usize = 6;
    /// Torque motor in front of the spool.
    pub const MOTOR: usize = 7;
    /// Supply pressure over its start (1).
    pub const SUPPLY: usize = 8;
    /// Bristle deflection of the friction (m).
    pub const BRISTLE: usize = 9;
    /// Payload: stretch (m) and absolute velocity (m/s), two storeys.
    pub const PAYLOAD: usize = 10;
    /// Base: displacement (m) and momentum over mass (m/s).
    pub const BASE: usize = 14;
    /// Displacement sensor's two lags (m).
    pub const LVDT: usize = 16;
    /// Accelerometer's two lags, as velocities (m/s).
    pub const ACCELEROMETER: usize = 18;
    /// Place within the backlash (m).
    pub const GAP: usize = 20;
    /// Integral of the force on the table (m/s).
    pub const IMPULSE: usize = 21;
    /// Accelerometer bracket: stretch (m) and absolute velocity (m/s).
    pub const BRACKET: usize = 22;
}

/// What moves the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Machine {
    /// `G(s) = (b1 s + b0)/(s^2 + a1 s)` behind a limit on velocity.
    Servo {
        /// Lead (1/s).
        b1: f64,
        /// Gain (1/s2).
        b0: f64,
        /// Pole (1/s).
        a1: f64,
        /// Velocity limit (m/s).
        velocity_limit: f64,
    },
    /// `m x'' + c x' = gain u`.
    Rigid {
        /// Mass (kg).
        mass: f64,
        /// Viscous coefficient (N s/m).
        viscous: f64,
        /// Force per unit of command (N).
        gain: f64,
    },
}

impl Machine {
    /// Its parameters by their keys under `[model]`.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        match *self {
            Self::Servo { b1, b0, a1, velocity_limit } => {
                vec![("b1", b1), ("b0", b0), ("a1", a1), ("velocity_limit", velocity_limit)]
            }
            Self::Rigid { mass, viscous, gain } => vec![("mass", mass), ("viscous", viscous), ("gain", gain)],
        }
    }
}

/// The whole truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Physics {
    /// The baseline.
    pub machine: Machine,
    /// From controller to valve.
    pub command: CommandStage,
    /// Spool.
    pub valve: Valve,
    /// Orifices and supply.
    pub flow: Flow,
    /// Cylinder.
    pub actuator: Actuator,
    /// Forces on the table.
    pub table: Table,
    /// What is mounted on it.
    pub payload: Option<Payload>,
    /// What it stands on.
    pub base: Option<Base>,
    /// Transducers.
    pub sensors: Sensors,
}

/// What is fixed between two instants: the command in force and what changes only at events.
#[derive(Debug, Clone, Copy)]
pub struct Held {
    /// Command at the valve's amplifier, after delay and hysteresis.
    pub command: f64,
    /// Multiplier of the friction's static level, redrawn at each reversal where that is the flaw.
    pub breakaway: f64,
}

/// Velocities that follow from a state without being one.
#[derive(Debug, Clone, Copy)]
pub struct Motion {
    /// Of the actuator (m/s).
    pub actuator: f64,
    /// Of the table where the accelerometer stands, absolute (m/s).
    pub table: f64,
    /// Where the accelerometer's own dynamics end (m/s).
    pub sensed: f64,
}

impl Physics {
    /// The baseline with nothing added.
    pub fn baseline(machine: Machine) -> Self {
        Self {
            machine,
            command: CommandStage::default(),
            valve: Valve::default(),
            flow: Flow::default(),
            actuator: Actuator::default(),
            table: Table::default(),
            payload: None,
            base: None,
            sensors: Sensors::default(),
        }
    }

    /// At rest at `position` (m).
    pub fn at_rest(&self, position: f64) -> State {
        let mut y = [0.0; STATES];
        y[at::X] = position;
        y[at::LVDT] = position;
        y[at::LVDT + 1] = position;
        y[at::SUPPLY] = 1.0;
        let pressure = self.actuator.resting_pressure();
        y[at::P1] = pressure;
        y[at::P2] = pressure;
        y
    }

    /// Absolute tolerance of each state for the integrator.
    pub fn tolerance() -> State {
        let mut tolerance = [1e-7; STATES];
        for position in [at::X, at::BRISTLE, at::PAYLOAD, at::PAYLOAD + 2, at::BASE, at::LVDT, at::LVDT + 1, at::GAP] {
            tolerance[position] = 1e-9;
        }
        tolerance[at::BRACKET] = 1e-9;
        tolerance[at::P1] = 1e-5;
        tolerance[at::P2] = 1e-5;
        tolerance[at::SUPPLY] = 1e-6;
        // The spool's rate is a rate of command, a hundred times its size.
        tolerance[at::SPOOL_RATE] = 1e-5;
        tolerance
    }

    /// The spool's effective opening in units of the command.
    fn opening(&self, t: f64, y: &State, held: &Held) -> f64 {
        let raw = self.command.amplified(t, held.command);
        self.valve.opening(if self.valve.moves() { y[at::SPOOL] } else { raw })
    }

    /// Flow that the valve asks for, as a velocity of the piston (m/s), before the load acts on it.
    fn demand(&self, t: f64, y: &State, opening: f64) -> f64 {
        match self.machine {
            Machine::Servo { b1, velocity_limit, .. } => {
                self.flow.limited(t, y[at::Z] + b1 * opening, velocity_limit, y[at::SUPPLY])
            }
            Machine::Rigid { .. } => y[at::V],
        }
    }

    fn free(&self) -> bool {
        matches!(self.machine, Machine::Rigid { .. }) || self.actuator.yields()
    }

    /// Velocities at an instant.
    pub fn motion(&self, t: f64, y: &State, held: &Held) -> Motion {
        let actuator = if self.free() { y[at::V] } else { self.demand(t, y, self.opening(t, y, held)) };
        self.motion_of(actuator, y)
    }

    fn motion_of(&self, actuator: f64, y: &State) -> Motion {
        let after_gap = self.table.backlash.as_ref().map_or(actuator, |b| b.passed(actuator, y[at::GAP]));
        let table = after_gap + self.base.as_ref().map_or(0.0, |base| base.velocity(actuator, y[at::BASE + 1]));
        let sensed = self.sensors.sensed_velocity(table, y);
        Motion { actuator, table, sensed }
    }

    /// Time derivative of every state.
    pub fn derivative(&self, t: f64, y: &State, held: &Held, dy: &mut State) {
        *dy = [0.0; STATES];
        let raw = self.command.amplified(t, held.command);
        self.valve.derivative(raw, y, dy);
        let opening = self.opening(t, y, held);
        let demand = self.demand(t, y, opening);
        let motion = self.motion_of(if self.free() { y[at::V] } else { demand }, y);
        let v = motion.actuator;
        dy[at::X] = v;
        let mut force = self.table.force(y[at::X], v, y[at::BRISTLE], held.breakaway, &mut dy[at::BRISTLE]);
        if let Some(payload) = &self.payload {
            force += payload.derivative(motion.table, y, dy);
        }
        dy[at::IMPULSE] = force;
        match self.machine {
            Machine::Servo { b1, b0, a1, .. } => {
                let felt = if self.actuator.yields() { 0.0 } else { force };
                dy[at::Z] = -a1 * y[at::Z] + (b0 - b1 * a1) * opening - felt;
                self.actuator.derivative(demand, v, force, y, dy);
            }
            Machine::Rigid { mass, viscous, gain } => {
                dy[at::V] = (gain * opening - viscous * v) / mass - force;
            }
        }
        self.flow.derivative(v, self.limit(), y, dy);
        if let Some(base) = &self.base {
            base.derivative(v, y, dy);
        }
        if let Some(backlash) = &self.table.backlash {
            dy[at::GAP] = v - backlash.passed(v, y[at::GAP]);
        }
        self.sensors.derivative(y[at::X], motion.table, y, dy);
    }

    fn limit(&self) -> f64 {
        match self.machine {
            Machine::Servo { velocity_limit, .. } => velocity_limit,
            Machine::Rigid { .. } => 1.0,
        }
    }
}
