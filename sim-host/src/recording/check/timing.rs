//! Time stamps that repeat, run backwards or scatter.

use super::{Fault, Finding, Severity};
use crate::recording::channel::Channel;
use crate::recording::run::Run;

/// Jitter below this part of a step is a converter's ordinary clock.
const ORDINARY_JITTER: f64 = 0.004;

/// Looks at what laying the grid found.
pub(super) fn check(run: &Run) -> Vec<Finding> {
    let clock = &run.clock;
    let mut findings = Vec::new();
    let mut stamps: Vec<f64> =
        [&clock.repeated, &clock.backwards, &clock.doubled, &clock.misread].into_iter().flatten().copied().collect();
    stamps.sort_by(f64::total_cmp);
    stamps.dedup();
    if let (Some(&from_s), Some(&to_s)) = (stamps.first(), stamps.last()) {
        let what = match (clock.repeated.len(), clock.backwards.len(), clock.misread.len()) {
            (_, 0, 0) => "repeat the one before".to_owned(),
            (0, _, 0) => "run backwards".to_owned(),
            (repeated, backwards, ahead) => {
                format!("repeat ({repeated}), run backwards ({backwards}) or jump ahead ({ahead})")
            }
        };
        let finding =
            Finding { from_s, to_s, ..Finding::whole(run, Channel::Time, Fault::RepeatedTime, Severity::BadData) };
        findings.push(finding.saying(
            format!("{} of {} time stamps {what}", stamps.len(), run.len()),
            "export the recording again; if the stamps alone are wrong and the rows are even, give `time = { step = ... }`",
        ));
    }
    if clock.coarse {
        findings.push(Finding::whole(run, Channel::Time, Fault::JitteringTime, Severity::Remark).saying(
            format!(
                "the time stamps are coarser than the sampling step; rows were taken as evenly {:.6} s apart",
                run.dt
            ),
            "export the time with more digits, or give `time = { step = ... }`",
        ));
    } else if clock.jitter > ORDINARY_JITTER * run.dt {
        let percent = 100.0 * clock.jitter / run.dt;
        findings.push(Finding::whole(run, Channel::Time, Fault::JitteringTime, Severity::Remark).saying(
            format!(
                "the time stamps scatter by {percent:.0} % of the step ({:.3} ms, at most {:.3} ms)",
                1e3 * clock.jitter,
                1e3 * clock.jitter_peak
            ),
            "rows were taken as even; where they were really sampled unevenly, record from a hardware clock",
        ));
    }
    findings
}
