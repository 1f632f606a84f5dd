//! A design as the command line writes it, and the uncertainty that a model states.

use super::{Demand, Design, Spread};
use crate::closed_loop::margin::Margins;
use crate::recording::Model;
use serde_json::json;

impl Spread {
    /// The model's intervals as relative half widths, `usual` where it states none.
    pub fn stated(model: &Model, usual: f64) -> Self {
        let of = |name: &str, value: f64| {
            let known = model.accuracy.get(name)?;
            let (low, high) = (known.low?, known.high?);
            (value != 0.0).then(|| ((high - value) / value).abs().max(((value - low) / value).abs()))
        };
        let stated = |name: &str| {
            let (owner, key) = name.split_once('.')?;
            model.effects.iter().find(|e| e.id == owner)?.parameters.get(key).copied()
        };
        let baseline = |name: &str| model.baseline.parameters().into_iter().find(|(n, _)| *n == name).map(|(_, v)| v);
        let held = |found: Option<f64>| found.unwrap_or(usual).min(0.95);
        let frequency = stated("oil_compliance.frequency").and_then(|f| of("oil_compliance.frequency", f));
        Self {
            gain: held(baseline("b0").and_then(|b0| of("b0", b0))),
            pole: held(baseline("a1").and_then(|a1| of("a1", a1))),
            // The frequency goes with the root of the mass.
            mass: held(frequency.map(|share| 2.0 * share)),
            supply: usual.min(0.95),
        }
    }
}

/// The JSON of `shakedown design`: settings, margins on the model and in the worst corner, the uncertainty designed for.
pub fn json(found: &Design, demand: &Demand, unused: &[String]) -> serde_json::Value {
    let of = |m: &Margins| {
        json!({"gain_margin_db": m.gain_db, "phase_margin_degrees": m.phase_degrees, "crossover_hz": m.crossover_hz,
               "peak_sensitivity": m.peak_sensitivity, "left": m.left})
    };
    let s = demand.spread;
    json!({"settings": found.settings, "nominal": of(&found.nominal), "worst": of(&found.worst),
           "corners": found.corners, "unused_effects": unused,
           "expected": {"uncertainty": found.expected[0], "noise": found.expected[1]},
           "spread": {"gain": s.gain, "pole": s.pole, "mass": s.mass, "supply": s.supply}})
}
