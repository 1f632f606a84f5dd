//! The rate of the clock that stamped the rows: a hypothesis beside the physics, and a correction where it wins.
//!
//! A clock that is off by a share r makes everything by the stamps fast or slow by r, which a friction, a lag or an
//! accelerometer's gain each explains in part. So it is grown, weighed and swapped as effects are; where it is among what was
//! accepted, the sampling period is corrected and the search goes on as though it had been stated so.

use super::calibration::CALIBRATION;
use crate::identify::fit::Fit;
use crate::identify::model::Model;
use crate::identify::prepare::Prepared;
use crate::identify::quantity::quantities;
use crate::plant::effects::clock_rate::ENTRY;
use crate::recording::SetUpFinding;

/// Lets a search doubt the clock.
pub(super) fn doubt(prepared: &mut Prepared) {
    prepared.model.library.push(&ENTRY);
}

/// What speaks against a clock at another rate, as twice a logarithm; nothing of a model without one.
pub(super) fn disbelief(fitted: &Model) -> f64 {
    let placed = fitted.effects.iter().find(|p| p.entry.id == ENTRY.id);
    let rate = placed.and_then(|p| p.values.first()).map(|v| v.value);
    rate.map_or(0.0, |rate| CALIBRATION.clock_odds + (rate / CALIBRATION.clock_rate).powi(2))
}

/// The finding where a clock of another rate is part of what was accepted.
pub(super) fn found(accepted: &Fit, dt: f64) -> Option<SetUpFinding> {
    let placed = accepted.model.effects.iter().find(|p| p.entry.id == ENTRY.id)?;
    let rate = placed.values.first()?.value;
    let std = quantities(accepted).get("clock_rate.rate").and_then(|q| q.std);
    Some(SetUpFinding::clock_rate(dt, dt * (1.0 + rate), std.map(|std| std * dt)))
}

/// Doubts the clock no more, and corrects the sampling period by what was found.
pub(super) fn settle(prepared: &mut Prepared, finding: Option<&SetUpFinding>) {
    let factor = finding.and_then(|f| Some(f.found / f.stated?)).unwrap_or(1.0);
    prepared.model.library.retain(|entry| entry.id != ENTRY.id);
    for run in prepared.fit.iter_mut().chain(&mut prepared.holdout) {
        run.dt *= factor;
    }
}
