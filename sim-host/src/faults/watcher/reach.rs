//! What a run's faults leave to a command: how far the table may come, and whether its stop can be a soft one.

use super::measures::Outrun;
use super::{MARGIN, STROKE};
use crate::faults::case::{Case, MODEL_GAIN};
use crate::faults::class::{Fault, LEARNED, NEAR_MODEL, OUTRUN, Promise, ROOM};
use crate::faults::machine::PlantFault;

/// How far the table may come from the middle, m. A valve that does not obey is stopped by the block alone: the stroke itself is
/// all that is promised of it.
pub(super) fn farthest(case: &Case) -> f64 {
    if disobeys(case) { STROKE } else { STROKE - MARGIN }
}

/// Whether the valve moves, and not by the command.
fn disobeys(case: &Case) -> bool {
    let disobeys = |fault: Fault| match fault {
        Fault::Table(how) | Fault::Behind(how) => match how {
            PlantFault::Stuck(at) => at != 0.0,
            PlantFault::Frozen | PlantFault::Bit(..) => true,
            PlantFault::Supply(_) | PlantFault::Payload { .. } => false,
        },
        _ => false,
    };
    disobeys(case.fault) || case.second.is_some_and(|(fault, _)| disobeys(fault))
}

/// Whether limit switches, a second sensor or the valve command can tell where the table is, by [`Promise::Roomy`]: the LVDT has
/// outrun what is hidden so far, and the table moved for so long (s) before a fault that may pass `as_gain`.
pub(super) fn told_of(case: &Case, outrun: &Outrun, moved: f64, as_gain: bool) -> bool {
    let off = case.table.b0 / case.table.a1 / MODEL_GAIN - 1.0;
    let known = (off.abs() <= NEAR_MODEL && !as_gain) || moved > LEARNED;
    case.aided() || (known && case.peak() <= STROKE - ROOM && outrun.farthest > OUTRUN)
}

/// Whether a command softens what the specimen feels: none does where the loop behind the device follows a broken wire, the valve
/// does not obey, or a payload knocks.
pub(in crate::faults) fn softened(case: &Case) -> bool {
    let knocks = matches!(case.fault, Fault::Table(PlantFault::Payload { .. }));
    !matches!(case.class.promise, Promise::Relay(..)) && !case.shares() && !disobeys(case) && !knocks
}
