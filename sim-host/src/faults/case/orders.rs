//! What the operator asks for in a run, and when its fault begins: as a rule while the test runs, else in any state and
//! during any transition.

use super::{Fault, REST};
use crate::faults::dice::FaultRng;
use crate::faults::spoil::SignalFault;
use shakedown_core::OperatorRequest::{self, Arm, Hold, Resume, Start, Stop};

/// Share of the runs in which a test is held, resumed and stopped.
const VARIED: f64 = 0.2;

/// Orders by tick, and the first tick of the fault, which begins `began` (s) after the first where the test just runs.
pub(super) fn orders(
    dice: &mut FaultRng,
    fault: Fault,
    began: f64,
    rate: f64,
) -> (Vec<(usize, OperatorRequest)>, usize) {
    let tick = |time: f64| (time * rate).round() as usize;
    let arm = (tick(REST), Arm);
    if !may_begin_anywhere(fault) || !dice.chance(VARIED) {
        return (vec![arm, (tick(REST), Start)], tick(began));
    }
    let start = REST + dice.uniform(0.0, 0.4);
    let hold = start + dice.uniform(0.1, 3.0);
    let resume = hold + dice.uniform(0.05, 1.5);
    let stop = resume + dice.uniform(0.1, 2.5);
    let orders = vec![arm, (tick(start), Start), (tick(hold), Hold), (tick(resume), Resume), (tick(stop), Stop)];
    // At any time, or within 0.1 s of an order.
    let near = [REST, start, hold, resume, stop][dice.below(5)] + dice.uniform(-0.05, 0.1);
    let began = if dice.chance(0.5) { near } else { dice.uniform(0.02, stop + 1.6) };
    (orders, tick(began).max(1))
}

/// A stream begins with the test; a gain that was wrong before the test is for commissioning.
fn may_begin_anywhere(fault: Fault) -> bool {
    match fault {
        Fault::LinkCut | Fault::LinkGarbled(_) => false,
        Fault::Signal(_, how) | Fault::Shared(how) => !matches!(how, SignalFault::Gain { .. }),
        _ => true,
    }
}
