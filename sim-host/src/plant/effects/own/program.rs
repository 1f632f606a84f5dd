//! An expression made ready to be evaluated on any scalar: its steps in the order in which they are taken.

use super::expression::{Function, Operation, Tree};
use super::memory::Memory;
use super::state::State;
use crate::scalar::Scalar;

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

/// Values kept at once, at most.
const DEPTH: usize = 12;
/// Values kept at once by most expressions: room for more would be cleared at every step, for nothing.
const SHALLOW: usize = 3;

/// The steps.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Program {
    steps: Vec<Step>,
    states: Vec<State>,
    /// Values it keeps at once.
    depth: usize,
    /// Memories that its lags and plays need.
    memories: usize,
    /// It is its first parameter times what does not use it.
    scaled: bool,
}

impl Program {
    /// Of a tree whose names are looked up.
    pub(super) fn of(tree: &Tree) -> Result<Self, String> {
        let (mut steps, mut memories) = (Vec::new(), 0);
        let depth = write(tree, &mut steps, &mut memories);
        if depth > DEPTH {
            return Err(format!("is nested {depth} deep, more than {DEPTH}; split it into two effects"));
        }
        let states = State::ALL.into_iter().filter(|s| tree.uses_state(*s)).collect();
        Ok(Self { steps, states, depth, memories, scaled: is_scaled(tree) })
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

    /// Memories that its lags, plays and relays need.
    pub(super) fn memories(&self) -> usize {
        self.memories
    }

    /// True where its value depends on what was before.
    pub(super) fn remembers(&self) -> bool {
        self.memories > 0
    }

    /// The value of what is seen of each state it uses, `elapsed` seconds after its memory was settled.
    pub(super) fn value<S: Scalar>(
        &self,
        seen: impl Fn(State) -> S,
        parameters: &[S],
        memory: &Memory<S>,
        elapsed: f64,
    ) -> S {
        self.evaluate(seen, parameters, |place, input, by| memory.follow(place, input, by, elapsed))
    }

    /// Takes what is seen into its memory, `elapsed` seconds after the last time.
    pub(super) fn settle<S: Scalar>(
        &self,
        seen: impl Fn(State) -> S,
        parameters: &[S],
        memory: &mut Memory<S>,
        elapsed: f64,
    ) {
        let mut next = memory.settled();
        self.evaluate(seen, parameters, |place, input, by| {
            let now = memory.follow(place, input, by, elapsed);
            next.hold(place.1, now);
            now
        });
        *memory = next;
    }

    fn evaluate<S: Scalar>(
        &self,
        seen: impl Fn(State) -> S,
        parameters: &[S],
        recall: impl FnMut((Operation, usize), S, S) -> S,
    ) -> S {
        if self.depth <= SHALLOW {
            self.evaluate_in::<S, SHALLOW>(seen, parameters, recall)
        } else {
            self.evaluate_in::<S, DEPTH>(seen, parameters, recall)
        }
    }

    /// The same, with room for so many values at once.
    fn evaluate_in<S: Scalar, const ROOM: usize>(
        &self,
        seen: impl Fn(State) -> S,
        parameters: &[S],
        mut recall: impl FnMut((Operation, usize), S, S) -> S,
    ) -> S {
        let mut kept = [S::from(0.0); ROOM];
        let mut top = 0;
        for step in &self.steps {
            match *step {
                Step::Number(_) | Step::State(_) | Step::Parameter(_) => {
                    kept[top.min(ROOM - 1)] = match *step {
                        Step::State(state) => seen(state),
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
