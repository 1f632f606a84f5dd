//! What a diagnosis claims of a stretch, and whether that is the planted fault.

use super::{Fault, Kind};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// One claim: a name, a fault of the set-up, or a finding on the data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// What is claimed.
    pub what: String,
    /// The channel, or the parameter.
    pub of: String,
    /// Its value, where it has one: SI.
    pub value: Option<f64>,
}

/// Everything that a diagnosis claims.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Claims(pub Vec<Claim>);

impl Claims {
    /// In words.
    pub fn text(&self) -> String {
        let one = |c: &Claim| {
            let value = c.value.map_or(String::new(), |v| format!(" {v:.3e}"));
            format!("{} {}{value}", c.what, c.of)
        };
        if self.0.is_empty() { "nothing".into() } else { self.0.iter().map(one).collect::<Vec<_>>().join(", ") }
    }

    fn of<'a>(&'a self, what: &'a [&'a str], of: &'a str) -> impl Iterator<Item = &'a Claim> {
        self.0.iter().filter(move |c| what.contains(&c.what.as_str()) && (c.of == of || c.of.is_empty()))
    }

    /// What is claimed here by a kind and a channel that `others` does not claim.
    pub fn beyond(&self, others: &Self) -> Vec<String> {
        let known = |c: &&Claim| others.0.iter().any(|o| o.what == c.what && o.of == c.of);
        self.0.iter().filter(|c| !known(c)).map(|c| format!("{} {}", c.what, c.of).trim().to_string()).collect()
    }
}

/// Names that a diagnosis does not tell apart from those it gives: who finds one of them in a part of the recording claims nothing else.
pub fn mistaken_for(diagnosis: &Value) -> Claims {
    let groups = diagnosis.get("indistinguishable").and_then(Value::as_array).cloned().unwrap_or_default();
    let names = groups.iter().filter_map(Value::as_array).flatten().filter_map(Value::as_str);
    Claims(names.map(|name| Claim { what: name.into(), of: String::new(), value: None }).collect())
}

/// Reads the claims of a diagnosis. Noise, values of the model, and what only restates how rows were read are none.
pub fn claims(diagnosis: &Value) -> Claims {
    let text = |v: &Value, key: &str| v.get(key).and_then(Value::as_str).unwrap_or_default().to_string();
    let list = |key: &str| diagnosis.get(key).and_then(Value::as_array).cloned().unwrap_or_default();
    let mut out = Vec::new();
    for effect in list("effects") {
        let parameters = effect.get("parameters").and_then(Value::as_object);
        let value = parameters.and_then(|p| p.values().next()?.get("value")?.as_f64());
        out.push(Claim { what: text(&effect, "id"), of: String::new(), value });
    }
    for fault in list("set_up") {
        let what = text(&fault, "what");
        let of = if what == "model_value" { text(&fault, "parameter") } else { text(&fault, "channel") };
        if !matches!(what.as_str(), "noise" | "noise_growth") {
            out.push(Claim { what, of, value: fault.get("found").and_then(Value::as_f64) });
        }
    }
    for finding in list("findings") {
        let what = text(&finding, "fault");
        let value = milliseconds(&text(&finding, "problem"));
        out.push(Claim { what, of: text(&finding, "channel"), value });
    }
    Claims(out)
}

/// A time that a finding states in milliseconds (s).
fn milliseconds(problem: &str) -> Option<f64> {
    let words: Vec<&str> = problem.split_whitespace().collect();
    let at = words.iter().position(|word| *word == "ms")?;
    words.get(at.checked_sub(1)?)?.parse::<f64>().ok().map(|v| v * 1e-3)
}

/// Whether the planted fault is claimed: by its name on its channel, and where the recording has a fault of this kind of its own, by
/// a value that moved by what was planted, to half of it.
pub fn found(fault: &Fault, planted: &Claims, untouched: &Claims) -> bool {
    let channel = fault.channel.as_str();
    let late: &[&str] =
        &["skew", "sample_shift", "controller_delay", "sensor_lag", "acceleration_lag", "command_delay"];
    let names: &[&str] = match fault.kind {
        Kind::Delay | Kind::Filter => late,
        Kind::Gain => {
            &["sensor_gain", "acceleration_gain", "wrong-unit", "controller_kp", "controller_kv", "wrong-controller"]
        }
        Kind::Bias => &["acceleration_bias", "offset", "drift", "null_bias"],
        Kind::Friction => &["coulomb_friction", "stribeck_friction", "viscous_friction"],
    };
    // A friction that the twin states is found where its value moved.
    let is_friction = |claim: &Claim| names.iter().any(|name| claim.of.split('.').next() == Some(*name));
    let changed = |claim: &Claim| claim.what == "model_value" && is_friction(claim);
    if fault.kind == Kind::Friction && planted.0.iter().any(|c| changed(c) && !untouched.0.iter().any(|u| u.of == c.of))
    {
        return true;
    }
    let moved = |now: &Claim| {
        let then = untouched.of(names, channel).find(|c| c.what == now.what);
        match (then, now.value, then.and_then(|c| c.value)) {
            (None, ..) => true,
            // A gain is planted as a share, and may be claimed in any unit.
            (Some(_), Some(now), Some(then)) if fault.kind == Kind::Gain => {
                ((now / then - 1.0).abs() - fault.size.abs()).abs() <= 0.5 * fault.size.abs()
            }
            (Some(_), Some(now), Some(then)) => ((now - then).abs() - fault.size.abs()).abs() <= 0.5 * fault.size.abs(),
            _ => false,
        }
    };
    planted.of(names, channel).any(moved)
}

#[cfg(test)]
mod tests {
    use super::super::{Fault, Kind};
    use super::{claims, found};
    use serde_json::json;

    fn late(ms: f64) -> super::Claims {
        let problem = format!("acceleration comes {ms} ms (1.7 samples) after the motion");
        claims(&json!({"findings": [{"fault": "skew", "channel": "acceleration", "problem": problem}]}))
    }

    #[test]
    fn a_delay_beside_one_of_the_recordings_own_is_found_by_what_it_adds() {
        let (kind, channel, unit) = (Kind::Delay, "acceleration".into(), "s".into());
        let fault = Fault { kind, channel, unit, size: 5e-3, sigma: 9.0 };
        assert!(found(&fault, &late(13.2), &late(8.3)));
        assert!(!found(&fault, &late(8.4), &late(8.3)));
        assert!(found(&fault, &late(5.0), &claims(&json!({}))));
        assert!(!found(&fault, &claims(&json!({})), &late(8.3)));
        assert!(late(8.4).beyond(&late(8.3)).is_empty());
        assert_eq!(late(8.4).beyond(&claims(&json!({}))), ["skew acceleration"]);
    }
}
