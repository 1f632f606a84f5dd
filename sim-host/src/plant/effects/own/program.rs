//! An expression made ready to be evaluated on any scalar: its steps in the order in which they are taken.

use super::dimension::Dimension;
use super::expression::{Function, Operation, Tree};
use crate::scalar::Scalar;

/// What of the plant an expression can see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Displacement of the table, m.
    Displacement,
    /// Velocity, m/s.
    Velocity,
    /// Acceleration that the accelerometer would show, m/s2.
    Acceleration,
    /// The command, unit of u.
    Command,
    /// Sign of the velocity as a dry contact has it, -1 to 1.
    VelocitySign,
    /// Way travelled since the start, m.
    Path,
    /// Time since the start, s.
    Time,
}

impl State {
    /// Every state.
    pub const ALL: [Self; 7] = [
        Self::Displacement,
        Self::Velocity,
        Self::Acceleration,
        Self::Command,
        Self::VelocitySign,
        Self::Path,
        Self::Time,
    ];

    /// Its name in files and expressions.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Command => "command",
            Self::VelocitySign => "velocity_sign",
            Self::Path => "path",
            Self::Time => "time",
        }
    }

    /// The state of a name, or of the symbol by which textbooks call it.
    pub(super) fn named(name: &str) -> Option<Self> {
        let symbol = match name {
            "x" => "displacement",
            "v" => "velocity",
            "a" => "acceleration",
            "u" => "command",
            "t" => "time",
            other => other,
        };
        Self::ALL.into_iter().find(|state| state.name() == symbol)
    }

    pub(super) fn dimension(self) -> Dimension {
        match self {
            Self::Displacement | Self::Path => Dimension::LENGTH,
            Self::Velocity => Dimension::VELOCITY,
            Self::Acceleration => Dimension::ACCELERATION,
            Self::Command => Dimension::COMMAND,
            Self::VelocitySign => Dimension::NONE,
            Self::Time => Dimension::TIME,
        }
    }
}

/// The values of every state.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen<S> {
    pub(super) displacement: S,
    pub(super) velocity: S,
    pub(super) acceleration: S,
    pub(super) command: S,
    pub(super) velocity_sign: S,
    pub(super) path: S,
    pub(super) time: f64,
}

impl<S: Scalar> Seen<S> {
    pub(super) fn none() -> Self {
        let zero = S::from(0.0);
        Self {
            displacement: zero,
            velocity: zero,
            acceleration: zero,
            command: zero,
            velocity_sign: zero,
            path: zero,
            time: 0.0,
        }
    }

    fn of(&self, state: State) -> S {
        match state {
            State::Displacement => self.displacement,
            State::Velocity => self.velocity,
            State::Acceleration => self.acceleration,
            State::Command => self.command,
            State::VelocitySign => self.velocity_sign,
            State::Path => self.path,
            State::Time => S::from(self.time),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    Number(f64),
    State(State),
    Parameter(usize),
    Call(Function),
    /// A power with a number in the exponent.
    Power(f64),
    Pair(Operation),
}

/// Values kept at once.
const DEPTH: usize = 12;

/// The steps.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Program {
    steps: Vec<Step>,
    states: Vec<State>,
}

impl Program {
    /// Of a tree whose names are looked up.
    pub(super) fn of(tree: &Tree) -> Result<Self, String> {
        let mut steps = Vec::new();
        let depth = write(tree, &mut steps);
        if depth > DEPTH {
            return Err(format!("is nested {depth} deep, more than {DEPTH}; split it into two effects"));
        }
        let states = State::ALL.into_iter().filter(|s| tree.uses_state(*s)).collect();
        Ok(Self { steps, states })
    }

    pub(super) fn uses(&self, state: State) -> bool {
        self.states.contains(&state)
    }

    /// The value.
    pub(super) fn value<S: Scalar>(&self, seen: &Seen<S>, parameters: &[S]) -> S {
        let mut kept = [S::from(0.0); DEPTH];
        let mut top = 0;
        for step in &self.steps {
            match *step {
                Step::Number(_) | Step::State(_) | Step::Parameter(_) => {
                    kept[top.min(DEPTH - 1)] = match *step {
                        Step::State(state) => seen.of(state),
                        Step::Parameter(i) => parameters.get(i).copied().unwrap_or(S::from(0.0)),
                        Step::Number(n) => S::from(n),
                        _ => S::from(0.0),
                    };
                    top += 1;
                }
                Step::Call(function) => kept[top - 1] = call(function, kept[top - 1]),
                Step::Power(n) => kept[top - 1] = power(kept[top - 1], n),
                Step::Pair(operation) => {
                    top -= 1;
                    kept[top - 1] = pair(operation, kept[top - 1], kept[top]);
                }
            }
        }
        kept[0]
    }
}

/// Writes a tree's steps, deepest first, and says how many values they keep at once.
fn write(tree: &Tree, steps: &mut Vec<Step>) -> usize {
    match tree {
        Tree::Number(n) => steps.push(Step::Number(*n)),
        Tree::Name(_) => steps.push(Step::Number(0.0)),
        Tree::State(state) => steps.push(Step::State(*state)),
        Tree::Parameter(place, _) => steps.push(Step::Parameter(*place)),
        Tree::Call(function, a) => {
            let depth = write(a, steps);
            steps.push(Step::Call(*function));
            return depth;
        }
        Tree::Pair(operation, a, b) => {
            if let (Operation::Power, Tree::Number(n)) = (operation, &**b) {
                let depth = write(a, steps);
                steps.push(Step::Power(*n));
                return depth;
            }
            let (left, right) = (write(a, steps), write(b, steps));
            steps.push(Step::Pair(*operation));
            return left.max(right + 1);
        }
    }
    1
}

fn call<S: Scalar>(function: Function, a: S) -> S {
    match function {
        Function::Abs => a.abs(),
        Function::Sign => S::from(if a.value() > 0.0 {
            1.0
        } else if a.value() < 0.0 {
            -1.0
        } else {
            0.0
        }),
        Function::Sqrt => a.sqrt(),
        Function::Exp => a.exp(),
        Function::Ln => a.ln(),
        Function::Sin => a.sin(),
        Function::Cos => a.cos(),
        Function::Tanh => a.tanh(),
    }
}

fn pair<S: Scalar>(operation: Operation, a: S, b: S) -> S {
    match operation {
        Operation::Add => a + b,
        Operation::Subtract => a - b,
        Operation::Multiply => a * b,
        Operation::Divide => a / b,
        // A base of nothing has no logarithm, and stays nothing.
        Operation::Power if a.value() == 0.0 => S::from(0.0_f64.powf(b.value())),
        Operation::Power => a.pow(b),
        Operation::Max => a.max(b),
        Operation::Min => a.min(b),
    }
}

/// `a` to a number: by value and derivative, so that a negative base may have a whole exponent.
fn power<S: Scalar>(a: S, n: f64) -> S {
    let x = a.value();
    if n.fract() == 0.0 && n.abs() <= 9.0 {
        let n = n as i32;
        return a.chain(x.powi(n), f64::from(n) * x.powi(n - 1));
    }
    a.chain(x.powf(n), n * x.powf(n - 1.0))
}
