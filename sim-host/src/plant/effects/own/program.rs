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

    /// The values alone.
    pub(super) fn plain(&self) -> Seen<f64> {
        Seen {
            displacement: self.displacement.value(),
            velocity: self.velocity.value(),
            acceleration: self.acceleration.value(),
            command: self.command.value(),
            velocity_sign: self.velocity_sign.value(),
            path: self.path.value(),
            time: self.time,
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
    /// What remembers, and where its memory is.
    Recall(Operation, usize),
}

/// Values kept at once.
const DEPTH: usize = 12;

/// The steps.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Program {
    steps: Vec<Step>,
    states: Vec<State>,
    /// Memories that its lags and plays need.
    memories: usize,
    /// It is its first parameter times what does not use it.
    scaled: bool,
}

/// What the lags and plays of a program hold.
#[derive(Debug, Clone)]
pub(super) struct Memory<S> {
    held: Vec<S>,
    begun: bool,
}

impl<S: Scalar> Memory<S> {
    /// Of a program that has seen nothing yet: everything is at rest where it is.
    pub(super) fn of(program: &Program) -> Self {
        Self { held: vec![S::from(0.0); program.memories], begun: false }
    }

    /// All at zero, as if the past had been there.
    pub(super) fn at_zero(program: &Program) -> Self {
        Self { begun: true, ..Self::of(program) }
    }

    /// What follows `input` now, `elapsed` seconds after the memory was settled.
    fn follow(&self, (how, slot): (Operation, usize), input: S, by: S, elapsed: f64) -> S {
        let side = |held: S| {
            let (input, by) = (input.value(), by.value());
            if input > by {
                S::from(1.0)
            } else if input < -by {
                S::from(-1.0)
            } else {
                held
            }
        };
        let Some(held) = self.held.get(slot).copied().filter(|_| self.begun) else {
            return if how == Operation::Relay { side(S::from(0.0)) } else { input };
        };
        match how {
            Operation::Relay => side(held),
            Operation::Lag if elapsed <= 0.0 => held,
            Operation::Lag => input + (held - input) * (-(S::from(elapsed) / by.max(S::from(SHORTEST)))).exp(),
            _ => held.max(input - by).min(input + by),
        }
    }
}

/// Shortest lag, s: a shorter one is none.
const SHORTEST: f64 = 1e-6;

impl Program {
    /// Of a tree whose names are looked up.
    pub(super) fn of(tree: &Tree) -> Result<Self, String> {
        let (mut steps, mut memories) = (Vec::new(), 0);
        let depth = write(tree, &mut steps, &mut memories);
        if depth > DEPTH {
            return Err(format!("is nested {depth} deep, more than {DEPTH}; split it into two effects"));
        }
        let states = State::ALL.into_iter().filter(|s| tree.uses_state(*s)).collect();
        Ok(Self { steps, states, memories, scaled: is_scaled(tree) })
    }

    /// The states it uses.
    pub(super) fn states(&self) -> &[State] {
        &self.states
    }

    pub(super) fn uses(&self, state: State) -> bool {
        self.states.contains(&state)
    }

    /// True where it is its first parameter times what does not use it.
    pub(super) fn is_scaled(&self) -> bool {
        self.scaled
    }

    /// True where its value depends on what was before.
    pub(super) fn remembers(&self) -> bool {
        self.memories > 0
    }

    /// The value, `elapsed` seconds after its memory was settled.
    pub(super) fn value<S: Scalar>(&self, seen: &Seen<S>, parameters: &[S], memory: &Memory<S>, elapsed: f64) -> S {
        self.evaluate(seen, parameters, |place, input, by| memory.follow(place, input, by, elapsed))
    }

    /// Takes what is seen into its memory, `elapsed` seconds after the last time.
    pub(super) fn settle<S: Scalar>(&self, seen: &Seen<S>, parameters: &[S], memory: &mut Memory<S>, elapsed: f64) {
        let mut held = memory.held.clone();
        self.evaluate(seen, parameters, |place, input, by| {
            let now = memory.follow(place, input, by, elapsed);
            if let Some(slot) = held.get_mut(place.1) {
                *slot = now;
            }
            now
        });
        *memory = Memory { held, begun: true };
    }

    fn evaluate<S: Scalar>(
        &self,
        seen: &Seen<S>,
        parameters: &[S],
        mut recall: impl FnMut((Operation, usize), S, S) -> S,
    ) -> S {
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
                Step::Recall(operation, slot) => {
                    top -= 1;
                    kept[top - 1] = recall((operation, slot), kept[top - 1], kept[top]);
                }
            }
        }
        kept[0]
    }
}

fn is_scaled(tree: &Tree) -> bool {
    match tree {
        Tree::Pair(Operation::Multiply, first, rest) => {
            matches!(&**first, Tree::Parameter(0, _)) && !rest.uses_parameter(0)
        }
        _ => false,
    }
}

/// Writes a tree's steps, deepest first, and says how many values they keep at once.
fn write(tree: &Tree, steps: &mut Vec<Step>, memories: &mut usize) -> usize {
    match tree {
        Tree::Number(n) => steps.push(Step::Number(*n)),
        Tree::Name(_) => steps.push(Step::Number(0.0)),
        Tree::State(state) => steps.push(Step::State(*state)),
        Tree::Parameter(place, _) => steps.push(Step::Parameter(*place)),
        Tree::Call(function, a) => {
            let depth = write(a, steps, memories);
            steps.push(Step::Call(*function));
            return depth;
        }
        Tree::Pair(operation, a, b) => {
            if let (Operation::Power, Tree::Number(n)) = (operation, &**b) {
                let depth = write(a, steps, memories);
                steps.push(Step::Power(*n));
                return depth;
            }
            let (left, right) = (write(a, steps, memories), write(b, steps, memories));
            if operation.remembers() {
                steps.push(Step::Recall(*operation, *memories));
                *memories += 1;
            } else {
                steps.push(Step::Pair(*operation));
            }
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
        // With memory these are steps of their own.
        Operation::Lag | Operation::Play | Operation::Relay => a,
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
