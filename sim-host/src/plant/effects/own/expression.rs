//! An expression as a tree: what it is made of, its dimension, and how it is written.

use super::State;
use super::dimension::Dimension;
use std::fmt;

/// A function of one argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Function {
    Abs,
    Sign,
    Sqrt,
    Exp,
    Ln,
    Sin,
    Cos,
    Tanh,
}

impl Function {
    fn name(self) -> &'static str {
        match self {
            Self::Abs => "abs",
            Self::Sign => "sign",
            Self::Sqrt => "sqrt",
            Self::Exp => "exp",
            Self::Ln => "ln",
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tanh => "tanh",
        }
    }
}

/// What joins two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Operation {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Max,
    Min,
    /// The left followed with a first-order lag of the right, s.
    Lag,
    /// The left followed with a play of the right either side.
    Play,
    /// The side of the left that a relay of the right's half width is on: 1 above, -1 below, as before between.
    Relay,
}

impl Operation {
    /// True where its value depends on what was before.
    pub(super) fn remembers(self) -> bool {
        matches!(self, Self::Lag | Self::Play | Self::Relay)
    }

    /// The name of one that is written as a call.
    fn called(self) -> Option<&'static str> {
        match self {
            Self::Max => Some("max"),
            Self::Min => Some("min"),
            Self::Lag => Some("lag"),
            Self::Play => Some("play"),
            Self::Relay => Some("relay"),
            _ => None,
        }
    }
}

/// An expression.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Tree {
    Number(f64),
    /// A name that was not looked up yet.
    Name(String),
    State(State),
    /// A parameter by its place, and its name for messages.
    Parameter(usize, String),
    Call(Function, Box<Tree>),
    Pair(Operation, Box<Tree>, Box<Tree>),
}

impl Default for Tree {
    fn default() -> Self {
        Self::Number(0.0)
    }
}

impl Tree {
    pub(super) fn pair(operation: Operation, a: Self, b: Self) -> Self {
        // A signed number is a number: what an exponent holds must be one.
        if let (Operation::Subtract, Self::Number(0.0), Self::Number(n)) = (operation, &a, &b) {
            return Self::Number(-n);
        }
        Self::Pair(operation, Box::new(a), Box::new(b))
    }

    pub(super) fn call(function: Function, a: Self) -> Self {
        Self::Call(function, Box::new(a))
    }

    /// With every name looked up: a parameter, a listed state by its name or its symbol, or pi.
    pub(super) fn resolved(self, parameters: &[&str], states: &[State]) -> Result<Self, String> {
        Ok(match self {
            Self::Name(name) => {
                if let Some(place) = parameters.iter().position(|p| *p == name) {
                    Self::Parameter(place, name)
                } else if name == "pi" {
                    Self::Number(std::f64::consts::PI)
                } else {
                    Self::State(listed(&name, parameters, states)?)
                }
            }
            Self::Call(Function::Sign, a) => match a.resolved(parameters, states)? {
                // Dry contact: the sign of velocity is what its bristles carry, not a step that chatters.
                Self::State(State::Velocity) => Self::State(State::VelocitySign),
                other => Self::call(Function::Sign, other),
            },
            Self::Call(function, a) => Self::call(function, a.resolved(parameters, states)?),
            Self::Pair(operation, a, b) => {
                Self::pair(operation, a.resolved(parameters, states)?, b.resolved(parameters, states)?)
            }
            done => done,
        })
    }

    /// True where it uses this state.
    pub(super) fn uses_state(&self, state: State) -> bool {
        match self {
            Self::State(s) => *s == state,
            Self::Call(_, a) => a.uses_state(state),
            Self::Pair(_, a, b) => a.uses_state(state) || b.uses_state(state),
            _ => false,
        }
    }

    /// True where it uses this parameter.
    pub(super) fn uses_parameter(&self, place: usize) -> bool {
        match self {
            Self::Parameter(p, _) => *p == place,
            Self::Call(_, a) => a.uses_parameter(place),
            Self::Pair(_, a, b) => a.uses_parameter(place) || b.uses_parameter(place),
            _ => false,
        }
    }

    /// True where it remembers what was before.
    pub(super) fn remembers(&self) -> bool {
        match self {
            Self::Call(_, a) => a.remembers(),
            Self::Pair(operation, a, b) => operation.remembers() || a.remembers() || b.remembers(),
            _ => false,
        }
    }

    /// Its dimension, from the parameters'.
    pub(super) fn dimension(&self, parameters: &[Dimension]) -> Result<Dimension, String> {
        match self {
            Self::Number(_) | Self::Name(_) => Ok(Dimension::NONE),
            Self::State(state) => Ok(state.dimension()),
            Self::Parameter(place, _) => Ok(parameters.get(*place).copied().unwrap_or_default()),
            Self::Call(function, a) => {
                let inside = a.dimension(parameters)?;
                match function {
                    Function::Abs => Ok(inside),
                    Function::Sign => Ok(Dimension::NONE),
                    Function::Sqrt => Ok(inside.to_the(0.5)),
                    _ if inside == Dimension::NONE => Ok(inside),
                    _ => Err(format!(
                        "`{self}` is taken of {inside}; it must be taken of a number: divide by a parameter"
                    )),
                }
            }
            Self::Pair(operation, a, b) => self.joined(*operation, a, b, parameters),
        }
    }

    fn joined(&self, operation: Operation, a: &Self, b: &Self, parameters: &[Dimension]) -> Result<Dimension, String> {
        let (left, right) = (a.dimension(parameters)?, b.dimension(parameters)?);
        match operation {
            Operation::Multiply => Ok(left.times(right)),
            Operation::Divide => Ok(left.times(right.to_the(-1.0))),
            Operation::Power => match (left == Dimension::NONE, b) {
                _ if right != Dimension::NONE => Err(format!("`{self}`: the exponent is {right}; it must be a number")),
                (true, _) => Ok(left),
                (false, Self::Number(power)) => Ok(left.to_the(*power)),
                (false, _) => Err(format!("`{self}`: {left} to a power that is not written out has no unit")),
            },
            Operation::Lag if right == Dimension::TIME => Ok(left),
            Operation::Lag => Err(format!("`{self}`: the lag `{b}` is {right}; it must be a time, s")),
            Operation::Relay if left == right => Ok(Dimension::NONE),
            // Nothing of a unit is nothing.
            _ if *a == Self::Number(0.0) => Ok(right),
            _ if *b == Self::Number(0.0) || left == right => Ok(left),
            _ => Err(format!("`{a}` is {left} and `{b}` is {right}: `{self}` has no unit")),
        }
    }
}

/// The state of a name, where it was listed.
fn listed(name: &str, parameters: &[&str], states: &[State]) -> Result<State, String> {
    match State::named(name) {
        Some(state) if states.contains(&state) => Ok(state),
        Some(State::VelocitySign) if states.contains(&State::Velocity) => Ok(State::VelocitySign),
        Some(state) => Err(format!("`{name}` is not in `states`; add \"{}\" there", state.name())),
        None => {
            let known: Vec<&str> = parameters.iter().copied().chain(states.iter().map(|s| s.name())).collect();
            let near = crate::files::nearest::nearest(name, known.iter().copied());
            let meant = near.map_or_else(String::new, |n| format!("; did you mean `{n}`?"));
            Err(format!("`{name}` is neither a parameter nor a state ({}){meant}", known.join(", ")))
        }
    }
}

impl fmt::Display for Tree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(n) => write!(f, "{n}"),
            Self::Name(name) | Self::Parameter(_, name) => write!(f, "{name}"),
            Self::State(state) => write!(f, "{}", state.name()),
            Self::Call(function, a) => write!(f, "{}({a})", function.name()),
            Self::Pair(operation, a, b) => {
                if let Some(name) = operation.called() {
                    return write!(f, "{name}({a}, {b})");
                }
                let sign = match operation {
                    Operation::Add => " + ",
                    Operation::Subtract => " - ",
                    Operation::Multiply => "*",
                    Operation::Divide => "/",
                    _ => "^",
                };
                let inside = |t: &Self| if matches!(t, Self::Pair(..)) { format!("({t})") } else { t.to_string() };
                write!(f, "{}{sign}{}", inside(a), inside(b))
            }
        }
    }
}
