//! What a plant shows to whoever moves it on from outside.

use super::super::SimulateError;
use super::{DISPLACEMENT, Dynamics, EffectInstance, Instant, LOAD, SPEED, STATES, State, TABLE, Work};
use crate::plant::effects::Effect;
use crate::plant::model::Baseline;
use crate::scalar::Scalar;

impl<S: Scalar> Dynamics<S> {
    /// Puts an effect in place that is not in the library.
    pub(in crate::plant) fn mount(&mut self, effect: Box<dyn Effect<S>>) -> Result<(), SimulateError> {
        let (first, last) = (self.used, self.used + effect.states());
        if last > STATES {
            return Err(SimulateError::TooManyStates { states: last });
        }
        self.any = self.any.or(effect.hooks());
        self.mounted.push(EffectInstance { hooks: effect.hooks(), effect, opens: false, first, last });
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

    /// Whether the valve, with this at its spool, is asked for at least the limit in force, hard or soft.
    pub(in crate::plant) fn overdriven(&self, state: &State<S>, spool: S) -> bool {
        let Baseline::Servo { b1, .. } = self.baseline else { return false };
        let (y, speed) = (&state.y, state.y[SPEED]);
        let spool = if self.any.valve { self.hooked(spool, y) } else { spool };
        let at = Instant {
            time: state.time,
            displacement: y[DISPLACEMENT],
            velocity: speed,
            sensed_velocity: speed,
            velocity_limit: self.velocity_limit,
        };
        let flow = self.shaped(&at, y);
        let demand = ((speed + b1 * spool) * flow.gain).value();
        let limit = if demand < 0.0 { flow.negative } else { flow.positive };
        demand.abs() >= (limit * flow.limit).value() * (1.0 - 1e-9)
    }

    /// Load pressure over area and table mass, m/s2, where the actuator yields.
    pub(in crate::plant) fn load_now(&self, state: &State<S>, spool: S) -> Option<S> {
        if self.compliance.oil.is_some() {
            return Some(state.y[LOAD]);
        }
        self.yields.then(|| {
            let Work { k: [mut dy, ..], mut later, .. } = state.work.clone();
            self.rates(state.time, &self.opening(spool), &state.y, &mut dy, &mut later);
            dy[TABLE] + later.force
        })
    }
}
