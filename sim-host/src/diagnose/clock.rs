//! The rate of the clock that stamped the rows: a hypothesis beside the physics, and a correction where it wins.
//!
//! A clock that is off by a share r makes everything by the stamps fast or slow by r, which a friction, a lag or an
//! accelerometer's gain each explains in part. So it is grown, weighed and swapped as effects are; where it is among what was
//! accepted, the sampling period is corrected and everything begins anew, as though it had been stated so.

use super::calibration::CALIBRATION;
use crate::identify::fit::Fit;
use crate::identify::model::Model;
use crate::identify::prepare::Prepared;
use crate::identify::quantity::quantities;
use crate::plant::effects::clock_rate::ENTRY;
use crate::recording::{Experiment, GainFactors, SetUpFinding};

/// Share of itself by which a rate may be off from what a controller's law says: a gain is found only where it is known to a fifth of what
/// it is away from the stated one.
const SAME: f64 = 0.2;
/// Rate to which what a law says of the clock is known at best.
const KNOWN: f64 = 1e-4;

/// Lets a search doubt the clock.
pub(super) fn doubt(prepared: &mut Prepared, told: Option<f64>) {
    prepared.model.library.push(&ENTRY);
    prepared.model.clock_told = told;
}

/// What the laws say of the clock, as they were stated and as they were found from what they made of the recorded command: one whose gain
/// over a time is not as stated, and whose other gain is, ran by another clock or was stated wrong. True over stated period, less one.
pub(super) fn told(stated: &Experiment, found: &Experiment) -> Option<f64> {
    let runs = stated.runs.iter().zip(&found.runs);
    let rates = runs.filter_map(|(stated, found)| stated.law.factors_of(&found.law)).map(GainFactors::clock_rate);
    let rates = rates.collect::<Option<Vec<f64>>>()?;
    let first = *rates.first()?;
    rates.iter().all(|rate| (rate - first).abs() < SAME * first.abs()).then_some(first)
}

/// What speaks against a clock at another rate, as twice a logarithm; nothing of a model without one. Where a law says the same of it the
/// other account needs a gain that was stated wrong as well, which is as rare, and by just as much.
pub(super) fn disbelief(stated: &Model, fitted: &Model) -> f64 {
    let placed = fitted.effects.iter().find(|p| p.entry.id == ENTRY.id);
    let rate = placed.and_then(|p| p.values.first()).map(|v| v.value);
    let odds = |rate: f64| match stated.clock_told.filter(|_| as_told(stated, rate)) {
        Some(told) => -2.0 * (CALIBRATION.misstated_gain / ((rate - told).abs() + KNOWN)).ln(),
        None => CALIBRATION.clock_odds,
    };
    rate.map_or(0.0, |rate| odds(rate) + (rate / CALIBRATION.clock_rate).powi(2))
}

/// Whether a law says the same of the clock.
fn as_told(stated: &Model, rate: f64) -> bool {
    stated.clock_told.is_some_and(|told| (rate - told).abs() < SAME * told.abs())
}

/// The finding where a clock of another rate is part of what was accepted. Where a law says the same of it, it says it more closely: what
/// is still missing of the table bends the fit's.
pub(super) fn found(accepted: &Fit, dt: f64) -> Option<SetUpFinding> {
    let placed = accepted.model.effects.iter().find(|p| p.entry.id == ENTRY.id)?;
    let fitted = placed.values.first()?.value;
    let rate = accepted.model.clock_told.filter(|_| as_told(&accepted.model, fitted)).unwrap_or(fitted);
    let std = quantities(accepted).get("clock_rate.rate").and_then(|q| q.std);
    Some(SetUpFinding::clock_rate(dt, dt * (1.0 + rate), std.map(|std| std * dt)))
}

/// The experiment by the clock that was found: what its controllers made of their commands is read anew by it.
pub(super) fn corrected(experiment: &Experiment, finding: &SetUpFinding) -> Experiment {
    let mut experiment = experiment.clone();
    let factor = finding.stated.map_or(1.0, |stated| finding.found / stated);
    experiment.runs.iter_mut().for_each(|run| run.by_clock(factor));
    experiment
}

/// Doubts the clock no more.
pub(super) fn settle(prepared: &mut Prepared) {
    prepared.model.library.retain(|entry| entry.id != ENTRY.id);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::fit::tests::{TRUTH, model};
    use crate::identify::model::{ModelEffect, SignalScales};
    use crate::recording::doubt::tests::experiment;
    use crate::recording::{self, RecordedLaw as Law};

    fn pi(kp: f64, ki: f64) -> Law {
        Law::ProportionalIntegral { kp, ki }
    }

    /// The experiment that every run states this law of.
    fn of(law: Law) -> Experiment {
        let mut all = experiment(&pi(4.0, 1.0), recording::Shaping::default(), 3);
        all.runs.iter_mut().for_each(|run| run.law = law.clone());
        all
    }

    /// A gain over a time tells the clock where the other gain is as stated, whichever law it is; a plain gain that is wrong as well, or a
    /// law that was found as stated, tells nothing.
    #[test]
    fn a_gain_over_a_time_tells_the_clock() {
        let rate = told(&of(pi(4.0, 1.0)), &of(pi(4.0, 1.003))).unwrap();
        assert!((rate - 3e-3).abs() < 1e-12, "{rate}");
        let cascade = |kp, kv| of(Law::Cascade { kp, kv });
        let rate = told(&cascade(40.0, 160.0), &cascade(40.0 * 1.003, 160.0 / 1.003)).unwrap();
        assert!((rate - 3e-3).abs() < 1e-12, "{rate}");
        assert_eq!(told(&of(pi(4.0, 1.0)), &of(pi(4.1, 1.003))), None);
        assert_eq!(told(&of(pi(4.0, 1.0)), &of(pi(4.0, 1.0))), None);
        assert_eq!(told(&of(Law::Open), &of(Law::Open)), None);
        let mut slow = of(pi(4.0, 1.0));
        slow.runs.iter_mut().for_each(|run| run.dt /= 1.003);
        let rate = told(&slow, &recording::doubt(&slow).experiment).unwrap();
        assert!((rate - 3e-3).abs() < 1e-4, "{rate}");
    }

    /// What a law says of the clock speaks for that rate and for no other.
    #[test]
    fn a_rate_that_a_law_tells_is_believed() {
        let mut off = ModelEffect::start(&ENTRY, 0, &SignalScales::TYPICAL).unwrap();
        off.values[0].value = 3.1e-3;
        let mut stated = model(TRUTH);
        let against = |stated: &Model| disbelief(stated, &stated.with(off.clone()));
        let alone = against(&stated);
        stated.clock_told = Some(3e-3);
        assert!(against(&stated) < alone - CALIBRATION.clock_odds, "{alone}");
        stated.clock_told = Some(-3e-3);
        assert!((against(&stated) - alone).abs() < 1e-12);
    }

    /// By a clock that is slow the runs take longer, and a controller that ran faster than the recording still makes whole ticks.
    #[test]
    fn an_experiment_is_read_by_the_clock_that_was_found() {
        let mut stated = of(pi(4.0, 1.0));
        let dt = stated.runs[0].dt;
        stated.runs[0].controller_rate_hz = Some(4.0 / dt);
        let read = corrected(&stated, &SetUpFinding::clock_rate(dt, 1.003 * dt, None));
        let run = &read.runs[0];
        assert!((run.dt / dt - 1.003).abs() < 1e-12);
        assert!((run.controller_rate_hz.unwrap() * run.dt - 4.0).abs() < 1e-9);
    }
}
