//! Effects of a user's own: a place in the signal path, an expression in the plant's states and in parameters.
//!
//! They are read from `[[effect]]` (`recording::own_effect`), checked here for names, units and finiteness, and from then on are
//! effects as the library's: simulated with derivatives, fitted, compared and plotted. What an expression gives is decided by
//! its place and its unit: see [`Sense`].

mod act;
mod check;
mod dimension;
mod expression;
mod finite;
mod grammar;
mod memory;
mod program;
mod register;
mod state;

pub(super) use act::build;
pub(in super::super) use act::is_force;
pub(crate) use dimension::Dimension;
pub(crate) use register::{found, register};
pub(crate) use state::State;

use super::{Ends, Entry, Family, Order, Parameter, Role, SignalScale, Stage};
use crate::plant::model::Kind;
use program::Program;

/// What the expression of an effect gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sense {
    /// A force that opposes positive motion, per table mass, m/s2.
    ForcePerMass,
    /// The same in newtons, for a rigid mass.
    Force,
    /// What is added to the command before the valve, unit of u.
    Command,
    /// What is added to one as a factor on the flow gain.
    Gain,
    /// What is added to what the displacement sensor shows, m.
    Displacement,
    /// What is added to what the accelerometer shows, m/s2.
    Acceleration,
}

impl Sense {
    /// What an expression of this dimension means at a place; otherwise the units that would do there.
    fn of(stage: Stage, dimension: Dimension) -> Result<Self, &'static str> {
        let all: &[(Self, Dimension)] = match stage {
            Stage::Command | Stage::Valve => &[(Self::Command, Dimension::COMMAND)],
            Stage::Flow => &[(Self::Gain, Dimension::NONE)],
            Stage::Actuator | Stage::Table | Stage::Payload => {
                &[(Self::ForcePerMass, Dimension::ACCELERATION), (Self::Force, Dimension::FORCE)]
            }
            Stage::Sensor => &[(Self::Displacement, Dimension::LENGTH), (Self::Acceleration, Dimension::ACCELERATION)],
        };
        let wanted = match stage {
            Stage::Command | Stage::Valve => "the unit of the command, `u` (it is added to the command)",
            Stage::Flow => "`1` (it is added to one as a factor on the flow gain)",
            Stage::Actuator | Stage::Table | Stage::Payload => {
                "m/s2 (a force per table mass that opposes positive motion) or, for a rigid mass, N"
            }
            Stage::Sensor => "m (added to the displacement shown) or m/s2 (added to the acceleration shown)",
        };
        all.iter().find(|(_, d)| *d == dimension).map(|(sense, _)| *sense).ok_or(wanted)
    }

    /// The states that can be had where it acts.
    pub(crate) fn states(self) -> &'static [State] {
        use State::{Acceleration, Command, Displacement, Path, Time, Velocity, VelocitySign};
        match self {
            Self::ForcePerMass | Self::Force | Self::Gain | Self::Command | Self::Displacement => {
                &[Command, Displacement, Velocity, VelocitySign, Path, Time]
            }
            Self::Acceleration => &[Acceleration, Command, Displacement, Velocity, VelocitySign, Path, Time],
        }
    }

    fn kinds(self, states: &[State]) -> &'static [Kind] {
        match self {
            // A force balance knows the motion and no command.
            Self::ForcePerMass if states.contains(&State::Command) => &[Kind::Servo],
            Self::ForcePerMass => &[Kind::Servo, Kind::ForceBalance],
            Self::Force => &[Kind::RigidMass],
            Self::Gain => &[Kind::Servo],
            Self::Command | Self::Displacement | Self::Acceleration => &[Kind::Servo, Kind::RigidMass],
        }
    }

    fn equation(self, expression: &str) -> String {
        match self {
            Self::ForcePerMass | Self::Force => format!("f = {expression}"),
            Self::Command => format!("u + {expression}"),
            Self::Gain => format!("b0 (1 + {expression})"),
            Self::Displacement => format!("x + {expression}"),
            Self::Acceleration => format!("a + {expression}"),
        }
    }
}

/// A parameter as a user states it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StatedParameter {
    /// Its name in the expression.
    pub name: String,
    /// Its unit, SI.
    pub unit: String,
    /// Smallest value that makes sense.
    pub low: f64,
    /// Largest value that makes sense.
    pub high: f64,
    /// Where a fit starts.
    pub start: f64,
    /// Meaning, where it was said.
    pub meaning: String,
}

/// An effect as a user states it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stated {
    /// Identifier.
    pub id: String,
    /// Where it acts.
    pub stage: Stage,
    /// The states its expression uses, by their names.
    pub states: Vec<String>,
    /// The expression.
    pub expression: String,
    /// Its parameters.
    pub parameters: Vec<StatedParameter>,
    /// Effects of the library it is mistaken for.
    pub mistaken_for: Vec<String>,
}

/// Which key of an effect is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Key {
    /// `id`.
    Id,
    /// `states`.
    States,
    /// `expression`.
    Expression,
    /// `parameters.NAME`.
    Parameter(String),
    /// `mistaken_for`.
    MistakenFor,
}

/// What is wrong with an effect, and in which key.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{why}")]
pub(crate) struct Wrong {
    /// The key.
    pub key: Key,
    /// What and what to do.
    pub why: String,
}

fn wrong(key: Key, why: impl Into<String>) -> Wrong {
    Wrong { key, why: why.into() }
}

/// Longest expression, bytes.
const LONGEST: usize = 400;

/// A checked effect, ready to be registered.
#[derive(Debug, Clone)]
pub(crate) struct Own {
    stated: Stated,
    sense: Sense,
    program: Program,
}

impl Own {
    /// Checks names, units and finiteness; what is wrong comes with its key, the first of each effect.
    pub(crate) fn new(stated: Stated) -> Result<Self, Wrong> {
        check::names(&stated)?;
        let states = check::states(&stated)?;
        let text = stated.expression.as_str();
        if text.len() > LONGEST {
            return Err(wrong(
                Key::Expression,
                format!("is longer than {LONGEST} characters; split it into two effects"),
            ));
        }
        let tree = grammar::parse(text).map_err(|why| wrong(Key::Expression, why))?;
        let names: Vec<&str> = stated.parameters.iter().map(|p| p.name.as_str()).collect();
        let tree = tree.resolved(&names, &states).map_err(|why| wrong(Key::Expression, why))?;
        check::used(&stated, &states, &tree)?;
        let units = check::units(&stated)?;
        let dimension = tree.dimension(&units).map_err(|why| wrong(Key::Expression, why))?;
        let sense = Sense::of(stated.stage, dimension).map_err(|wanted| {
            let place = stated.stage.name();
            wrong(Key::Expression, format!("gives {dimension}; at the {place} it must give {wanted}"))
        })?;
        check::reach(&stated, sense, &states)?;
        check::memory(sense, &tree)?;
        let program = Program::of(&tree).map_err(|why| wrong(Key::Expression, why))?;
        let own = Self { stated, sense, program };
        finite::check(&own).map_err(|why| wrong(Key::Expression, why.to_string()))?;
        Ok(own)
    }

    /// The entry that the rest of the project reads; its text lives as long as the process.
    fn entry(&self) -> Entry {
        let keep = |text: String| -> &'static str { Box::leak(text.into_boxed_str()) };
        let parameters: Vec<Parameter> = self.stated.parameters.iter().map(|p| parameter(p, keep)).collect();
        let mistaken: Vec<&'static str> = self.stated.mistaken_for.iter().map(|id| keep(id.clone())).collect();
        Entry {
            id: keep(self.stated.id.clone()),
            equation: keep(self.sense.equation(&self.stated.expression)),
            stage: self.stated.stage,
            family: Family::Sensors,
            parameters: Box::leak(parameters.into_boxed_slice()),
            kinds: self.sense.kinds(self.program.states()),
            frees: &[],
            signature: "an effect of the user's own",
            mistaken_for: Box::leak(mistaken.into_boxed_slice()),
            test: "a run in which the states of its expression reach further",
            order: Order::Second,
            contains: &[],
            counter: None,
        }
    }
}

fn parameter(stated: &StatedParameter, keep: impl Fn(String) -> &'static str) -> Parameter {
    let unit = keep(stated.unit.clone());
    Parameter {
        key: keep(stated.name.clone()),
        unit,
        rigid_unit: unit,
        meaning: keep(stated.meaning.clone()),
        signal_scale: SignalScale::One,
        low: stated.low,
        high: stated.high,
        starts: Box::leak(vec![stated.start].into_boxed_slice()),
        positive: stated.low > 0.0,
        simple: Ends::Low,
        role: Role::Shared,
    }
}

#[cfg(test)]
mod tests;
