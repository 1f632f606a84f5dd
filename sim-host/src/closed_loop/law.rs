//! What closes the loop: the control core, or the plain PI law that answers are checked against.

use shakedown_core::{Controller, Sample};

/// What a law is told at one tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measured {
    /// Reference displacement, m.
    pub reference: f64,
    /// Measured displacement, m.
    pub displacement: f64,
    /// Measured acceleration, m/s2.
    pub acceleration: f64,
    /// Measured velocity, m/s, for laws that read a sensor of it.
    pub velocity: f64,
    /// Velocity of the reference, m/s, for laws that are supplied with it.
    pub reference_velocity: f64,
    /// Acceleration of the reference, m/s2, for laws that are supplied with it.
    pub reference_acceleration: f64,
    /// Pressure difference across the piston, Pa, for laws that read one; no number where no sensor is fitted.
    pub pressure_difference: f64,
}

/// What a law answers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Actuation {
    /// Valve command, m.
    pub valve: f64,
    /// The reference after record modification, m.
    pub reference: f64,
    /// The law holds the table's velocity to be at its limit.
    pub saturated: bool,
    /// An input was unusable and the last good output stands.
    pub held: bool,
}

/// A control law: once a tick, from what is measured to what the valve is told.
pub trait ControlLaw {
    /// One tick.
    fn step(&mut self, measured: &Measured) -> Actuation;
}

/// The very core that the firmware runs; numbers become `f32` at its edge, as they do behind a converter.
impl ControlLaw for Controller {
    #[inline]
    fn step(&mut self, measured: &Measured) -> Actuation {
        let command = Controller::step(
            self,
            &Sample {
                reference: measured.reference as f32,
                displacement: measured.displacement as f32,
                acceleration: measured.acceleration as f32,
                velocity: measured.velocity as f32,
                reference_velocity: measured.reference_velocity as f32,
                reference_acceleration: measured.reference_acceleration as f32,
                pressure_difference: measured.pressure_difference as f32,
                ..Sample::default()
            },
        );
        Actuation {
            valve: f64::from(command.valve),
            reference: f64::from(command.reference),
            saturated: command.status.saturated,
            held: command.status.held,
        }
    }
}

/// `u[k] = kp e[k] + ki dt (e[0] + ... + e[k])`, `e = reference - displacement`, in `f64`, with no limit of any kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlainPi {
    proportional: f64,
    integral_per_tick: f64,
    sum: f64,
}

impl PlainPi {
    /// Gains `proportional` (1) and `integral` (1/s) at `rate` ticks a second (Hz).
    pub fn new(proportional: f64, integral: f64, rate: f64) -> Self {
        Self { proportional, integral_per_tick: integral / rate, sum: 0.0 }
    }
}

impl ControlLaw for PlainPi {
    #[inline]
    fn step(&mut self, measured: &Measured) -> Actuation {
        let error = measured.reference - measured.displacement;
        self.sum += error;
        Actuation {
            valve: self.proportional * error + self.integral_per_tick * self.sum,
            reference: measured.reference,
            saturated: false,
            held: false,
        }
    }
}
