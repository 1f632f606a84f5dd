//! What the library's own equations fit best to a case without noise: what a reply's intervals are to cover, and how well one
//! can do.

use super::Examinee;
use super::examiner::Clean;
use super::record::{Attainable, Reply, Truth};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;

/// What the library's own equations do on the case without noise, where that says something about the reply.
pub(super) fn attainable(
    examinee: &impl Examinee,
    clean: &Clean,
    reply: &Reply,
    truth: &Truth,
    scratch: &Path,
) -> Option<Attainable> {
    let named = reply.effects.iter().any(|e| truth.effects.iter().any(|p| p.id == e.id));
    let visible = matches!(truth.strength.as_deref(), Some("clear" | "gross"));
    if truth.effects.is_empty() || !(named || visible) {
        return None;
    }
    let desk = scratch.join("clean");
    clean.write(&desk).ok()?;
    let path = desk.join("experiment.toml");
    // Where no displacement is recorded the loop is closed by the simulated one, which has no noise anyway.
    let _ = change(&path, "displacement = { ", "displacement = { loop_noise = 0, ");
    if reply.held_out_shared {
        change(&path, "use = \"holdout\"", "use = \"fit\"")?;
    }
    let as_given = best_fit(examinee, &path);
    let near = begin_at(&path, reply, truth).and_then(|()| best_fit(examinee, &path));
    // Either start may end in a hollow of the other's making; the best fit is the best of both.
    [as_given, near].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, attainable)| attainable)
}

/// chi2 of the runs fitted, and what comes of it.
fn best_fit(examinee: &impl Examinee, path: &Path) -> Option<(f64, Attainable)> {
    let fitted = examinee.identify(path)?.ok()?;
    let parameters = fitted.get("parameters")?.as_object()?;
    let values = parameters.iter().filter_map(|(key, p)| Some((key.clone(), p.get("value")?.as_f64()?)));
    let chi2 = |of: &str| fitted.pointer(of).and_then(Value::as_f64);
    let floor = chi2("/holdout/chi2").map(|chi2| 1.0 + chi2);
    Some((chi2("/fit/chi2").unwrap_or(f64::INFINITY), Attainable { parameters: values.collect(), floor }))
}

/// States the reply's values, the model's own among them, as where the fit of the case without noise begins; none where not
/// all effects were named.
fn begin_at(path: &Path, reply: &Reply, truth: &Truth) -> Option<()> {
    let stated = std::fs::read_to_string(path).ok()?;
    let mut text: String = stated.lines().map(|line| restated(line, reply) + "\n").collect();
    for present in &truth.effects {
        let named = reply.effects.iter().find(|effect| effect.id == present.id)?;
        let _ = writeln!(text, "\n[effects.{}]", named.id);
        for (key, estimate) in &named.parameters {
            let _ = writeln!(text, "{key} = {:e}", estimate.value);
        }
    }
    std::fs::write(path, text).ok()
}

/// A line of an experiment with the reply's value where it states a parameter of the model, which alone are numbers under
/// such keys.
fn restated(line: &str, reply: &Reply) -> String {
    let parameter = line.split_once(" = ").and_then(|(key, _)| Some((key, reply.model.get(key)?)));
    parameter.map_or_else(|| line.to_string(), |(key, estimate)| format!("{key} = {:e}", estimate.value))
}

/// Rewrites what an experiment says, which it must say: its loop saw no noise; or every run is fitted, where the reply's values
/// come from stretches of all.
fn change(path: &Path, from: &str, to: &str) -> Option<()> {
    let text = std::fs::read_to_string(path).ok().filter(|text| text.contains(from))?;
    std::fs::write(path, text.replace(from, to)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prove::record::{Estimate, Named, TrueEffect};

    #[test]
    fn a_fit_begins_where_the_reply_ended_the_models_own_values_too() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("experiment.toml");
        std::fs::write(&path, "[model]\nkind = \"servo\"\nb0 = 104.4\n\n[channels]\ntime = { column = \"t\" }\n")
            .unwrap();
        let estimate = |value: f64| Estimate { value, ..Estimate::default() };
        let named = Named {
            id: "leakage".into(),
            parameters: [("coefficient".to_string(), estimate(2e-3))].into(),
            ..Named::default()
        };
        let reply =
            Reply { model: [("b0".to_string(), estimate(117.5))].into(), effects: vec![named], ..Reply::default() };
        let present = TrueEffect { id: "leakage".into(), ..TrueEffect::default() };
        let truth = Truth { effects: vec![present], ..Truth::default() };
        begin_at(&path, &reply, &truth).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("kind = \"servo\"\nb0 = 1.175e2\n") && text.contains("[channels]\ntime = {"), "{text}");
        assert!(text.ends_with("\n[effects.leakage]\ncoefficient = 2e-3\n"), "{text}");
    }
}
