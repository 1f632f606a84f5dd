//! Where the runs fitted show nothing and those held back do: a stop that only the largest motion reaches, a limit that only the
//! fastest one meets. Then every other stretch of the runs held back is fitted too, and the stretches between them judge.

use super::decide::{Decision, Judged};
use crate::identify::data::Run;
use crate::identify::model::Yardsticks;
use crate::identify::prepare::Prepared;

/// Shortest stretch, s.
const SHORTEST: f64 = 1.0;
/// Stretches of a run, at least: a motion that shows it once must show it in both kinds.
const STRETCHES: usize = 12;

/// Share of what a model leaves on the runs held back, below which it leaves nothing to speak of on those fitted.
const NOTHING: f64 = 0.1;
/// Share of the excess that is much to leave.
const MUCH: f64 = 0.04;
/// Share of what was left below which another answer is the better one.
const FAR_LESS: f64 = 0.3;

/// True where some model leaves next to nothing on the runs that were fitted, and much on those held back, and what came out
/// does too.
pub(super) fn unseen(decision: &Decision) -> bool {
    let explained = |c: &Judged| c.fit.chi2() - 1.0 < NOTHING * (c.hold.chi2 - 1.0);
    let much = !decision.consistent() && decision.left() > MUCH;
    (decision.unlisted || much) && decision.candidates.iter().any(explained)
}

/// True where what came out with stretches of the runs held back names what is missing, and leaves far less than what came out
/// without where that named something too.
pub(super) fn better(shared: &Decision, decision: &Decision) -> bool {
    let names = !shared.unlisted && !shared.consistent();
    names && (decision.unlisted || shared.left() < FAR_LESS * decision.left())
}

/// The same experiment with every other stretch of the runs held back among those fitted.
pub(super) fn shared(prepared: &Prepared) -> Prepared {
    let mut shared = prepared.clone();
    shared.fit.extend(prepared.holdout.iter().map(|run| kept(run, 0)));
    shared.holdout = prepared.holdout.iter().map(|run| kept(run, 1)).collect();
    shared.yardsticks = Yardsticks::of(&shared.fit, prepared.yardsticks.force);
    shared
}

/// A run of which only the even (0) or odd (1) stretches were measured.
fn kept(run: &Run, parity: usize) -> Run {
    let length = ((SHORTEST / run.dt) as usize).min(run.len() / STRETCHES).max(1);
    let mut run = run.clone();
    for measured in &mut run.measured {
        for (k, value) in measured.values.iter_mut().enumerate() {
            if (k / length) % 2 != parity {
                *value = f64::NAN;
            }
        }
    }
    run
}
