//! Tests with nothing wrong, which must not trip: a guard that trips a healthy table is switched off by its users.
//!
//! A run is a number under a seed, as in the campaign: a table, a mode with its law, and a record or a sine. Sines go up to nine
//! tenths of what the envelope allows and the table can: 27 m/s2, 0.22 m/s, 80 mm. An existing controller in front of a guard
//! feeds the velocity forward there, so that the table does reach them; where that meets an oil column's resonance, the sine is
//! as much smaller as the table makes it larger, for a table that leaves its envelope is not healthy. What still does, under a law
//! whose model is not quite the table's, is counted by itself.

use super::case::{Beside, Case, LENGTH, REST};
use super::class::CLASSES;
use super::dice::FaultRng;
use super::machine::{Oil, Table};
use super::motions::Motions;
use super::rig::{self, RigError};
use super::watcher::ROUGH;
use nalgebra::Complex;
use rayon::prelude::*;
use serde::Serialize;
use shakedown_core::{Mode, Modification, OperatorRequest, State};
use std::f64::consts::TAU;

/// Most that a sine asks for: displacement, m; velocity, m/s; acceleration, m/s2.
const MOST: [f64; 3] = [0.08, 0.22, 27.0];
/// From arming to the beginning of a sine, and from there to its full amplitude, s.
const SINE: [f64; 2] = [0.7, 1.5];

/// What a healthy run came to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Healthy {
    /// Its number.
    pub run: u64,
    /// Where the device sat, or which law ran.
    pub mode: &'static str,
    /// Control rate, 1/s.
    pub rate: f64,
    /// How the reference is modified.
    pub modification: Modification,
    /// Whether it goes through a board's converters.
    pub converters: bool,
    /// The table.
    pub table: Table,
    /// Frequency of its sine, Hz; none where it was a record.
    pub sine_hz: Option<f64>,
    /// Largest acceleration of the table, mean over 3 ms, m/s2.
    pub acceleration: f64,
    /// Farthest from the middle, m.
    pub farthest_m: f64,
    /// Why it tripped, or `not armed`.
    pub tripped: Option<String>,
    /// Whether the table left the envelope by itself, beyond [`ROUGH`] before any trip: a test that is not healthy, and a guard that
    /// trips is right.
    pub beyond: bool,
}

/// The healthy run `number` of `seed`: as the campaign deals its runs without a fault, and half of them sines instead of records.
pub fn deal(seed: u64, number: u64, motions: &Motions) -> (Case, Option<f64>) {
    let mut dice = FaultRng::new(seed, number);
    let sine = dice.chance(0.5).then(|| (dice.scale(0.1, 30.0), dice.uniform(0.3, 1.0)));
    let case = Case::deal_with(dice, number, Some(&CLASSES[0]), motions).beside(Beside::Nothing);
    let case = Case { onset: case.ticks(), ..case };
    match sine {
        None => (case, None),
        Some((frequency, share)) => (sine_instead(case, frequency, share), Some(frequency)),
    }
}

/// `case` with a sine of `frequency` (Hz) that carries the table to a `share` of what is allowed, instead of its record.
fn sine_instead(mut case: Case, frequency: f64, share: f64) -> Case {
    // A sine reaches its amplitude while the test runs.
    case.orders =
        [OperatorRequest::Arm, OperatorRequest::Start].map(|order| ((REST * case.rate()) as usize, order)).to_vec();
    let guards = case.settings.mode == Mode::Guard;
    if guards {
        // The existing controller knows its table's gain as well as ours does.
        case.feed_forward = 1.0 / f64::from(case.settings.valve.gain);
    }
    let enlarged = if guards { enlarged(&case.table, (case.existing, case.feed_forward), frequency) } else { 1.0 };
    case.reference = steady(frequency, share / enlarged.max(1.0), case.rate());
    case
}

/// How much larger than asked for a sine of `frequency` (Hz) comes out of `table` under a proportional loop (1) with a forward
/// path of the velocity (s), 1.
fn enlarged(table: &Table, (proportional, forward): (f64, f64), frequency: f64) -> f64 {
    let s = Complex::new(0.0, TAU * frequency);
    let flow = (s * table.b1 + table.b0) / (s + table.a1);
    let column = table.oil.map_or(Complex::new(1.0, 0.0), |Oil { omega, damping }| {
        let damped = s * 2.0 * damping * omega + omega * omega;
        damped / (s * s + damped)
    });
    let moved = flow * column / s;
    (moved * (s * forward + proportional) / (moved * proportional + 1.0)).norm()
}

/// A sine that grows to a `share` of what is allowed at its `frequency` (Hz), m.
fn steady(frequency: f64, share: f64, rate: f64) -> Vec<f64> {
    let w = TAU * frequency;
    let amplitude = share * MOST[0].min(MOST[1] / w).min(MOST[2] / (w * w));
    let tick = |k: usize| {
        let t = k as f64 / rate - REST - SINE[0];
        let grown = (t / SINE[1]).clamp(0.0, 1.0);
        amplitude * grown * grown * (3.0 - 2.0 * grown) * (w * t.max(0.0)).sin()
    };
    (0..(LENGTH * rate) as usize).map(tick).collect()
}

/// Runs and judges one.
pub fn judge(seed: u64, number: u64, motions: &Motions) -> Result<Healthy, RigError> {
    let (case, sine_hz) = deal(seed, number, motions);
    judge_case(&case, sine_hz)
}

fn judge_case(case: &Case, sine_hz: Option<f64>) -> Result<Healthy, RigError> {
    let seen = rig::run(case)?.seen;
    let ran = seen.iter().any(|tick| tick.state == State::Running);
    let tripped = seen.iter().position(|tick| tick.trip.is_some());
    let trip = tripped.and_then(|at| seen[at].trip).map(|trip| format!("{trip:?}"));
    let ticks = (3e-3 * case.rate()).max(1.0) as usize;
    let over = |k: usize| (seen[k + ticks].v - seen[k].v).abs() * case.rate() / ticks as f64;
    let acceleration = |end: usize| (0..end.saturating_sub(ticks)).map(over).fold(0.0, f64::max);
    Ok(Healthy {
        run: case.number,
        mode: case.mode(),
        rate: case.rate(),
        modification: case.settings.modification,
        converters: case.converters,
        table: case.table,
        sine_hz,
        acceleration: acceleration(seen.len()),
        farthest_m: seen.iter().fold(0.0, |most, tick| most.max(tick.x.abs())),
        tripped: trip.or_else(|| (!ran).then(|| "not armed".into())),
        // What the stop itself does to the table is no reason for it.
        beyond: acceleration(tripped.unwrap_or(seen.len())) > ROUGH,
    })
}

/// So many runs of `seed`.
pub fn run(seed: u64, runs: u64, motions: &Motions, done: &(impl Fn(u64) + Sync)) -> Result<Vec<Healthy>, RigError> {
    let one = |number| {
        let healthy = judge(seed, number, motions);
        done(1);
        healthy
    };
    (0..runs).into_par_iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The existing controller in front of the guard feeds 25 Hz forward into an oil column that resonates there: asked for 27 m/s2
    /// the table does 40 and more, which is beyond the envelope, and the guard is right to trip.
    #[test]
    fn a_sine_that_meets_an_oil_columns_resonance_stays_within_the_envelope() {
        let motions = Motions::new(None).unwrap();
        let plain = |case: &Case| case.settings.mode == Mode::Guard && case.rate() == 1000.0 && !case.converters;
        let dealt = (0..100).map(|number| deal(1, number, &motions).0).find(plain).unwrap();
        let frequency = 25.3;
        let oil = Some(Oil { omega: TAU * frequency, damping: 0.13 });
        let table = Table { b1: 0.69, b0: 138.0, a1: 57.65, limit: 0.242, null: 0.0, oil };
        let case = sine_instead(Case { table, existing: 3.0, ..dealt }, frequency, 1.0);
        let forward = (case.existing, case.feed_forward);
        assert!(enlarged(&table, forward, frequency) > 1.3 && enlarged(&table, forward, 1.0) < 1.2);
        let found = judge_case(&case, Some(frequency)).unwrap();
        assert!(found.tripped.is_none() && found.acceleration < 30.0, "{found:?}");
        let unheeded = Case { reference: steady(frequency, 1.0, case.rate()), ..case };
        let found = judge_case(&unheeded, Some(frequency)).unwrap();
        assert!(found.tripped.is_some() && found.acceleration > 35.0, "{found:?}");
    }
}
