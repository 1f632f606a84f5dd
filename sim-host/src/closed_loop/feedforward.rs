//! A table whose own controller stays in the loop (Fig. 2), and the paper's two tests that it has been cancelled.
//!
//! The hard-wired loop drives the valve with `kp (c - x)`, c being what it is sent. A controller outside that sends
//! `c = u + x` at unity `kp` drives the valve with u alone: the added displacement is the feedforward cancellation.
//! The hard-wired loop is analogue: here it runs at every plant step, while what is outside runs once a tick and holds
//! its output between, so that the cancellation is late by up to a tick, as on the real table.

use super::published::PublishedGains;
use super::{Actuation, Clock, ClosedLoopError, ControlLaw, Measured, PlainPi, Trace, named, run};
use crate::plant::Plant;
use crate::plant::paper::{FixedStep, Paper};
use crate::plant::sensors::{SensorModel, Sensors};
use shakedown_core::settings::InnerLoop;
use shakedown_core::{Controller, Settings};

/// A plant inside its hard-wired displacement loop; its command is the loop's reference, m.
#[derive(Debug, Clone)]
pub(crate) struct HardWired<P> {
    plant: P,
    inner: PlainPi,
    valve: f64,
}

impl<P: Plant> HardWired<P> {
    /// Closes the inner loop with gains `proportional` (1) and `integral` (1/s).
    pub(crate) fn new(plant: P, proportional: f64, integral: f64) -> Self {
        let inner = PlainPi::new(proportional, integral, 1.0 / plant.step_length());
        Self { plant, inner, valve: 0.0 }
    }
}

impl<P: Plant> Plant for HardWired<P> {
    fn step_length(&self) -> f64 {
        self.plant.step_length()
    }

    fn advance(&mut self, command: f64, steps: usize) {
        for _ in 0..steps {
            let displacement = self.plant.displacement();
            self.valve = self.inner.step(&Measured { reference: command, displacement, ..Measured::default() }).valve;
            self.plant.advance(self.valve, 1);
        }
    }

    fn displacement(&self) -> f64 {
        self.plant.displacement()
    }

    fn velocity(&self, _command: f64) -> f64 {
        self.plant.velocity(self.valve)
    }

    fn saturated(&self, _command: f64) -> bool {
        self.plant.saturated(self.valve)
    }
}

/// No controller outside: the hard-wired loop is sent the reference itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PassThrough;

impl ControlLaw for PassThrough {
    fn step(&mut self, measured: &Measured) -> Actuation {
        Actuation { valve: measured.reference, reference: measured.reference, saturated: false, held: false }
    }
}

/// A hard-wired unity loop with a controller of the core outside that cancels it.
fn cancelled(
    gains: PublishedGains,
    clock: Clock,
    start: f64,
) -> Result<(HardWired<FixedStep>, Controller), ClosedLoopError> {
    let plant = FixedStep::new(Paper::default(), clock.plant_step(), start)?;
    let settings = Settings { inner_loop: InnerLoop::Hardwired, ..named::settings(gains, clock.rate()) };
    Ok((HardWired::new(plant, 1.0, 0.0), Controller::new(&settings)?))
}

/// The paper's first test: from `start` (m) the table is told to stand at zero, and must end there without an offset.
pub(crate) fn track_zero(
    gains: PublishedGains,
    clock: Clock,
    start: f64,
    sensors: SensorModel,
) -> Result<Trace, ClosedLoopError> {
    let (mut table, mut law) = cancelled(gains, clock, start)?;
    // Ki / Kp is the slowest mode of these loops, 6 s at the gains in use: five of them.
    let reference = vec![0.0; (30.0 * clock.rate()) as usize];
    Ok(run(&mut table, &mut law, &mut Sensors::new(sensors), &reference, clock))
}

/// The paper's second test: the response along `reference` (m, one value a tick) with the built-in loop at the
/// displacement gains, and with the same gains outside, the built-in loop at unity gain and cancelled.
pub(crate) fn inside_and_outside(
    gains: PublishedGains,
    clock: Clock,
    reference: &[f64],
    sensors: &SensorModel,
) -> Result<(Trace, Trace), ClosedLoopError> {
    let plant = FixedStep::new(Paper::default(), clock.plant_step(), 0.0)?;
    let (kp, ki) = gains.displacement;
    let mut built_in = HardWired::new(plant, kp, ki);
    let inside = run(&mut built_in, &mut PassThrough, &mut Sensors::new(sensors.clone()), reference, clock);
    let (mut table, mut law) = cancelled(gains, clock, 0.0)?;
    let outside = run(&mut table, &mut law, &mut Sensors::new(sensors.clone()), reference, clock);
    Ok((inside, outside))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_loop::published::Named;

    fn clock() -> Clock {
        Clock::new(1000.0, 10).unwrap()
    }

    fn largest(values: impl Iterator<Item = f64>) -> f64 {
        values.fold(0.0, |m, v| m.max(v.abs()))
    }

    #[test]
    fn zero_is_tracked_from_an_offset_without_a_steady_error() {
        for named in [Named::Current, Named::Strong] {
            let trace = track_zero(named.gains(), clock(), 0.05, SensorModel::default()).unwrap();
            let tail = largest(trace.displacement[29_000..].iter().copied());
            assert_eq!(trace.displacement[0], 0.05);
            assert!(tail < 1e-4, "{tail} m");
            // With the LVDT's step, what is left is of that step's size.
            let trace = track_zero(named.gains(), clock(), 0.05, SensorModel::laboratory(1)).unwrap();
            let tail = largest(trace.displacement[29_000..].iter().copied());
            assert!(tail < 2e-4, "{tail} m");
        }
    }

    #[test]
    fn inside_and_outside_respond_alike() {
        let sine = |k: u32| 0.03 * (7.0 * f64::from(k) * 1e-3).sin();
        let reference: Vec<f64> = (0..10_000).map(sine).collect();
        let (inside, outside) =
            inside_and_outside(Named::Current.gains(), clock(), &reference, &SensorModel::default()).unwrap();
        let apart = |a: &Trace, b: &Trace| largest(a.displacement.iter().zip(&b.displacement).map(|(a, b)| a - b));
        assert!(apart(&inside, &outside) < 0.002 * 0.03, "{}", apart(&inside, &outside));
        // The check can fail: without the cancellation the loop closes twice.
        let plant = FixedStep::new(Paper::default(), clock().plant_step(), 0.0).unwrap();
        let mut law = Controller::new(&Named::Current.settings(1000.0)).unwrap();
        let sensors = &mut Sensors::new(SensorModel::default());
        let twice = run(&mut HardWired::new(plant, 1.0, 0.0), &mut law, sensors, &reference, clock());
        assert!(apart(&inside, &twice) > 0.05 * 0.03, "{}", apart(&inside, &twice));
    }

    /// With nothing outside, the hard-wired loop at unity gain is the paper's Eq. 4: it settles on what it is sent.
    #[test]
    fn the_hard_wired_loop_tracks_what_it_is_sent() {
        let plant = FixedStep::new(Paper::default(), clock().plant_step(), 0.05).unwrap();
        let mut table = HardWired::new(plant, 1.0, 0.0);
        let sensors = &mut Sensors::new(SensorModel::default());
        let trace = run(&mut table, &mut PassThrough, sensors, &vec![0.02; 10_000], clock());
        assert!((trace.displacement[9999] - 0.02).abs() < 1e-9);
        assert_eq!(trace.displacement[0], 0.05);
    }
}
