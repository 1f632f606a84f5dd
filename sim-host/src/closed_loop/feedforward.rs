//! A table whose own controller stays in the loop (Fig. 2), and the paper's two tests that it has been cancelled.
//!
//! The hard-wired loop drives the valve with `kp (c - x)`, c being what it is sent. A controller outside that sends
//! `c = u + x` at unity `kp` drives the valve with u alone: the added displacement is the feedforward cancellation.
//! The hard-wired loop is analogue: here it runs at every plant step, while what is outside runs once a tick and holds
//! its output between, so that the cancellation is late by up to a tick, as on the real table.

use super::{Actuation, Law, Measured, PlainPi};
use crate::plant::Plant;

/// A plant inside its hard-wired displacement loop; its command is the loop's reference, m.
#[derive(Debug, Clone)]
pub struct HardWired<P> {
    plant: P,
    inner: PlainPi,
    valve: f64,
}

impl<P: Plant> HardWired<P> {
    /// Closes the inner loop with gains `proportional` (1) and `integral` (1/s).
    pub fn new(plant: P, proportional: f64, integral: f64) -> Self {
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
            self.valve = self.inner.step(&Measured { reference: command, displacement, acceleration: 0.0 }).valve;
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
pub struct PassThrough;

impl Law for PassThrough {
    fn step(&mut self, measured: &Measured) -> Actuation {
        Actuation { valve: measured.reference, reference: measured.reference, saturated: false, held: false }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_loop::{Clock, run};
    use crate::plant::paper::{FixedStep, Paper};
    use crate::plant::sensors::{SensorModel, Sensors};

    /// With nothing outside, the hard-wired loop at unity gain is the paper's Eq. 4: it settles on what it is sent.
    #[test]
    fn the_hard_wired_loop_tracks_what_it_is_sent() {
        let clock = Clock::new(1000.0, 10).unwrap();
        let plant = FixedStep::new(Paper::default(), clock.plant_step(), 0.05).unwrap();
        let mut table = HardWired::new(plant, 1.0, 0.0);
        let sensors = &mut Sensors::new(SensorModel::default());
        let trace = run(&mut table, &mut PassThrough, sensors, &vec![0.02; 10_000], clock);
        assert!((trace.displacement[9999] - 0.02).abs() < 1e-9);
        assert_eq!(trace.displacement[0], 0.05);
    }
}
