//! The answer to a case of examiner 2, and the seal on it. Its JSON holds all keys of examiner 1's, and more.

use super::choose::one_family;
use super::law::Gate;
use super::setup::Misstated;
use crate::answer::{Fault, SealError};
use crate::plan::Strength;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::path::Path;

/// One thing that is there and not in the stated model: a listed effect or a flaw without a name.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueEffect {
    /// Identifier, or the unlisted kind.
    pub id: String,
    /// Name of its form.
    pub form: String,
    /// Where the form comes from.
    pub source: String,
    /// Parameters in the library's keys and units, as the truth was built; the library's best values differ from them.
    pub parameters: Vec<(&'static str, f64)>,
    /// Block at which it acts.
    pub block: &'static str,
    /// Where it acts, if not everywhere.
    pub gate: Option<Gate>,
    /// Listed effects that are truly part of it.
    pub tolerated: &'static [&'static str],
    /// Added by it to chi2 on the rows held out, all else being there.
    pub excess: f64,
    /// Root of the sum of squares it leaves on all rows after a linear refit of the stated model (standard deviations).
    pub sigma: f64,
}

/// How a tie came out.
#[derive(Debug, Clone, PartialEq)]
pub struct Tie {
    /// How often the case was dealt until it did.
    pub deals: u64,
    /// Root of the sum of squares that the refitted stated model leaves of the recordings (standard deviations).
    pub seen: f64,
    /// Rivals, each with the root of the sum of squares by which it stays apart (standard deviations); the fits end below two.
    pub rivals: Vec<(&'static str, f64)>,
}

/// The clear answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Seed and number.
    pub case: (u64, u64),
    /// Lock that the grammar's kinds follow from.
    pub lock: u64,
    /// Stratum by name.
    pub stratum: &'static str,
    /// `servo`, `rigid` or `axis`.
    pub machine: &'static str,
    /// True parameters of the stated model.
    pub model: Vec<(&'static str, f64)>,
    /// Listed effects.
    pub effects: Vec<TrueEffect>,
    /// Flaws that no library holds.
    pub unlisted: Vec<TrueEffect>,
    /// What was done to bad data.
    pub fault: Option<Fault>,
    /// Effects that these data cannot tell apart.
    pub groups: Vec<Vec<String>>,
    /// Effects whose naming is no wrong name.
    pub tolerated: Vec<&'static str>,
    /// How they came to be a tie; none where none was asked for.
    pub tie: Option<Tie>,
    /// Whether everything is as stated but for the noise.
    pub perfect: bool,
    /// What is not as stated.
    pub misstated: Vec<Misstated>,
    /// Effective standard deviation of displacement (m) and acceleration (m/s2).
    pub noise: (f64, Option<f64>),
    /// Largest cosine between what two of the flaws leave, each beside the other (1); none with fewer than two.
    pub alike: Option<f64>,
    /// Values of the variable that the located flaw depends on, of the motion without flaws, at even shares of all rows.
    pub quantiles: Vec<f64>,
    /// Chi2 of the refitted stated model on the rows held out.
    pub baseline_chi2: f64,
}

impl Answer {
    /// Strength class; none for a null.
    pub fn strength(&self) -> Option<Strength> {
        (self.effects.len() + self.unlisted.len() > 0).then(|| Strength::of(self.baseline_chi2))
    }

    /// As JSON: what the seal is taken of.
    pub fn to_json(&self) -> Value {
        let map = |list: &[(&'static str, f64)]| -> serde_json::Map<String, Value> {
            list.iter().map(|(key, value)| ((*key).to_string(), json!(value))).collect()
        };
        let kinds: Vec<&str> = self.unlisted.iter().map(|u| u.id.as_str()).collect();
        let all: Vec<&TrueEffect> = self.effects.iter().chain(&self.unlisted).collect();
        let mut blocks: Vec<&str> = all.iter().map(|p| p.block).collect();
        blocks.sort_unstable();
        blocks.dedup();
        let ids: Vec<&str> = self.effects.iter().map(|p| p.id.as_str()).collect();
        let one_family = (1..ids.len()).any(|i| ids[..i].iter().any(|other| one_family(ids[i], other)));
        let fault = self.fault.as_ref().map(|f| json!({"problem": f.problem, "channel": f.channel, "run": f.run}));
        let mut answer = json!({
            "examiner": 2, "lock": self.lock, "seed": self.case.0, "case": self.case.1, "stratum": self.stratum, "machine": self.machine,
            "model": map(&self.model), "strength": self.strength().map(Strength::name),
            "effects": self.effects.iter().map(|p| present(p, map(&p.parameters))).collect::<Vec<_>>(),
            "unlisted": (!kinds.is_empty()).then(|| kinds.join(" + ")),
            "unlisted_kinds": self.unlisted.iter().map(|p| present(p, map(&p.parameters))).collect::<Vec<_>>(),
            "groups": self.groups, "tolerated": self.tolerated, "fault": fault, "bad_data_accepted": false,
            "perfect_set_up": self.perfect,
            "set_up": self.misstated.iter().map(misstated).collect::<Vec<_>>(),
            "noise": {"displacement": self.noise.0, "acceleration": self.noise.1},
            "location": {
                "blocks": blocks,
                "time": all.iter().filter_map(|p| time(p)).collect::<Vec<_>>(),
                "state": all.iter().filter_map(|p| state(p, &self.quantiles)).collect::<Vec<_>>(),
            },
            "alike": self.alike, "one_family": one_family, "baseline_chi2": self.baseline_chi2,
        });
        if let Some(tie) = &self.tie {
            answer["tie"] = tied(tie);
        }
        answer
    }
}

fn present(p: &TrueEffect, parameters: serde_json::Map<String, Value>) -> Value {
    json!({"id": p.id, "form": p.form, "source": p.source, "parameters": parameters, "block": p.block,
        "excess": p.excess, "sigma": p.sigma, "everywhere": p.gate.is_none()})
}

fn tied(tie: &Tie) -> Value {
    let rivals: Vec<_> = tie.rivals.iter().map(|(id, apart)| json!({"id": id, "apart": apart})).collect();
    json!({"deals": tie.deals, "seen": tie.seen, "rivals": rivals})
}

fn misstated(m: &Misstated) -> Value {
    json!({"what": m.kind, "channel": m.channel, "run": m.run.map(file), "quantity": m.quantity, "stated": m.stated,
        "is": m.is, "unit": m.unit, "sigma": m.sigma, "tolerated": m.tolerated})
}

/// File of run `number`.
pub fn file(number: u64) -> String {
    format!("run-{}.csv", number + 1)
}

fn time(p: &TrueEffect) -> Option<Value> {
    let Gate::Time { run, from, to } = p.gate? else { return None };
    Some(json!({"id": p.id, "run": run.map(file), "from_s": from, "to_s": to}))
}

fn state(p: &TrueEffect, quantiles: &[f64]) -> Option<Value> {
    let Gate::State { variable, low, high, .. } = p.gate? else { return None };
    let magnitude = variable == super::law::Variable::Speed;
    Some(json!({"id": p.id, "variable": variable.name(), "magnitude": magnitude, "low": low, "high": high,
        "quantiles": quantiles}))
}

/// An answer behind a salted hash.
#[derive(Debug, Clone)]
pub struct Sealed {
    answer: Answer,
    clean: super::sheet::Sheets,
    salt: [u8; 32],
    /// SHA-256 of salt and answer, in hexadecimal.
    pub seal: String,
}

/// An opened answer.
#[derive(Debug, Clone)]
pub struct Opened {
    /// The answer.
    pub answer: Answer,
    /// The salt, in hexadecimal.
    pub salt: String,
    /// The experiment without noise and with nothing misstated, its model declaring the listed effects that are there.
    pub clean: super::sheet::Sheets,
}

impl Sealed {
    pub(super) fn new(answer: Answer, clean: super::sheet::Sheets, salt: [u8; 32]) -> Self {
        let mut hash = Sha256::new();
        hash.update(salt);
        hash.update(answer.to_json().to_string().as_bytes());
        let seal = hex(&hash.finalize());
        Self { answer, clean, salt, seal }
    }

    /// Opens the answer, once the examinee's own lies at `stored`, whole and not empty.
    pub fn open_after(self, stored: &Path) -> Result<Opened, SealError> {
        let meta =
            std::fs::metadata(stored).map_err(|cause| SealError::NotAnswered { path: stored.to_path_buf(), cause })?;
        if meta.len() == 0 {
            return Err(SealError::Empty(stored.to_path_buf()));
        }
        Ok(Opened { answer: self.answer, salt: hex(&self.salt), clean: self.clean })
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}
