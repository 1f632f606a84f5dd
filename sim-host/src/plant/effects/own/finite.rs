//! Whether an effect of a user's own stays finite over what a table passes through.

use super::memory::Memory;
use super::state::OwnInputs;
use super::{Own, State};
use crate::scalar::{Dual, Scalar};

/// Where an expression, or its derivative, leaves the numbers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("is not finite at {at}; keep the ranges of its parameters away from there, or add what keeps it finite")]
pub(super) struct NotFinite {
    /// States and parameters, in words.
    pub at: String,
}

/// States at which it is tried: rest, and what is far beyond a table, both ways.
const TRIED: [f64; 5] = [0.0, 1e-3, -1e-3, 1.0, -1.0];

/// Tries each parameter at its ends, the others at their starts.
pub(super) fn check(own: &Own) -> Result<(), NotFinite> {
    let stated = &own.stated.parameters;
    let starts: Vec<f64> = stated.iter().map(|p| p.start).collect();
    for (i, p) in stated.iter().enumerate() {
        for value in [p.low, p.start, p.high] {
            let mut parameters = starts.clone();
            parameters[i] = value;
            check_at(own, &parameters)?;
        }
    }
    Ok(())
}

fn check_at(own: &Own, values: &[f64]) -> Result<(), NotFinite> {
    let used: Vec<State> = State::ALL.into_iter().filter(|s| own.program.uses(*s)).collect();
    for k in 0..TRIED.len().pow(used.len().min(3) as u32) {
        let mut rest = k;
        let mut tried = Vec::new();
        for state in &used {
            let value = TRIED[rest % TRIED.len()];
            rest /= TRIED.len();
            // Way and time only grow.
            tried.push((*state, if matches!(state, State::Path | State::Time) { 60.0 * value.abs() } else { value }));
        }
        for by in 0..=values.len() {
            let result = value_at(own, &tried, values, by);
            if !(result.value().is_finite() && result.part(1).is_finite()) {
                let states = tried.iter().map(|(s, v)| format!("{} = {v}", s.name()));
                let named = own.stated.parameters.iter().zip(values).map(|(p, v)| format!("{} = {v}", p.name));
                return Err(NotFinite { at: states.chain(named).collect::<Vec<_>>().join(", ") });
            }
        }
    }
    Ok(())
}

/// The expression with its derivative by one parameter, or past the last by all states together.
fn value_at(own: &Own, tried: &[(State, f64)], values: &[f64], by: usize) -> Dual<1> {
    let along = by == values.len();
    let state = |value: f64| if along { Dual::variable(value, 0) } else { Dual::from(value) };
    let mut seen = OwnInputs::<Dual<1>>::none();
    for (which, value) in tried {
        match which {
            State::Displacement => seen.displacement = state(*value),
            State::Velocity => seen.velocity = state(*value),
            State::Acceleration => seen.acceleration = state(*value),
            State::Command => seen.command = state(*value),
            State::VelocitySign => seen.velocity_sign = state(value.signum()),
            State::Path => seen.path = state(*value),
            State::Time => seen.time = *value,
        }
    }
    let variable = |(i, v): (usize, &f64)| if i == by { Dual::variable(*v, 0) } else { Dual::from(*v) };
    let parameters: Vec<Dual<1>> = values.iter().enumerate().map(variable).collect();
    own.program.value(|state| seen.of(state), &parameters, &Memory::new(own.program.memories()), 0.0)
}
