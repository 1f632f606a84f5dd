//! The last part of the demonstration: a recording with an effect that the stated model leaves out, made by code that
//! shares nothing with the diagnosis, which is told the stated model only.

use super::super::diagnose::page;
use super::super::{Failure, progress};
use crate::diagnose::{Examined, Options, diagnose};
use crate::digits;
use crate::recording::Experiment;
use crate::report::{Item, Section, Table};
use serde_json::{Value, json};
use shakedown_truth::answer::Opened;
use shakedown_truth::effect::Effect;
use shakedown_truth::plan::{Stratum, Strength, stratum};
use std::fmt::Display;

/// What every laboratory knows, and a diagnosis finds in seconds: one of these is concealed.
const KNOWN: [Effect; 3] = [Effect::SupplyDroop, Effect::OilCompliance, Effect::ValveLag];

/// What was concealed, and what was found.
pub(super) struct Concealed {
    number: u64,
    seal: String,
    examined: Examined,
    opened: Opened,
}

/// Deals the seed's first case with one effect that matters, diagnoses it, and opens the answer once its own is written.
pub(super) fn play(seed: u64) -> Result<Concealed, Failure> {
    let failed = |e: &dyn Display| Failure::Work(format!("demo: concealed effect: {e}"));
    let spinner = progress::spinner("making recordings with a concealed effect".into());
    let matters = |number: &u64| matches!(stratum(seed, *number), Stratum::Single(effect, Strength::Gross) if KNOWN.contains(&effect));
    // Cases come in cycles, and every cycle holds many such.
    let number = (0..1000).find(matters).unwrap_or_default();
    let case = shakedown_truth::case(seed, number);
    let folder = tempfile::tempdir().map_err(|e| failed(&e))?;
    case.write(folder.path()).map_err(|e| failed(&e))?;
    let experiment = Experiment::load(&folder.path().join("experiment.toml")).map_err(|e| failed(&e))?;
    let say = |what: &str, _share: f64| spinner.set_message(format!("diagnosis: {what}"));
    let examined = diagnose(&experiment, &Options { progress: Some(&say) }).map_err(|e| failed(&e))?;
    let answer = folder.path().join("answer.json");
    let text = serde_json::to_string(&examined.diagnosis).map_err(|e| failed(&e))?;
    std::fs::write(&answer, text).map_err(|e| failed(&e))?;
    let seal = case.sealed.seal.clone();
    let opened = case.sealed.open_after(&answer).map_err(|e| failed(&e))?;
    spinner.finish_and_clear();
    Ok(Concealed { number, seal, examined, opened })
}

impl Concealed {
    fn named(&self) -> Vec<&str> {
        self.examined.diagnosis.effects.iter().map(|e| e.id).collect()
    }

    fn true_names(&self) -> Vec<&'static str> {
        self.opened.answer.effects.iter().map(|e| e.id).collect()
    }

    /// One sentence on what came out, right or wrong.
    pub(super) fn lead(&self) -> String {
        let (named, truth) = (self.named(), self.true_names());
        let outcome = if named == truth { "found" } else { "not found" };
        let (before, after) = (&self.examined.diagnosis.judged.before, &self.examined.diagnosis.judged.after);
        format!(
            "Concealed in recordings of a table made elsewhere: {}, {outcome}; chi2 on the hold-out run {} -> {}, 1 being \
             the noise floor.",
            truth.join(" and "),
            digits::three(before.chi2),
            digits::three(after.chi2)
        )
    }

    /// The page's part.
    pub(super) fn section(&self) -> Section {
        let told = format!(
            "Recordings of a table whose equations, integrator and sensors share no code with this tool come with a model \
             that leaves something out. The diagnosis is told that model; the answer stays behind its hash ({}) until \
             the diagnosis has written its own. It said: {}",
            &self.seal[..self.seal.len().min(16)],
            page::lead(&self.examined.diagnosis)
        );
        let mut items = vec![Item::Text(told), Item::Table(self.table())];
        items.extend(page::predicted(&self.examined).items.into_iter().take(6));
        items.push(Item::Note(
            "`shakedown diagnose EXPERIMENT.toml` does this with your recordings, `shakedown init` writes the experiment, and \
             `shakedown prove` examines the diagnosis on hundreds of such cases."
                .into(),
        ));
        Section { heading: "A concealed effect, found".into(), items }
    }

    /// What was found beside what was there.
    fn table(&self) -> Table {
        let mut rows = Vec::new();
        for truth in &self.opened.answer.effects {
            let found = self.examined.diagnosis.effects.iter().find(|e| e.id == truth.id);
            for (key, value) in &truth.parameters {
                let q = found.and_then(|e| e.parameters.get(*key));
                let number = |x: Option<f64>| match x {
                    None => "-".into(),
                    Some(x) if x.abs() < 0.01 => format!("{x:.3e}"),
                    Some(x) => format!("{x:.4}"),
                };
                rows.push(vec![
                    format!("{}.{key}", truth.id),
                    number(Some(*value)),
                    number(q.map(|q| q.value)),
                    number(q.and_then(|q| q.low)),
                    number(q.and_then(|q| q.high)),
                    q.map_or(String::new(), |q| q.unit.to_owned()),
                ]);
            }
        }
        for extra in self.examined.diagnosis.effects.iter().filter(|e| !self.true_names().contains(&e.id)) {
            let blank = || "-".to_owned();
            rows.push(vec![extra.id.to_owned(), "not there".into(), "named".into(), blank(), blank(), String::new()]);
        }
        Table {
            columns: ["parameter", "built in", "found", "90 % from", "90 % to", "unit"].map(String::from).into(),
            rows,
            caption: "What was concealed, and what the diagnosis made of it. The truth's equations are not the library's, so \
                      that the best values differ a little"
                .into(),
        }
    }

    /// The same for other tools.
    pub(super) fn json(&self) -> Value {
        let holdout = &self.examined.diagnosis.judged;
        json!({"case": self.number, "seal": self.seal, "concealed": self.true_names(), "named": self.named(),
               "chi2_before": holdout.before.chi2, "chi2_after": holdout.after.chi2})
    }
}
