//! The best that another effect can do with a case's recordings: its strength, the shape of its form, the free parameters of
//! the stated model and the displacement sensor's offset are fitted by damped least squares.

use super::likelihood::Recordings;
use crate::effect::Draw;
use crate::lab::forms::{Dial, Form};
use crate::lab::plant::Plant;
use crate::lab::scene::Scene;
use crate::plant::Machine;
use crate::refit::{dot, least_squares, less, squares};

/// Most steps of a fit.
const STEPS: usize = 10;
/// A fit of which a step promises or brings no better than this share of what is left goes no further.
const HOPE: f64 = 0.98;
/// Times what is enough that a first step may promise if it promises no half of what is left.
const FAR: f64 = 1000.0;
/// How far a logarithm goes in one step.
const REACH: f64 = 0.7;
/// Strength that a fit begins at: weak enough to act linearly, and no law stiff.
const FIRST: f64 = 0.03;

/// A form of an effect on a machine, as far as fitted.
#[derive(Clone, Copy)]
struct Guess {
    dial: Dial,
    machine: Machine,
}

/// A fit of one form to a case's recordings.
struct Fit<'a> {
    scene: &'a Scene,
    recordings: &'a Recordings<'a>,
    form: Option<&'a Form>,
    offset: Option<Vec<f64>>,
    /// Coordinates that what is left answers to.
    moving: Vec<usize>,
}

/// What a fit has come to.
struct Reached {
    guess: Guess,
    /// What is left (standard deviations), and its sum of squares.
    away: Vec<f64>,
    cost: f64,
}

/// Least sum of squares (1) that a form leaves of the recordings, sought no further than `enough`; none where it has no start.
///
/// The first run goes first: what cannot follow one run cannot follow all.
pub fn left_by(scene: &Scene, recordings: &Recordings, form: &Form, enough: f64) -> Option<f64> {
    let first = recordings.first();
    let mut fit = Fit::of(scene, &first, Some(form));
    let start = fit.begin()?;
    let one = fit.descend(start, 0.5 * enough);
    if one.cost > enough {
        return Some(one.cost);
    }
    let mut fit = Fit { recordings, offset: recordings.offset(), ..fit };
    let start = fit.reached(one.guess)?;
    Some(fit.descend(start, enough).cost)
}

/// Least sum of squares (1) that the stated model leaves with nothing added to it; none where it runs away.
pub fn left_by_none(scene: &Scene, recordings: &Recordings) -> Option<f64> {
    let mut fit = Fit::of(scene, recordings, None);
    let start = fit.reached(fit.at(1.0, FIRST))?;
    Some(fit.descend(start, 0.0).cost)
}

impl<'a> Fit<'a> {
    fn of(scene: &'a Scene, recordings: &'a Recordings<'a>, form: Option<&'a Form>) -> Self {
        let own = if form.is_some() { 0 } else { 1 + SHAPES };
        let moving = (own..1 + SHAPES + scene.fit.len()).collect();
        Self { scene, recordings, form, offset: recordings.offset(), moving }
    }

    /// From a start downhill, no further than `enough`.
    fn descend(&mut self, start: Reached, enough: f64) -> Reached {
        let mut at = start;
        for _ in 0..STEPS {
            if at.cost < enough {
                break;
            }
            let columns = self.tangents(&at);
            let Some(step) = least_squares(&columns, &at.away) else { break };
            let promised = squares(&less(&at.away, &columns, &step));
            // A rival that is far from enough is given up early; what nothing leaves must be the least.
            let far = self.form.is_some() && promised > (0.5 * at.cost).max(FAR * enough);
            if far || promised > HOPE * at.cost {
                break;
            }
            let Some(next) = self.moved(&at, &step) else { break };
            let slow = next.cost > HOPE * at.cost;
            at = next;
            if slow {
                break;
            }
        }
        at
    }

    fn plant(&self, guess: &Guess) -> Plant {
        let mut plant = Plant::baseline(guess.machine);
        if let Some(form) = self.form {
            (form.build)(&mut plant, &guess.dial);
        }
        plant
    }

    /// What a guess leaves once the offset has done what it can.
    fn reached(&self, guess: Guess) -> Option<Reached> {
        let away = self.without_offset(self.recordings.less(&self.plant(&guess))?);
        Some(Reached { guess, cost: squares(&away), away })
    }

    fn without_offset(&self, away: Vec<f64>) -> Vec<f64> {
        let Some(offset) = &self.offset else { return away };
        let share = dot(&away, offset) / squares(offset);
        less(&away, std::slice::from_ref(offset), &[share])
    }

    /// A middling shape, the sign that leaves less, and the strength at which it answers best, as if it acted linearly.
    fn begin(&self) -> Option<Reached> {
        let baseline = Plant::baseline(self.scene.truth);
        let bare = self.without_offset(self.recordings.less(&baseline)?);
        let likely = |there: &Reached| {
            let own: Vec<f64> = bare.iter().zip(&there.away).map(|(a, b)| a - b).collect();
            dot(&bare, &own) / squares(&own).max(1e-12)
        };
        let signs = [1.0, -1.0].into_iter().filter_map(|sign| self.reached(self.at(sign, FIRST)));
        let mut best = signs.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        for _ in 0..2 {
            let s = (best.guess.dial.s * likely(&best).clamp(0.05, 10.0)).clamp(1e-4, 1.0);
            match self.reached(self.at(best.guess.dial.draw.sign, s)) {
                Some(there) if there.cost < best.cost => best = there,
                _ => break,
            }
        }
        Some(best)
    }

    /// A middling shape on the machine as it is.
    fn at(&self, sign: f64, s: f64) -> Guess {
        let draw = Draw { sign, u: [0.5; 4] };
        Guess { dial: Dial { s, draw, scales: self.scene.scales }, machine: self.scene.truth }
    }

    /// How what is left answers each coordinate that it answers at all: strength and free parameters by their logarithms,
    /// shapes as they are.
    fn tangents(&mut self, at: &Reached) -> Vec<Vec<f64>> {
        let mut columns = Vec::new();
        let mut moving = Vec::new();
        for &i in &self.moving {
            let by = if i == 0 {
                -1e-2
            } else if i <= SHAPES {
                inwards(at.guess.dial.draw.u[i - 1])
            } else {
                1e-4
            };
            let Some(there) = self.reached(self.along(&at.guess, i, by)) else { continue };
            let column: Vec<f64> = at.away.iter().zip(&there.away).map(|(a, b)| (a - b) / by).collect();
            if squares(&column) > 1e-12 {
                columns.push(column);
                moving.push(i);
            }
        }
        self.moving = moving;
        columns
    }

    fn along(&self, guess: &Guess, i: usize, by: f64) -> Guess {
        let mut moved = *guess;
        match i {
            0 => moved.dial.s = (moved.dial.s * by.clamp(-REACH, REACH).exp()).clamp(1e-5, 1.0),
            i if i <= SHAPES => {
                let u = &mut moved.dial.draw.u[i - 1];
                *u = (*u + by).clamp(0.0, 1.0 - 1e-9);
            }
            i => {
                if let Some(value) = self.scene.fit.get(i - 1 - SHAPES).and_then(|p| p.of(&mut moved.machine)) {
                    *value *= by.clamp(-REACH, REACH).exp();
                }
            }
        }
        moved
    }

    /// A share of the step further, where it leaves less.
    fn moved(&self, at: &Reached, step: &[f64]) -> Option<Reached> {
        [1.0, 0.3, 0.08].into_iter().find_map(|share| {
            let way = self.moving.iter().zip(step);
            let there = way.fold(at.guess, |guess, (i, by)| self.along(&guess, *i, share * by));
            self.reached(there).filter(|next| next.cost < at.cost)
        })
    }
}

/// Numbers that shape a form.
const SHAPES: usize = 4;

/// A step of a shape that stays within its range.
fn inwards(u: f64) -> f64 {
    if u > 0.5 { -0.02 } else { 0.02 }
}
