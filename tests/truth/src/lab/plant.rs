//! A plant put together from laws at their places. With none it is the stated servo model with its velocity limit, or the
//! rigid mass.

use super::forms::column::Stiff;
use super::law::{Column, Law, Now, Part, Place};
use crate::plant::Machine;
use std::sync::Arc;

mod compare;
mod load;
mod memory;

/// Greatest number of states and of memories.
pub const MOST: usize = 64;

/// Displacement (m).
pub const X: usize = 0;
/// Slow part of the servo's velocity demand (m/s).
pub const Z: usize = 1;
/// Velocity of a free mass (m/s).
pub const V: usize = 2;
/// Integral of the forces on the table (m/s).
pub const IMPULSE: usize = 3;
/// Distance travelled (m).
pub const PATH: usize = 4;
const OWN: usize = 5;

/// States of a plant.
pub type State = [f64; MOST];

/// The plant.
#[derive(Debug, Clone)]
pub struct Plant {
    /// The baseline.
    pub machine: Machine,
    /// Laws, in the order of their places.
    parts: Vec<Part>,
    /// Oil column; the piston follows the flow without one.
    column: Option<Arc<dyn Column>>,
    /// Transport delay of the command (s), and the share of it by which single commands scatter (1).
    pub delay: (f64, f64),
    /// Whether two laws were put where there is room for one.
    clash: bool,
    /// Whether the column is only there because a law needs its pressure.
    stiff: bool,
    /// Offsets into states and memories of each part, and of the column.
    layout: Vec<(usize, usize)>,
    column_at: usize,
    used: usize,
    memories: usize,
}

/// Velocities at an instant (m/s), and the pressure (m/s2).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Motion {
    /// Actuator.
    pub actuator: f64,
    /// Accelerometer.
    pub sensed: f64,
}

impl Plant {
    /// The baseline with nothing added.
    pub fn baseline(machine: Machine) -> Self {
        let mut plant = Self {
            machine,
            parts: Vec::new(),
            column: None,
            delay: (0.0, 0.0),
            clash: false,
            stiff: false,
            layout: Vec::new(),
            column_at: OWN,
            used: OWN,
            memories: 0,
        };
        plant.arrange();
        plant
    }

    /// Adds a law.
    pub fn add(&mut self, place: Place, law: impl Law + 'static) {
        self.add_part(Part { place, law: Arc::new(law), gate: None });
    }

    /// Adds a law with a gate, or as it is.
    pub fn add_part(&mut self, part: Part) {
        let at = self.parts.iter().position(|p| p.place > part.place).unwrap_or(self.parts.len());
        if matches!(part.place, Place::Leak | Place::Edge) && self.column.is_none() {
            self.column = Some(Arc::new(Stiff));
            self.stiff = true;
        }
        self.parts.insert(at, part);
        self.arrange();
    }

    /// Puts oil between valve and piston.
    pub fn set_column(&mut self, column: impl Column + 'static) {
        self.clash |= self.column.is_some() && !self.stiff;
        self.stiff = false;
        self.column = Some(Arc::new(column));
        self.arrange();
    }

    /// Whether two laws were put where there is room for one.
    pub fn clashes(&self) -> bool {
        self.clash
    }

    /// Whether laws act between actuator and table or under it: pressure is then no simple sum.
    pub fn parts_table(&self) -> bool {
        self.parts.iter().any(|p| matches!(p.place, Place::Link | Place::Frame))
    }

    fn arrange(&mut self) {
        let (mut y, mut m) = (OWN, 0);
        self.layout.clear();
        for part in &self.parts {
            self.layout.push((y, m));
            y += part.law.states();
            m += part.law.memories();
        }
        self.column_at = y;
        self.used = y + self.column.as_ref().map_or(0, |c| c.states());
        self.memories = m;
        debug_assert!(self.used <= MOST && self.memories <= MOST);
    }

    /// Number of states in use.
    pub fn used(&self) -> usize {
        self.used
    }

    /// Whether any law has a memory.
    pub fn remembers(&self) -> bool {
        self.memories > 0
    }

    /// Fastest rate of all laws (rad/s).
    pub fn fastest(&self) -> f64 {
        let own = match self.machine {
            Machine::Servo { a1, .. } => a1,
            Machine::Rigid { mass, viscous, .. } => viscous / mass,
        };
        let laws = self.parts.iter().map(|p| p.law.fastest()).fold(own, f64::max);
        let column = |c: &Arc<dyn Column>| if self.loads() { c.fastest().max(c.relaxation()) } else { c.fastest() };
        self.column.as_ref().map_or(laws, |c| column(c).max(laws))
    }

    /// At rest at displacement `x` (m).
    pub fn at_rest(&self, x: f64) -> (State, State) {
        let (mut y, mut m) = ([0.0; MOST], [0.0; MOST]);
        y[X] = x;
        for (part, &(i, j)) in self.parts.iter().zip(&self.layout) {
            let law = &part.law;
            law.at_rest(x, &mut y[i..i + law.states()], &mut m[j..j + law.memories()]);
        }
        if let Some(column) = &self.column {
            column.at_rest(&mut y[self.column_at..self.used]);
        }
        (y, m)
    }

    /// The signal behind all laws at a place.
    fn through(&self, place: Place, now: &Now, input: f64, y: &State, m: &State) -> f64 {
        let mut signal = input;
        for (part, &(i, j)) in self.parts.iter().zip(&self.layout) {
            if part.place == place {
                let law = &part.law;
                signal = part.out(now, signal, &y[i..i + law.states()], &m[j..j + law.memories()]);
            }
        }
        signal
    }

    /// The same with the rates of the laws' states.
    fn moved(&self, place: Place, now: &Now, input: f64, y: &State, m: &State, dy: &mut State) -> f64 {
        let mut signal = input;
        for (part, &(i, j)) in self.parts.iter().zip(&self.layout) {
            if part.place == place {
                let law = &part.law;
                let (to, mto) = (i + law.states(), j + law.memories());
                law.rates(now, signal, &y[i..to], &m[j..mto], &mut dy[i..to]);
                signal = part.out(now, signal, &y[i..to], &m[j..mto]);
            }
        }
        signal
    }

    /// Velocity demand behind the limit and the laws of flow (m/s), from the opening.
    fn demand(&self, now: &Now, opening: f64, y: &State, m: &State) -> f64 {
        let Machine::Servo { b1, velocity_limit, .. } = self.machine else { return y[V] };
        let asked = y[Z] + b1 * opening;
        let limited = if self.parts.iter().any(|p| p.place == Place::Limit) {
            self.through(Place::Limit, now, asked, y, m)
        } else {
            asked.clamp(-velocity_limit, velocity_limit)
        };
        self.through(Place::Flow, now, limited, y, m)
    }

    fn free(&self) -> bool {
        self.column.is_some() || matches!(self.machine, Machine::Rigid { .. })
    }

    /// Velocities at an instant. `now` carries time, run, command, reference and the velocity one step before.
    pub fn motion(&self, now: &Now, y: &State, m: &State) -> Motion {
        let mut now = Now { x: y[X], path: y[PATH], ..*now };
        if self.free() {
            now.v = y[V];
        } else {
            let command = self.through(Place::Command, &now, now.command, y, m);
            let opening = self.through(Place::Valve, &now, command, y, m);
            now.v = self.demand(&now, opening, y, m);
        }
        let table = self.through(Place::Link, &now, now.v, y, m);
        now.ground = self.through(Place::Frame, &now, table, y, m);
        Motion { actuator: now.v, sensed: self.through(Place::SensedVelocity, &now, now.ground, y, m) }
    }

    /// Time derivative of every state; gives the instant as the laws saw it last.
    pub fn rates(&self, now: &Now, y: &State, m: &State, dy: &mut State) -> Now {
        dy[..self.used].fill(0.0);
        let mut now = Now { x: y[X], path: y[PATH], ..*now };
        if self.free() {
            now.v = y[V];
        }
        let command = self.moved(Place::Command, &now, now.command, y, m, dy);
        let opening = self.moved(Place::Valve, &now, command, y, m, dy);
        let flow = self.flow(&mut now, opening, y, m, dy);
        if !self.free() {
            now.v = flow;
        }
        let table = self.moved(Place::Link, &now, now.v, y, m, dy);
        now.ground = self.moved(Place::Frame, &now, table, y, m, dy);
        self.push(&mut now, opening, flow, y, m, dy);
        dy[X] = now.v;
        dy[PATH] = now.v.abs();
        self.moved(Place::Displacement, &now, y[X], y, m, dy);
        self.moved(Place::SensedVelocity, &now, now.ground, y, m, dy);
        now
    }

    fn flow(&self, now: &mut Now, opening: f64, y: &State, m: &State, dy: &mut State) -> f64 {
        let Machine::Servo { b1, velocity_limit, .. } = self.machine else { return 0.0 };
        let asked = y[Z] + b1 * opening;
        let limited = if self.parts.iter().any(|p| p.place == Place::Limit) {
            self.moved(Place::Limit, now, asked, y, m, dy)
        } else {
            asked.clamp(-velocity_limit, velocity_limit)
        };
        self.moved(Place::Flow, now, limited, y, m, dy)
    }

    /// Forces, and what they do to the motion.
    fn push(&self, now: &mut Now, opening: f64, flow: f64, y: &State, m: &State, dy: &mut State) {
        match self.machine {
            Machine::Servo { b1, b0, a1, .. } => {
                let asked = -a1 * y[Z] + (b0 - b1 * a1) * opening;
                if let Some(column) = &self.column {
                    let own = &y[self.column_at..self.used];
                    now.pressure = self.load(column.as_ref(), now, flow, y, m);
                    let q = self.moved(Place::Edge, now, flow, y, m, dy);
                    let lost = self.moved(Place::Leak, now, 0.0, y, m, dy);
                    let mut rates = [0.0; 8];
                    let count = column.states();
                    now.pressure = column.rates(now, q, lost, now.v, own, &mut rates[..count]);
                    dy[self.column_at..self.used].copy_from_slice(&rates[..count]);
                    now.drive = now.pressure;
                    let force = self.moved(Place::Force, now, 0.0, y, m, dy);
                    dy[Z] = asked;
                    dy[V] = now.pressure - force;
                    dy[IMPULSE] = force;
                } else {
                    now.drive = asked;
                    let force = self.moved(Place::Force, now, 0.0, y, m, dy);
                    dy[Z] = asked - force;
                    dy[IMPULSE] = force;
                }
            }
            Machine::Rigid { mass, viscous, gain } => {
                now.drive = (gain * opening - viscous * y[V]) / mass;
                let force = self.moved(Place::Force, now, 0.0, y, m, dy);
                dy[V] = now.drive - force;
                dy[IMPULSE] = force;
            }
        }
    }

    /// Displacement as its sensor gives it, before noise and counts (m).
    pub fn displacement(&self, now: &Now, y: &State, m: &State) -> f64 {
        self.through(Place::Displacement, now, y[X], y, m)
    }

    /// Acceleration as its sensor gives it from the mean over a sample (m/s2), before noise.
    pub fn acceleration(&self, now: &Now, mean: f64, y: &State, m: &State) -> f64 {
        self.through(Place::Acceleration, now, mean, y, m)
    }
}
