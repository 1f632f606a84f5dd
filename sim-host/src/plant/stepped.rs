//! A model with any effects, moved on step by step by whoever holds the clock: the plant of closed loops that run the core.
//!
//! The equations and their integration are [`super::simulate`]'s; here the command comes from outside. Sensors' own
//! effects are left to [`super::sensors`].

use super::Plant;
use super::effects::Effect;
use super::model::Baseline;
use super::simulate::{Placed, SimulateError, Start, dynamics};
use dynamics::{Dynamics, State};

/// A plant with effects at a fixed step.
#[derive(Debug)]
pub struct Stepped {
    dynamics: Dynamics<f64>,
    state: State<f64>,
    dt: f64,
    limit: f64,
    /// Whether the command reaches the valve as it is, so that a jump of it is seen at once.
    direct: bool,
}

impl Stepped {
    /// The plant at rest at `displacement` (m), to be moved on in steps of `dt` (s).
    pub fn new(
        baseline: &Baseline<f64>,
        effects: &[Placed<f64>],
        dt: f64,
        displacement: f64,
    ) -> Result<Self, SimulateError> {
        Self::with(baseline, effects, Vec::new(), dt, displacement)
    }

    /// The same with effects that are not in the library beside those that are.
    pub fn with(
        baseline: &Baseline<f64>,
        effects: &[Placed<f64>],
        others: Vec<Box<dyn Effect<f64>>>,
        dt: f64,
        displacement: f64,
    ) -> Result<Self, SimulateError> {
        let mut dynamics = Dynamics::new(baseline, effects)?;
        for effect in others {
            dynamics.mount(effect)?;
        }
        let state = dynamics.rest(&Start { displacement, velocity: 0.0, states: Vec::new() });
        let limit = match *baseline {
            Baseline::Servo { velocity_limit, .. } => velocity_limit,
            _ => f64::INFINITY,
        };
        let direct = dynamics.passes_commands();
        Ok(Self { dynamics, state, dt, limit, direct })
    }

    /// What the valve sees of `command` before anything moves.
    fn seen(&self, command: f64) -> f64 {
        if self.direct { command } else { self.state.spool }
    }
}

impl Plant for Stepped {
    fn step_length(&self) -> f64 {
        self.dt
    }

    fn advance(&mut self, command: f64, steps: usize) {
        self.state.command = command;
        for _ in 0..steps {
            self.dynamics.begin_step(&mut self.state, self.dt);
            self.dynamics.advance(&mut self.state, self.dt);
        }
    }

    fn displacement(&self) -> f64 {
        self.dynamics.sense_displacement(&self.state)
    }

    fn velocity(&self, command: f64) -> f64 {
        self.dynamics.velocity_now(&self.state, self.seen(command))
    }

    fn load(&self, command: f64) -> Option<f64> {
        self.dynamics.load_now(&self.state, self.seen(command), self.dt)
    }

    fn saturated(&self, command: f64) -> bool {
        let supply = self.dynamics.supply_pressure(&self.state).unwrap_or(1.0).max(0.0).sqrt();
        let flow = self.dynamics.flow_now(&self.state, self.seen(command));
        flow.abs() >= self.limit * supply * (1.0 - 1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::paper::{FixedStep, Paper};

    fn paper() -> Baseline<f64> {
        Baseline::Servo { b1: 0.69, b0: 138.0, a1: 57.65, velocity_limit: 0.242 }
    }

    #[test]
    fn without_effects_it_is_the_papers_plant() {
        let mut stepped = Stepped::new(&paper(), &[], 5e-4, 0.01).unwrap();
        let mut exact = FixedStep::new(Paper::default(), 5e-4, 0.01).unwrap();
        for k in 0..4000 {
            let u = 0.2 * (f64::from(k) * 0.01).sin();
            assert!((stepped.velocity(u) - exact.velocity(u)).abs() < 1e-7, "{k}");
            assert_eq!(stepped.saturated(u), exact.saturated(u), "{k}");
            stepped.advance(u, 2);
            exact.advance(u, 2);
            assert!((stepped.displacement() - exact.displacement()).abs() < 1e-7, "{k}");
        }
        assert!(stepped.load(0.0).is_none());
    }

    /// With compressible oil the load is the table's acceleration, whatever the command does at this instant.
    #[test]
    fn load_on_a_free_table_is_its_acceleration() {
        let oil = Placed { id: "oil_compliance", parameters: vec![12.0, 0.05] };
        let mut plant = Stepped::new(&paper(), &[oil], 1e-4, 0.0).unwrap();
        for k in 0..2000 {
            let u = 0.02 * (f64::from(k) * 2e-3).sin();
            let before = plant.velocity(u);
            plant.advance(u, 1);
            let load = plant.load(u).unwrap();
            plant.advance(u, 1);
            assert!(((plant.velocity(u) - before) / 2e-4 - load).abs() < 2e-3, "{k}");
        }
    }
}
