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
    /// State, the spool in each step (in the first alone where it stays) and one.
    inputs: Vec<S>,
}

/// The steps that a matrix spans, on one side of the limits.
#[derive(Debug)]
struct Map<S> {
    regime: Regime,
    /// The state at their end.
    end: Vec<Row<S>>,
    /// Some states half way.
    halfway: Vec<(usize, Row<S>)>,
    /// What the valve is asked to let through at each stage of each step, m/s.
    demands: Vec<Vec<(usize, f64)>>,
}

/// One row of a matrix: what is not zero in it.
#[derive(Debug)]
struct Row<S>(Vec<Term<S>>);

#[derive(Debug)]
struct Term<S> {
    input: usize,
    factor: S,
    /// The factor has no derivatives.
    plain: bool,
}

impl<S: Scalar> Row<S> {
    fn of(factors: impl Iterator<Item = S>) -> Self {
        let term = |(input, factor): (usize, S)| {
            let plain = (1..S::PARTS).all(|i| factor.part(i) == 0.0);
            (!plain || factor.value() != 0.0).then_some(Term { input, factor, plain })
        };
        Self(factors.enumerate().filter_map(term).collect())
    }

    #[inline]
    fn times(&self, inputs: &[S]) -> S {
        let mut sum = S::from(0.0);
        for term in &self.0 {
            let input = inputs[term.input];
            sum = if term.plain {
                sum.plus_scaled(input, term.factor.value())
            } else {
                sum.plus_product(input, term.factor)
            };
        }
        sum
    }
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
        let mut inputs = vec![S::from(0.0); dynamics.used + spools];
        inputs.push(S::from(1.0));
        Some(Self { span, moving, maps, current: 0, limits, inputs })
    }

    /// Steps that a matrix spans.
    pub(super) fn span(&self) -> usize {
        self.span
    }

    /// Makes ready for the way on from this state with the spool at these places; false where that is not linear.
    pub(super) fn holds(&mut self, state: &State<S>, spools: &[S]) -> bool {
        let n = state.y.len();
        let spools = if self.moving { spools } else { &spools[..1] };
        self.inputs[..n].copy_from_slice(&state.y);
        self.inputs[n..n + spools.len()].copy_from_slice(spools);
        let holds = |&i: &usize| self.maps.get(i).is_some_and(|map| map.holds(&self.inputs, self.limits));
        let held = [self.current, 0, 1, 2].into_iter().find(holds);
        self.current = held.unwrap_or(self.current);
        held.is_some()
    }

    /// Takes the steps of `h` seconds that were made ready.
    pub(super) fn advance(&self, state: &mut State<S>, h: f64, halfway: bool) {
        let Some(map) = self.maps.get(self.current) else { return };
        for (y, row) in state.y.iter_mut().zip(&map.end) {
            *y = row.times(&self.inputs);
        }
        for (i, row) in map.halfway.iter().filter(|_| halfway) {
            state.work.moved[*i] = row.times(&self.inputs);
        }
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
            Row::of(columns.iter().map(|column| of(column) - base).chain([base]))
        };
        let demand = |stage: usize| {
            let base = constant.demands[stage];
            let factors = columns.iter().map(|column| column.demands[stage] - base).chain([base]);
            factors.enumerate().filter(|(_, factor)| *factor != 0.0).collect()
        };
        let map = Self {
            regime,
            end: (0..n).map(|i| row(&|column| column.end[i])).collect(),
            halfway: dynamics.behind_velocities().into_iter().map(|i| (i, row(&|column| column.halfway[i]))).collect(),
            demands: (0..4 * span).map(demand).collect(),
        };
        dynamics.forced = None;
        map
    }

    /// Whether the flow stays on this side of its limits at every stage.
    fn holds(&self, inputs: &[S], (low, high): (f64, f64)) -> bool {
        self.demands.iter().all(|row| {
            let demand: f64 = row.iter().map(|&(i, factor)| factor * inputs[i].value()).sum();
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
