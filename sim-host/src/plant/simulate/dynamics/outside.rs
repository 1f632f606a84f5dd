//! What a plant shows to whoever moves it on from outside.

use super::super::SimulateError;
use super::{Dynamics, LOAD, Mounted, STATES, State, TABLE, Work};
use crate::plant::effects::Effect;
use crate::scalar::Scalar;

impl<S: Scalar> Dynamics<S> {
    /// Puts an effect in place that is not in the library.
    pub(in crate::plant) fn mount(&mut self, effect: Box<dyn Effect<S>>) -> Result<(), SimulateError> {
        let (first, last) = (self.used, self.used + effect.states());
        if last > STATES {
            return Err(SimulateError::TooManyStates { states: last });
        }
        self.any = self.any.or(effect.hooks());
        self.mounted.push(Mounted { hooks: effect.hooks(), effect, first, last });
        self.used = last;
        Ok(())
    }

    /// Whether no effect stands between command and valve.
    pub(in crate::plant) fn passes_commands(&self) -> bool {
        !self.mounted.iter().any(|m| m.hooks.command)
    }

    /// The table's velocity with this at the valve, m/s.
    pub(in crate::plant) fn velocity_now(&self, state: &State<S>, spool: S) -> S {
        self.velocity_at(state.time, spool, &state.y)
    }

    /// The velocity that the flow alone would give with this at the valve, m/s.
    pub(in crate::plant) fn flow_now(&self, state: &State<S>, spool: S) -> S {
        self.flow_at(state.time, spool, &state.y)
    }

    /// Load pressure over area and table mass, m/s2, where the actuator yields.
    pub(in crate::plant) fn load_now(&self, state: &State<S>, spool: S, h: f64) -> Option<S> {
        if self.compliance.oil.is_some() {
            return Some(state.y[LOAD]);
        }
        self.yields.then(|| {
            let Work { k: [mut dy, ..], mut later, .. } = state.work.clone();
            self.rates(state.time, &self.opening(spool), &state.y, h, &mut dy, &mut later);
            dy[TABLE] + later.force
        })
    }
}
