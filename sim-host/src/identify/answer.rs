//! What an identification came to, as every host's JSON has it.

use super::frequency::transfer::Trial;
use super::judge::Score;
use super::outcome::Identified;
use super::transfer::Transfer;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The shape that docs/formats.md states.
pub fn value(found: &Identified) -> Value {
    let noise: BTreeMap<&str, f64> =
        found.prepared.fit.iter().flat_map(|run| &run.measured).map(|m| (m.channel.name(), m.noise)).collect();
    let mut fit = standing(&found.fitted);
    fit["converged"] = found.fit.converged().into();
    fit["evaluations"] = found.fit.evaluations.into();
    json!({
        "parameters": found.quantities,
        "fit": fit,
        "holdout": standing(&found.held_back),
        "noise": noise,
        "transfer_function": found.transfer.as_ref().map(function),
        "doubts": found.doubts(),
        "findings": found.findings,
    })
}

/// The transfer function from command to motion and the orders it was chosen among.
fn function(transfer: &Transfer) -> Value {
    let trial = |trial: &Trial| {
        let function = &trial.fit.function;
        json!({
            "numerator": function.numerator,
            "denominator": function.denominator,
            "integrators": function.integrators,
            "delay": function.delay,
            "std": trial.fit.std,
            "chi2": trial.fit.chi2,
            "chi2_held_back": trial.held_back,
        })
    };
    json!({
        "output": transfer.output.name(),
        "judged_by": if transfer.by_runs { "runs held back" } else { "second halves of the runs" },
        "chosen": transfer.trials.first().map(trial),
        "tried": transfer.trials.iter().map(trial).collect::<Vec<_>>(),
    })
}

fn standing(score: &Score) -> Value {
    let nrmse: BTreeMap<&str, f64> = score.nrmse.iter().map(|(c, value)| (c.name(), *value)).collect();
    let r2: BTreeMap<&str, f64> = nrmse.iter().map(|(&c, value)| (c, 1.0 - value * value)).collect();
    json!({ "chi2": score.chi2, "nrmse": nrmse, "r2": r2 })
}
