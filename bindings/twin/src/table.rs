//! A table that is moved tick by tick, and what its sensors say of it.

use std::path::Path;

use shakedown::blocks::plant::Plant;
use shakedown::blocks::plant::sensors::{SensorModel, Sensors};
use shakedown::recording::Model;
use shakedown::simulate::{Clock, Twin};

/// Plant steps in half a tick: those of `shakedown run`.
const HALF_STEPS: usize = 5;

/// What is chosen of a table beside its model.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Options {
    /// Ticks a second, Hz.
    pub rate: f64,
    /// Where it rests at first, m.
    pub start: f64,
    /// Piston area over moving mass by which a load becomes a pressure difference, m2/kg; zero where no sensor is fitted, whose
    /// reading then is no number.
    pub area_per_mass: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { rate: 1000.0, start: 0.0, area_per_mass: 0.0 }
    }
}

/// What ideal sensors say at the end of a tick, before the next command acts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct Motion {
    /// Displacement from centre, m.
    pub displacement: f64,
    /// Velocity, m/s.
    pub velocity: f64,
    /// Acceleration, the mean over the tick, m/s2.
    pub acceleration: f64,
    /// Pressure difference across the piston, Pa.
    pub pressure_difference: f64,
}

/// A table in motion.
pub struct Table {
    plant: Box<dyn Plant>,
    sensors: Sensors,
    rate: f64,
    command: f64,
    motion: Motion,
}

impl std::fmt::Debug for Table {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Table").field("rate", &self.rate).field("motion", &self.motion).finish_non_exhaustive()
    }
}

impl Table {
    /// At rest, as a `table.toml` describes it; `name` is what messages call the text.
    pub fn new(name: &str, text: &str, options: &Options) -> Result<Self, String> {
        let refuse = |e: &dyn std::fmt::Display| format!("{name}: {e}");
        let sensors = Self::sensors(options)?;
        let clock = Clock::new(options.rate, 2 * HALF_STEPS).map_err(|e| e.to_string())?;
        let model = Model::from_text(Path::new(name), text).map_err(|e| e.to_string())?;
        let twin = Twin::of(&model).map_err(|e| refuse(&e))?;
        let plant = twin.plant(clock.plant_step(), options.start).map_err(|e| refuse(&e))?;
        let mut table = Self { plant, sensors, rate: options.rate, command: 0.0, motion: Motion::default() };
        table.motion.velocity = table.plant.velocity(0.0);
        table.motion = table.seen();
        Ok(table)
    }

    fn sensors(options: &Options) -> Result<Sensors, String> {
        if !options.start.is_finite() {
            return Err(format!("start {} m: expected a number", options.start));
        }
        let fitted = options.area_per_mass != 0.0;
        let model = SensorModel { area_per_mass: fitted.then_some(options.area_per_mass), ..SensorModel::default() };
        model.validate().map_err(|e| e.to_string())?;
        Ok(Sensors::new(model))
    }

    /// One tick with `command` (m) at the valve.
    pub fn step(&mut self, command: f64) -> Motion {
        self.command = command;
        // In halves, as `shakedown run` steps it.
        self.plant.advance(command, HALF_STEPS);
        self.plant.advance(command, HALF_STEPS);
        self.motion = self.seen();
        self.motion
    }

    /// What the sensors said last.
    pub fn motion(&self) -> Motion {
        self.motion
    }

    fn seen(&self) -> Motion {
        let velocity = self.plant.velocity(self.command);
        let acceleration = (velocity - self.motion.velocity) * self.rate;
        // Stiff oil passes on what the table's mass asks for.
        let load = self.plant.load(self.command).unwrap_or(acceleration);
        let pressure_difference = self.sensors.pressure_difference(load);
        Motion { displacement: self.plant.displacement(), velocity, acceleration, pressure_difference }
    }
}
