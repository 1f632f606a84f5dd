//! An identification from end to end: fitted, with intervals, judged on the hold-out runs.

use super::fit::Fit;
use super::interval::{Interval, profiles};
use super::judge::{Score, score};
use super::model::Value;
use super::prepare::{PrepareError, Prepared, prepare};
use super::quantity::{Quantity, profiled, stated_as};
use super::starts;
use super::transfer::{Transfer, transfer};
use crate::digits;
use crate::plant::simulate::SimulateError;
use crate::recording::check::{Fault, Finding, check, is_bad_data};
use crate::recording::{self, Experiment, without_clipped};
use std::collections::BTreeMap;

/// Squares that a tenth less of a value at an end would cost, from which the fit wants to go beyond it.
const PUSHED: f64 = 9.0;
/// An interval wider than this factor tells hardly more than the order of magnitude.
const WIDE: f64 = 3.0;

/// Why nothing was identified.
#[derive(Debug, thiserror::Error)]
pub enum IdentifyError {
    /// The recordings cannot be believed.
    #[error("{}", told(.0))]
    BadData(Vec<Finding>),
    /// The experiment cannot be fitted.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// The model cannot be simulated.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
}

fn told(findings: &[Finding]) -> String {
    let grave = findings.iter().filter(|f| f.severity == recording::Severity::BadData);
    let lines: Vec<String> = grave
        .map(|f| format!("{}, {}, {:.3} to {:.3} s: {}; {}", f.run, f.channel, f.from_s, f.to_s, f.problem, f.remedy))
        .collect();
    lines.join("\n")
}

/// What came out.
#[derive(Debug, Clone)]
pub struct Identified {
    /// Model and runs as they were fitted.
    pub prepared: Prepared,
    /// The fit.
    pub fit: Fit,
    /// The 90 % interval of every shared value in the order of the model's; none where it was not free.
    pub intervals: Vec<Option<Interval>>,
    /// Every value that was free, by name.
    pub quantities: BTreeMap<String, Quantity>,
    /// Standing on the runs fitted.
    pub fitted: Score,
    /// Standing on the hold-out runs; on those fitted where none was.
    pub held_back: Score,
    /// The table as a transfer function; none where no command or no motion was recorded.
    pub transfer: Option<Transfer>,
    /// What is worth knowing of the recordings.
    pub findings: Vec<Finding>,
}

/// Fits an experiment's model, profiles its parameters and judges it.
pub fn identify(experiment: &Experiment) -> Result<Identified, IdentifyError> {
    let (experiment, remarks) = without_clipped(experiment);
    let mut findings = check(&experiment);
    if is_bad_data(&findings) {
        return Err(IdentifyError::BadData(findings));
    }
    // What is left out is missing, which says the same twice.
    findings.retain(|f| {
        f.fault != Fault::MissingStretch || remarks.iter().all(|r| (&r.run, r.channel) != (&f.run, f.channel))
    });
    findings.extend(remarks);
    let prepared = prepare(&experiment)?;
    let fit = starts::fitted(&prepared)?;
    let intervals = profiles(&fit, &prepared.fit)?;
    let free: Vec<String> =
        fit.model.names().into_iter().zip(fit.model.values()).filter(|(_, v)| v.free).map(|(n, _)| n).collect();
    let mut quantities = profiled(&fit, &intervals);
    quantities.retain(|name, _| free.contains(name));
    let fitted = score(&fit.model, &prepared.fit)?;
    let held_back = if prepared.holdout.is_empty() { fitted.clone() } else { score(&fit.model, &prepared.holdout)? };
    let transfer = transfer(&prepared.fit, &prepared.holdout).ok();
    Ok(Identified { prepared, fit, intervals, quantities, fitted, held_back, transfer, findings })
}

impl Identified {
    /// The stated model with the values found, for `table.toml`.
    pub fn model(&self, stated: &recording::Model) -> recording::Model {
        stated_as(stated, &self.fit, &self.quantities)
    }

    /// What these runs do not say, one sentence each.
    pub fn doubts(&self) -> Vec<String> {
        let ended = self.ended();
        let of = |(name, q): (&String, &Quantity)| {
            let ended = ended.iter().find(|(of, _)| of == name);
            ended.map(|(_, value)| end_of_range(name, value, q.unit)).or_else(|| doubt(name, q))
        };
        self.quantities.iter().filter_map(of).collect()
    }

    /// Values that the fit would take beyond the end of the range that it looks in. A limit that is never met goes to its end by itself.
    fn ended(&self) -> Vec<(String, Value)> {
        let model = &self.fit.model;
        let all = model.names().into_iter().zip(model.values()).zip(self.fit.pushed());
        let beyond = all.filter(|((name, _), cost)| *cost > PUSHED && name != "velocity_limit");
        beyond.map(|((name, value), _)| (name, *value)).collect()
    }
}

fn end_of_range(name: &str, value: &Value, unit: &str) -> String {
    let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
    let [at, low, high] = [value.value, value.low, value.high].map(digits::three);
    format!(
        "{name}: the fit went to {at}{unit}, the end of the range it looks in ({low} to {high}), and would go on; state a value nearer to the truth"
    )
}

fn doubt(name: &str, q: &Quantity) -> Option<String> {
    let unit = if q.unit == "1" { String::new() } else { format!(" {}", q.unit) };
    // An end that stands alone has no error of its own: three digits.
    let one = |x: f64| format!("{}{unit}", digits::three(x));
    let both = |low: f64, high: f64| {
        let width = high - low;
        format!("{} to {}{unit}", digits::to(low, width), digits::to(high, width))
    };
    match (q.low, q.high) {
        (Some(low), None) if name == "velocity_limit" => Some(format!(
            "velocity_limit: these runs do not reach it; it is at least {}. Drive faster to find it",
            one(low)
        )),
        (Some(low), None) => Some(format!("{name}: these runs say only that it is at least {}", one(low))),
        (None, Some(high)) => Some(format!("{name}: these runs say only that it is at most {}", one(high))),
        (None, None) => Some(format!("{name}: these runs do not determine it; fix it, or record other motions")),
        (Some(low), Some(high)) if low * high > 0.0 && (high / low).abs().max((low / high).abs()) > WIDE => {
            Some(format!("{name}: hardly determined, {}", both(low, high)))
        }
        (Some(low), Some(high)) if low * high <= 0.0 => {
            Some(format!("{name}: not significantly different from zero, {}", both(low, high)))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_of_the_range_is_no_word_of_the_data() {
        let value = Value { value: 576.5, low: 5.765, high: 576.5, positive: true, free: true, prior: None };
        let said = end_of_range("a1", &value, "1/s");
        assert!(said.contains("went to 577 1/s") && said.contains("(5.77 to 577)"), "{said}");
    }

    #[test]
    fn what_is_not_known_is_said() {
        let q = |low, high| Quantity { value: 0.3, std: None, low, high, unit: "m/s" };
        let said = |name, low, high| doubt(name, &q(low, high));
        assert!(said("velocity_limit", Some(0.21), None).unwrap().contains("at least 0.210 m/s"));
        assert!(said("b1", None, None).unwrap().contains("do not determine"));
        assert!(said("b1", None, Some(2.0)).unwrap().contains("at most 2.00 m/s"));
        assert!(said("b1", Some(0.1), Some(0.9)).unwrap().contains("hardly"));
        assert!(said("b1", Some(-0.1), Some(0.9)).unwrap().contains("zero"));
        assert_eq!(said("b1", Some(0.29), Some(0.31)), None);
    }
}
