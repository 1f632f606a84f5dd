//! What a plant shows to whoever moves it on from outside.

use super::super::SimulateError;
use super::{Dynamics, LOAD, Mounted, SPEED, State, TABLE};
use crate::plant::effects::{Effect, Instant};
use crate::plant::model::Baseline;
use crate::scalar::Scalar;

impl<S: Scalar, const M: usize> Dynamics<S, M> {
    /// Puts an effect in place that is not in the library.
    pub(in crate::plant) fn mount(&mut self, effect: Box<dyn Effect<S>>) -> Result<(), SimulateError> {
        let (first, last) = (self.used, self.used + effect.states());
        if last > M {
            return Err(SimulateError::TooManyStates { states: last });
        }
        self.mounted.push(Mounted { hooks: effect.hooks(), effect, first, last });
        self.used = last;
        Ok(())
    }

    /// Whether no effect stands between command and valve.
    pub(in crate::plant) fn passes_commands(&self) -> bool {
        !self.mounted.iter().any(|m| m.hooks.command)
    }

    /// The table's velocity with this at the valve, m/s.
    pub(in crate::plant) fn velocity_now(&self, state: &State<S, M>, spool: S) -> S {
        if self.yields { state.y[TABLE] } else { self.flow_now(state, spool) }
    }

    /// The velocity that the flow alone would give with this at the valve, m/s.
    pub(in crate::plant) fn flow_now(&self, state: &State<S, M>, spool: S) -> S {
        let y = &state.y;
        let mut scratch = [S::from(0.0); M];
        let mut opening = spool;
        for m in self.mounted.iter().filter(|m| m.hooks.valve) {
            opening = m.effect.valve(opening, &y[m.first..m.last], &mut scratch[m.first..m.last]);
        }
        let at = Instant {
            time: state.time,
            displacement: y[super::DISPLACEMENT],
            velocity: y[SPEED],
            sensed_velocity: S::from(0.0),
            velocity_limit: self.velocity_limit,
        };
        match self.baseline {
            Baseline::Servo { b1, .. } => self.flow(&at, y[SPEED] + b1 * opening, y),
            _ => y[SPEED],
        }
    }

    /// Load pressure over area and table mass, m/s2, where the actuator yields.
    pub(in crate::plant) fn load_now(&self, state: &State<S, M>, spool: S, h: f64) -> Option<S> {
        if self.compliance.oil.is_some() {
            return Some(state.y[LOAD]);
        }
        let mut dy = [S::from(0.0); M];
        self.yields.then(|| {
            let (_, force) = self.rates(state.time, spool, &state.y, h, &mut dy);
            dy[TABLE] + force
        })
    }
}
