//! Steps of a plant that is linear while its flow stays on one side of its limits, taken by matrices.
//!
//! Most effects are linear with coefficients that stay the same through a run: the spool's lag, the oil column, a
//! payload. Over one step of the integration rule, or over those of a whole sample, such a plant maps state and spool to the
//! next state by a matrix, one for each side of the flow's limits. The matrices are read off the rule itself, column by column, derivatives
//! included, so that there is one set of equations. Which matrix holds is known before it is used: what the valve is
//! asked to let through at each stage of the rule is linear too. A step that crosses a limit is left to the rule.

use super::dynamics::{Dynamics, Regime, State};
use crate::scalar::Scalar;

/// The matrices of one plant at one step length.
#[derive(Debug)]
pub(super) struct Linear<S> {
    /// Steps that a matrix spans.
    span: usize,
    /// The spool may move from step to step.
    moving: bool,
    maps: Vec<Map<S>>,
    /// The map that held last.
    current: usize,
    /// What the flow may be, m/s.
    limits: (f64, f64),
    /// Values of the state, of the spool in each step (in the first alone where it stays) and one.
    values: Vec<f64>,
    /// Where the next state is put together.
    next: Vec<S>,
}

/// The steps that a matrix spans, on one side of the limits.
#[derive(Debug)]
struct Map<S> {
    regime: Regime,
    /// The state at their end.
    end: Vec<Row<S>>,
    /// Some states half way.
    halfway: Vec<(usize, Row<S>)>,
    /// What the valve is asked to let through at each stage of each step, m/s: factors of the values, and where each
    /// stage's end.
    demands: Vec<(usize, f64)>,
    ends: Vec<usize>,
}

/// One row of a matrix: what is not zero in it.
#[derive(Debug)]
struct Row<S> {
    states: Vec<Term<S>>,
    spools: Vec<Term<S>>,
    constant: Option<S>,
}

#[derive(Debug)]
struct Term<S> {
    input: usize,
    factor: S,
    /// The factor has no derivatives.
    plain: bool,
}

impl<S: Scalar> Row<S> {
    /// From the factors of `states` states, of the spools and of one.
    fn of(mut factors: Vec<S>, states: usize) -> Self {
        let constant = factors.pop().filter(|factor| !is_plain(factor) || factor.value() != 0.0);
        let spools = factors.split_off(states);
        Self { states: terms(&factors), spools: terms(&spools), constant }
    }

    #[inline]
    fn times(&self, states: &[S], spools: &[S]) -> S {
        let sum = summed(summed(S::from(0.0), &self.states, states), &self.spools, spools);
        self.constant.map_or(sum, |constant| sum + constant)
    }
}

/// True where a factor has no derivatives.
fn is_plain<S: Scalar>(factor: &S) -> bool {
    (1..S::PARTS).all(|i| factor.part(i) == 0.0)
}

/// Those of a row's factors that are not zero.
fn terms<S: Scalar>(factors: &[S]) -> Vec<Term<S>> {
    let term = |(input, &factor): (usize, &S)| {
        let plain = is_plain(&factor);
        (!plain || factor.value() != 0.0).then_some(Term { input, factor, plain })
    };
    factors.iter().enumerate().filter_map(term).collect()
}

/// `sum` and the terms' factors times their inputs.
#[inline(always)]
fn summed<S: Scalar>(mut sum: S, terms: &[Term<S>], inputs: &[S]) -> S {
    for term in terms {
        let input = inputs[term.input];
        sum =
            if term.plain { sum.plus_scaled(input, term.factor.value()) } else { sum.plus_product(input, term.factor) };
    }
    sum
}

impl<S: Scalar> Linear<S> {
    /// The matrices for `span` steps of `h` seconds; none where the plant is not linear between the limits of its flow.
    pub(super) fn of(dynamics: &mut Dynamics<S>, rest: &State<S>, h: f64, span: usize) -> Option<Self> {
        if !dynamics.is_linear() {
            return None;
        }
        let (limits, moving) = (dynamics.limits(rest), dynamics.any.command);
        let regimes: &[Regime] =
            if limits.1.is_finite() { &[Regime::Free, Regime::Positive, Regime::Negative] } else { &[Regime::Free] };
        let spools = if moving { span } else { 1 };
        let maps = regimes.iter().map(|&regime| Map::of(dynamics, rest, h, (span, spools), regime)).collect();
        let (mut values, next) = (vec![0.0; dynamics.used + spools], rest.y.clone());
        values.push(1.0);
        Some(Self { span, moving, maps, current: 0, limits, values, next })
    }

    /// Steps that a matrix spans.
    pub(super) fn span(&self) -> usize {
        self.span
    }

    /// The spool's places of which the matrices know.
    fn known<'a>(&self, spools: &'a [S]) -> &'a [S] {
        if self.moving { spools } else { &spools[..1] }
    }

    /// Whether the way on from this state with the spool at these places is linear; makes ready for it.
    pub(super) fn holds(&mut self, state: &State<S>, spools: &[S]) -> bool {
        let inputs = state.y.iter().chain(self.known(spools));
        for (value, input) in self.values.iter_mut().zip(inputs) {
            *value = input.value();
        }
        let holds = |&i: &usize| self.maps.get(i).is_some_and(|map| map.holds(&self.values, self.limits));
        let held = [self.current, 0, 1, 2].into_iter().find(holds);
        self.current = held.unwrap_or(self.current);
        held.is_some()
    }

    /// Takes the steps of `h` seconds that were made ready.
    pub(super) fn advance(&mut self, state: &mut State<S>, spools: &[S], h: f64, halfway: bool) {
        let spools = self.known(spools);
        let Some(map) = self.maps.get(self.current) else { return };
        for (i, row) in map.halfway.iter().filter(|_| halfway) {
            state.work.moved[*i] = row.times(&state.y, spools);
        }
        for (next, row) in self.next.iter_mut().zip(&map.end) {
            *next = row.times(&state.y, spools);
        }
        std::mem::swap(&mut state.y, &mut self.next);
        state.time += h * self.span as f64;
    }
}

/// What the rule makes of one input.
struct Column<S> {
    end: Vec<S>,
    halfway: Vec<S>,
    demands: Vec<f64>,
}

impl<S: Scalar> Map<S> {
    /// Read off the integration rule with the flow held on one side of its limits.
    fn of(dynamics: &mut Dynamics<S>, rest: &State<S>, h: f64, (span, spools): (usize, usize), regime: Regime) -> Self {
        let n = dynamics.used;
        dynamics.forced = Some(regime);
        let constant = column(dynamics, rest, h, span, &mut |_, _| {});
        let mut columns = Vec::new();
        for input in 0..n + spools {
            columns.push(column(dynamics, rest, h, span, &mut |state, step| {
                if step == 0 && input < n {
                    state.y[input] = S::from(1.0);
                }
                if input >= n {
                    let here = spools == 1 || input - n == step;
                    state.spool = S::from(if here { 1.0 } else { 0.0 });
                }
            }));
        }
        let row = |of: &dyn Fn(&Column<S>) -> S| {
            let base = of(&constant);
            Row::of(columns.iter().map(|column| of(column) - base).chain([base]).collect(), n)
        };
        let (mut demands, mut ends) = (Vec::new(), Vec::new());
        for (stage, &base) in constant.demands.iter().enumerate() {
            let factors = columns.iter().map(|column| column.demands[stage] - base).chain([base]);
            demands.extend(factors.enumerate().filter(|(_, factor)| *factor != 0.0));
            ends.push(demands.len());
        }
        let map = Self {
            regime,
            end: (0..n).map(|i| row(&|column| column.end[i])).collect(),
            halfway: dynamics.behind_velocities().into_iter().map(|i| (i, row(&|column| column.halfway[i]))).collect(),
            demands,
            ends,
        };
        dynamics.forced = None;
        map
    }

    /// Whether the flow stays on this side of its limits at every stage.
    fn holds(&self, values: &[f64], (low, high): (f64, f64)) -> bool {
        let mut from = 0;
        self.ends.iter().all(|&end| {
            let demand: f64 = self.demands[from..end].iter().map(|&(i, factor)| factor * values[i]).sum();
            from = end;
            match self.regime {
                Regime::Free => low <= demand && demand <= high,
                Regime::Positive => demand > high,
                Regime::Negative => demand < low,
            }
        })
    }
}

/// `span` steps from nothing, `set` having been at the state before each.
fn column<S: Scalar>(
    dynamics: &Dynamics<S>,
    rest: &State<S>,
    h: f64,
    span: usize,
    set: &mut dyn FnMut(&mut State<S>, usize),
) -> Column<S> {
    let mut state = rest.clone();
    state.y.fill(S::from(0.0));
    state.spool = S::from(0.0);
    let (mut halfway, mut demands) = (state.y.clone(), Vec::new());
    for step in 0..span {
        set(&mut state, step);
        dynamics.integrate(&mut state, h, 2 * step + 1 == span);
        demands.extend(state.work.demands);
        if 2 * step + 1 == span {
            halfway.clone_from(&state.work.moved);
        } else if 2 * (step + 1) == span {
            halfway.clone_from(&state.y);
        }
    }
    Column { end: state.y, halfway, demands }
}
