//! The interface of a law: what it sees of an instant, what it makes of the signal at its place, and where it acts.

use std::fmt::Debug;
use std::sync::Arc;

/// What a law may see of an instant. Laws before the actuator see its velocity one integration step late.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Now {
    /// Time of the run (s).
    pub t: f64,
    /// Number of the run within its case.
    pub run: u64,
    /// Displacement of the actuator (m).
    pub x: f64,
    /// Velocity of the actuator (m/s).
    pub v: f64,
    /// Velocity of the table, absolute (m/s).
    pub ground: f64,
    /// Command in force (unit of the command).
    pub command: f64,
    /// Force on the table before the forces at [`Place::Force`], per table mass (m/s2).
    pub drive: f64,
    /// Load pressure times area over table mass (m/s2).
    pub pressure: f64,
    /// Distance travelled so far (m).
    pub path: f64,
    /// Reference displacement (m).
    pub reference: f64,
}

/// Where a law acts: the signal that passes it. The order is that of the signal's way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Place {
    /// Command (its unit).
    Command,
    /// Spool opening in units of the command.
    Valve,
    /// Velocity demand in place of the limit (m/s): the law replaces it.
    Limit,
    /// Flow behind the limit, as a velocity (m/s).
    Flow,
    /// Flow through the loaded edges, as a velocity (m/s).
    Edge,
    /// Flow past the piston, as a velocity added up (m/s).
    Leak,
    /// Forces on the table against positive motion, added up, per table mass (m/s2).
    Force,
    /// Velocity from actuator to table (m/s).
    Link,
    /// Velocity from table to the inertial frame (m/s).
    Frame,
    /// Displacement sensor (m).
    Displacement,
    /// Accelerometer's dynamics, on the velocity (m/s).
    SensedVelocity,
    /// Accelerometer's output, mean over a sample (m/s2).
    Acceleration,
}

impl Place {
    /// The block of the file formats' `location.block`.
    pub fn block(self) -> &'static str {
        match self {
            Self::Command => "command",
            Self::Valve => "valve",
            Self::Limit | Self::Flow | Self::Edge => "flow",
            Self::Leak => "actuator",
            Self::Force | Self::Link | Self::Frame => "table",
            Self::Displacement | Self::SensedVelocity | Self::Acceleration => "sensor",
        }
    }
}

/// A piece of physics at a place. States are integrated with the plant; memories are updated once a step, so that jumps and
/// hysteresis need no small steps.
pub trait Law: Debug + Send + Sync {
    /// Number of smooth states.
    fn states(&self) -> usize {
        0
    }
    /// Number of memories.
    fn memories(&self) -> usize {
        0
    }
    /// States and memories at rest at displacement `x` (m); zero before the call.
    fn at_rest(&self, _x: f64, _y: &mut [f64], _m: &mut [f64]) {}
    /// Time derivatives of the states.
    fn rates(&self, _now: &Now, _input: f64, _y: &[f64], _m: &[f64], _dy: &mut [f64]) {}
    /// Updates the memories over `h` seconds.
    fn remember(&self, _now: &Now, _input: f64, _h: f64, _m: &mut [f64]) {}
    /// Updates the memories from the law's own states, once a step.
    fn watch(&self, _y: &[f64], _m: &mut [f64]) {}
    /// The signal behind the law. Forces and leaks add to what comes in.
    fn out(&self, now: &Now, input: f64, y: &[f64], m: &[f64]) -> f64;
    /// Supply pressure over its start (1), where the law holds one.
    fn supply(&self, _y: &[f64]) -> Option<f64> {
        None
    }
    /// Fastest rate in the law (rad/s); bounds the integration step.
    fn fastest(&self) -> f64 {
        0.0
    }
}

/// Compressible oil between valve and piston.
pub trait Column: Debug + Send + Sync {
    /// Number of states.
    fn states(&self) -> usize;
    /// States at rest; zero before the call.
    fn at_rest(&self, _y: &mut [f64]) {}
    /// Load pressure that the states hold without what damps them, times area over table mass (m/s2).
    fn spring(&self, now: &Now, y: &[f64]) -> f64;
    /// Rates of the states under a flow `q`, a leak `lost` and the piston's velocity `v` (m/s); gives the load pressure that
    /// acts on the piston (m/s2), which falls as the leak grows.
    fn rates(&self, now: &Now, q: f64, lost: f64, v: f64, y: &[f64], dy: &mut [f64]) -> f64;
    /// Fastest rate (rad/s).
    fn fastest(&self) -> f64;
    /// Rate at which the states would follow the flow through a leak without resistance (rad/s): spring over damper.
    fn relaxation(&self) -> f64;
}

/// A quantity that a region of state is stated in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// Displacement (m).
    Displacement,
    /// Velocity (m/s).
    Velocity,
    /// Absolute velocity (m/s).
    Speed,
    /// Command (its unit).
    Command,
}

impl Variable {
    /// Its name in the file formats.
    pub fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity | Self::Speed => "velocity",
            Self::Command => "command",
        }
    }

    fn of(self, now: &Now) -> f64 {
        match self {
            Self::Displacement => now.x,
            Self::Velocity => now.v,
            Self::Speed => now.v.abs(),
            Self::Command => now.command,
        }
    }
}

/// Where or when a law acts; its edges are rounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gate {
    /// In one run only, between two instants (s).
    Time {
        /// Number of the run; none where it is every run.
        run: Option<u64>,
        /// From (s).
        from: f64,
        /// To (s).
        to: f64,
    },
    /// In a region of state.
    State {
        /// Quantity.
        variable: Variable,
        /// From.
        low: f64,
        /// To.
        high: f64,
        /// Width of the rounded edges, in the unit of the quantity.
        edge: f64,
    },
}

impl Gate {
    /// How far it is open (0 to 1).
    pub fn open(&self, now: &Now) -> f64 {
        match *self {
            Self::Time { run, from, to } => {
                if run.is_some_and(|number| number != now.run) {
                    return 0.0;
                }
                ramp((now.t - from) / 0.05) * ramp((to - now.t) / 0.05)
            }
            Self::State { variable, low, high, edge } => {
                let value = variable.of(now);
                ramp((value - low) / edge + 0.5) * ramp((high - value) / edge + 0.5)
            }
        }
    }
}

/// Zero below 0, one above 1, smooth between.
fn ramp(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}

/// A law at its place.
#[derive(Debug, Clone)]
pub struct Part {
    /// Place.
    pub place: Place,
    /// Law.
    pub law: Arc<dyn Law>,
    /// Where it acts; everywhere without.
    pub gate: Option<Gate>,
}

impl Part {
    /// The signal behind the part.
    pub fn out(&self, now: &Now, input: f64, y: &[f64], m: &[f64]) -> f64 {
        let out = self.law.out(now, input, y, m);
        self.gate.as_ref().map_or(out, |gate| input + gate.open(now) * (out - input))
    }
}

#[cfg(test)]
mod tests {
    use super::{Gate, Now, Variable};

    #[test]
    fn a_gate_is_open_inside_and_shut_outside() {
        let gate = Gate::State { variable: Variable::Speed, low: 0.1, high: 0.2, edge: 0.01 };
        let at = |v: f64| gate.open(&Now { v, ..Now::default() });
        assert_eq!((at(0.05), at(-0.15), at(0.3)), (0.0, 1.0, 0.0));
        let window = Gate::Time { run: Some(2), from: 1.0, to: 3.0 };
        assert_eq!(window.open(&Now { t: 2.0, run: 2, ..Now::default() }), 1.0);
        assert_eq!(window.open(&Now { t: 2.0, run: 1, ..Now::default() }), 0.0);
        assert_eq!(window.open(&Now { t: 3.5, run: 2, ..Now::default() }), 0.0);
    }
}
