//! The plant's clock drives the control core: one closed-loop run.
//!
//! Timing. At `t_k` the sensors are read and the law decides; its command acts from `t_k` to `t_k+1`, with no delay. The
//! accelerometer gives the mean over the tick that just ended, `(v(t_k) - v(t_k-1)) / dt`, taken before the new command
//! acts, so that it is causal. Traces hold the true motion beside what was measured: `velocity[k]` is taken after the
//! command's update and `acceleration[k] = (v(t_k + dt/2) - v(t_k - dt/2)) / dt`, the mean over a sample: the command
//! feeds straight through into velocity, so that a point derivative would hold spikes that depend on the rate.

pub(crate) mod bench;
pub mod bode;
pub mod design;
pub(crate) mod feedforward;
pub(crate) mod frequency;
mod law;
pub mod learning;
pub(crate) mod margin;
pub(crate) mod named;
pub(crate) mod published;
pub(crate) mod saw_tooth;
pub(crate) mod scenario;
pub(crate) mod showcase;
pub mod sweep_recording;
pub mod table1;
pub(crate) mod trade_off;
pub(crate) mod trial;
pub(crate) mod twin;

pub use law::{Actuation, ControlLaw, Measured, PlainPi};

use crate::plant::Plant;
use crate::plant::paper::ParameterError;
use crate::plant::sensors::{SensorModel, Sensors};

/// The rates of one run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    rate: f64,
    half_steps: usize,
}

/// Most plant steps in a tick: a microsecond each at 1 kHz, where ten are exact.
const MOST_STEPS: usize = 1000;

/// Why a [`Clock`] was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ClockError {
    /// The control rate is not a usable number.
    #[error("control rate {0} Hz: it must lie between 1 and 1,000,000")]
    Rate(f64),
    /// A tick must hold an even number of plant steps, so that one ends half way through.
    #[error("{0} plant steps a tick: the number must be even and between 2 and {MOST_STEPS}")]
    Steps(usize),
}

impl Clock {
    /// `rate` control ticks a second (Hz), `steps` plant steps in each.
    pub fn new(rate: f64, steps: usize) -> Result<Self, ClockError> {
        if !(1.0..=1e6).contains(&rate) {
            return Err(ClockError::Rate(rate));
        }
        if !(2..=MOST_STEPS).contains(&steps) || !steps.is_multiple_of(2) {
            return Err(ClockError::Steps(steps));
        }
        Ok(Self { rate, half_steps: steps / 2 })
    }

    /// Control ticks a second, Hz.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Length of one plant step, s.
    pub fn plant_step(&self) -> f64 {
        0.5 / (self.rate * self.half_steps as f64)
    }
}

/// Why a loop could not be set up.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ClosedLoopError {
    /// The plant's parameters do not hold.
    #[error("plant: {0}")]
    Plant(#[from] ParameterError),
    /// The clock does not hold.
    #[error("clock: {0}")]
    Clock(#[from] ClockError),
    /// The core refused its settings.
    #[error("controller: {0}")]
    Settings(#[from] shakedown_core::SettingsError),
    /// The settings limit a force, and nothing says what pressure the table's load is.
    #[error("sensors: `area_per_mass` is missing: state piston area over moving mass, m2/kg, for the force limit")]
    AreaPerMass,
    /// The effects of the table do not make a plant.
    #[error("table: {0}")]
    Table(#[from] crate::plant::simulate::SimulateError),
}

/// `sensors` with the piston area over moving mass that the pressure damping of `settings` is set for, unless they state one: a
/// model knows loads by the acceleration they make, and only who set the law can say what pressure that is on this table.
pub(crate) fn pressure_by_settings(sensors: &SensorModel, settings: &shakedown_core::Settings) -> SensorModel {
    let stated = settings.tracking.and_then(|t| t.pressure).map(|p| f64::from(p.area_per_mass));
    SensorModel { area_per_mass: sensors.area_per_mass.or(stated), ..sensors.clone() }
}

/// What one run leaves behind, one value a control tick. Lengths are equal.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    /// Time between values, s.
    pub dt: f64,
    /// The reference asked for, m.
    pub reference: Vec<f64>,
    /// The reference after record modification, m.
    pub commanded: Vec<f64>,
    /// Valve command, m.
    pub command: Vec<f64>,
    /// True displacement, m.
    pub displacement: Vec<f64>,
    /// True velocity, m/s.
    pub velocity: Vec<f64>,
    /// True acceleration, m/s2, the mean over a sample.
    pub acceleration: Vec<f64>,
    /// Displacement as the LVDT gave it, m.
    pub measured_displacement: Vec<f64>,
    /// Acceleration as the accelerometer gave it, m/s2, the mean over the tick before.
    pub measured_acceleration: Vec<f64>,
    /// What happened at each tick.
    pub flags: Vec<Flags>,
}

impl Trace {
    /// The first tick at which the table's motion, or what is measured of it, is no number.
    fn first_without_number(&self) -> Option<usize> {
        let signals = [
            &self.displacement,
            &self.velocity,
            &self.acceleration,
            &self.measured_displacement,
            &self.measured_acceleration,
        ];
        signals.into_iter().filter_map(|signal| signal.iter().position(|value| !value.is_finite())).min()
    }
}

/// What happened at one tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Flags {
    /// The table's velocity was at its limit.
    pub saturated: bool,
    /// The law said that it was.
    pub detected: bool,
    /// The law held its output because an input was unusable.
    pub held: bool,
}

impl Trace {
    /// An empty trace with room for `n` ticks.
    fn with_capacity(dt: f64, n: usize) -> Self {
        let room = || Vec::with_capacity(n);
        Self {
            dt,
            reference: room(),
            commanded: room(),
            command: room(),
            displacement: room(),
            velocity: room(),
            acceleration: room(),
            measured_displacement: room(),
            measured_acceleration: room(),
            flags: Vec::with_capacity(n),
        }
    }

    /// Time spent at the velocity limit, s.
    pub fn saturated_s(&self) -> f64 {
        self.flags.iter().filter(|f| f.saturated).count() as f64 * self.dt
    }

    /// Stretches at the velocity limit, `(from, to)` in s; gaps shorter than `bridge` (s) are closed.
    pub fn saturated_stretches(&self, bridge: f64) -> Vec<(f64, f64)> {
        let mut stretches: Vec<(f64, f64)> = Vec::new();
        for (k, _) in self.flags.iter().enumerate().filter(|(_, f)| f.saturated) {
            let (from, to) = (k as f64 * self.dt, (k + 1) as f64 * self.dt);
            match stretches.last_mut() {
                Some(last) if from - last.1 <= bridge => last.1 = to,
                _ => stretches.push((from, to)),
            }
        }
        stretches
    }
}

/// Runs `law` against `plant` along `reference` (m, one value a tick).
///
/// The plant's step must be the clock's; where it is not, time runs by the plant's.
pub fn run<P: Plant, L: ControlLaw>(
    plant: &mut P,
    law: &mut L,
    sensors: &mut Sensors,
    reference: &[f64],
    clock: Clock,
) -> Trace {
    let mut trace = Trace::with_capacity(1.0 / clock.rate, reference.len());
    let mut command = 0.0;
    let mut rate_before = 0.0;
    let (mut before, mut middle) = (plant.velocity(command), plant.velocity(command));
    for (k, &wanted) in reference.iter().enumerate() {
        let rate_of_reference = if k == 0 { 0.0 } else { (wanted - reference[k - 1]) * clock.rate };
        let (time, x, v) = (k as f64 / clock.rate, plant.displacement(), plant.velocity(command));
        let mean = (v - before) * clock.rate;
        let (displacement, acceleration) = (sensors.displacement(time, x), sensors.acceleration(time, mean));
        let measured = Measured {
            reference: wanted,
            displacement,
            acceleration,
            velocity: sensors.velocity(v, (displacement, acceleration), clock.rate),
            reference_velocity: rate_of_reference,
            reference_acceleration: (rate_of_reference - rate_before) * clock.rate,
            // Stiff oil passes on what the table's mass asks for.
            pressure_difference: sensors.pressure_difference(plant.load(command).unwrap_or(mean)),
        };
        let out = law.step(&measured);
        (before, rate_before, command) = (v, rate_of_reference, out.valve);
        let after = plant.velocity(command);
        plant.advance(command, clock.half_steps);
        let at_half = plant.velocity(command);
        trace.reference.push(wanted);
        trace.commanded.push(out.reference);
        trace.command.push(command);
        trace.displacement.push(x);
        trace.velocity.push(after);
        trace.acceleration.push((at_half - middle) * clock.rate);
        trace.measured_displacement.push(measured.displacement);
        trace.measured_acceleration.push(measured.acceleration);
        trace.flags.push(Flags { saturated: plant.saturated(command), detected: out.saturated, held: out.held });
        middle = at_half;
        plant.advance(command, clock.half_steps);
    }
    trace
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::paper::{FixedStep, Paper};

    fn run_plain(paper: Paper, kp: f64, ki: f64, steps: usize, reference: &[f64]) -> Trace {
        let clock = Clock::new(1000.0, steps).unwrap();
        let mut plant = FixedStep::new(paper, clock.plant_step(), 0.0).unwrap();
        let mut law = PlainPi::new(kp, ki, 1000.0);
        run(&mut plant, &mut law, &mut Sensors::new(SensorModel::default()), reference, clock)
    }

    #[test]
    fn clock_refuses_what_cannot_run() {
        assert_eq!(Clock::new(f64::NAN, 10).map_err(|e| e.to_string()).unwrap_err().split(':').count(), 2);
        assert_eq!(Clock::new(1000.0, 3), Err(ClockError::Steps(3)));
        assert_eq!(Clock::new(1000.0, 0), Err(ClockError::Steps(0)));
        assert_eq!(Clock::new(1000.0, 1002), Err(ClockError::Steps(1002)));
    }

    #[test]
    fn the_number_of_plant_steps_changes_nothing() {
        let reference: Vec<f64> = (0..3000).map(|k| 0.075 * (12.566 * f64::from(k) * 1e-3).sin()).collect();
        let (two, ten) = [2, 10].map(|n| run_plain(Paper::default(), 10.0, 1.0, n, &reference)).into();
        for (a, b) in two.displacement.iter().zip(&ten.displacement) {
            assert!((a - b).abs() < 1e-12);
        }
        for (a, b) in two.acceleration.iter().zip(&ten.acceleration) {
            assert!((a - b).abs() < 1e-9);
        }
        assert!(two.saturated_s() > 1.0);
    }

    #[test]
    fn acceleration_sums_to_velocity() {
        let reference: Vec<f64> = (0..2000).map(|k| 0.01 * (6.0 * f64::from(k) * 1e-3).sin()).collect();
        let trace = run_plain(Paper::default(), 3.7, 0.6, 2, &reference);
        let gained: f64 = trace.acceleration.iter().sum::<f64>() * trace.dt;
        let last = trace.velocity.last().unwrap();
        assert!((gained - last).abs() < 1e-3 * trace.velocity.iter().fold(0.0f64, |m, v| m.max(v.abs())) + 1e-4);
        assert!((trace.velocity[1000] - trace.velocity[999]).abs() < 1e-3);
    }

    #[test]
    fn stretches_are_bridged() {
        let flags = |s: &[u8]| s.iter().map(|&b| Flags { saturated: b == b'x', ..Flags::default() }).collect();
        let trace = Trace { dt: 0.5, flags: flags(b".xx.x....x"), ..Trace::default() };
        assert_eq!(trace.saturated_stretches(0.5), vec![(0.5, 2.5), (4.5, 5.0)]);
        assert_eq!(trace.saturated_stretches(0.0), vec![(0.5, 1.5), (2.0, 2.5), (4.5, 5.0)]);
        assert_eq!(trace.saturated_s(), 2.0);
    }
}
