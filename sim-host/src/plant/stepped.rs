//! A model with any effects, moved on step by step by whoever holds the clock: the plant of closed loops that run the core.
//!
//! The equations and their integration are [`super::simulate`]'s; here the command comes from outside. Sensors' own
//! effects are left to [`super::sensors`].

use super::Plant;
use super::effects::Effect;
use super::model::Baseline;
use super::simulate::{EffectParameters, MOST_STEPS, RESOLVED, SimulateError, Start, dynamics};
use dynamics::{Dynamics, State};

/// A plant with effects at a fixed step.
#[derive(Debug)]
pub struct Stepped {
    dynamics: Dynamics<f64>,
    state: State<f64>,
    dt: f64,
    /// Integration steps in one of these: what is fast in the equations is resolved whoever holds the clock.
    inner: usize,
    /// Whether the command reaches the valve as it is, so that a jump of it is seen at once.
    direct: bool,
}

impl Stepped {
    /// The plant at rest at `displacement` (m), to be moved on in steps of `dt` (s).
    pub fn new(
        baseline: &Baseline<f64>,
        effects: &[EffectParameters<f64>],
        dt: f64,
        displacement: f64,
    ) -> Result<Self, SimulateError> {
        Self::with(baseline, effects, Vec::new(), dt, displacement)
    }

    /// The same with effects that are not in the library beside those that are.
    pub fn with(
        baseline: &Baseline<f64>,
        effects: &[EffectParameters<f64>],
        others: Vec<Box<dyn Effect<f64>>>,
        dt: f64,
        displacement: f64,
    ) -> Result<Self, SimulateError> {
        let mut dynamics = Dynamics::new(baseline, effects)?;
        for effect in others {
            dynamics.mount(effect)?;
        }
        let state = dynamics.rest(&Start { displacement, velocity: 0.0, states: Vec::new(), time: 0.0 });
        let direct = dynamics.passes_commands();
        let inner = (dt * dynamics.fastest() / RESOLVED).ceil().clamp(1.0, MOST_STEPS) as usize;
        Ok(Self { dynamics, state, dt, inner, direct })
    }

    /// What the valve sees of `command` before anything moves.
    fn seen(&self, command: f64) -> f64 {
        if self.direct { self.dynamics.opened(command) } else { self.state.spool }
    }
}

impl Plant for Stepped {
    fn step_length(&self) -> f64 {
        self.dt
    }

    fn advance(&mut self, command: f64, steps: usize) {
        self.state.command = command;
        let h = self.dt / self.inner as f64;
        for _ in 0..steps * self.inner {
            self.dynamics.begin_step(&mut self.state, h);
            self.dynamics.advance(&mut self.state, h);
        }
    }

    fn displacement(&self) -> f64 {
        self.dynamics.sense_displacement(&self.state)
    }

    fn velocity(&self, command: f64) -> f64 {
        self.dynamics.velocity_now(&self.state, self.seen(command))
    }

    fn load(&self, command: f64) -> Option<f64> {
        self.dynamics.load_now(&self.state, self.seen(command))
    }

    fn saturated(&self, command: f64) -> bool {
        self.dynamics.overdriven(&self.state, self.seen(command))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::effects::entry;
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
        let oil = EffectParameters { id: "oil_compliance", parameters: vec![12.0, 0.05, 0.0, 0.0] };
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

    /// The valve is asked for more than the limit in force: of the direction it moves in, also where the limit is soft and the
    /// speed only comes near it, and where the supply has sagged.
    #[test]
    fn saturation_is_that_of_the_limit_in_force() {
        let of = |id: &'static str, parameters: &[f64], command: f64| {
            let details = entry(id).unwrap().parameters.iter().skip(parameters.len()).map(|p| p.high);
            let placed = EffectParameters { id, parameters: parameters.iter().copied().chain(details).collect() };
            let mut plant = Stepped::new(&paper(), &[placed], 5e-4, 0.0).unwrap();
            plant.advance(command, 2000);
            plant.saturated(command)
        };
        // A steady command u asks for 2.39 u m/s.
        let asks = |speed: f64| speed * 57.65 / 138.0;
        for (speed, saturated) in [(0.19, false), (0.21, true), (-0.14, false), (-0.16, true)] {
            assert_eq!(of("asymmetric_limit", &[0.2, 0.15], asks(speed)), saturated, "{speed} m/s");
        }
        for (speed, saturated) in [(0.20, false), (0.23, false), (0.26, true), (-0.26, true)] {
            assert_eq!(of("flow_softening", &[3.0], asks(speed)), saturated, "{speed} m/s, soft");
        }
        // Half the pressure is left after a second, and 0.7 of the limit and of the gain with it.
        assert!(!of("supply_droop", &[0.4, 0.2], asks(0.2)));
        assert!(of("supply_droop", &[0.4, 0.2], asks(0.3)));
    }
}
