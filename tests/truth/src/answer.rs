//! The answer to a case, and the seal on it.

use crate::plan::{Stratum, Strength};
use crate::sheet::Sheets;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// One effect that is truly there.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueEffect {
    /// Its identifier.
    pub id: &'static str,
    /// Parameters in the library's keys and SI units, as the truth was built. Where the truth's equation is another than
    /// the library's, the library's best value differs from it a little.
    pub parameters: Vec<(&'static str, f64)>,
}

/// What was done to the data of a bad-data case.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// What was done.
    pub problem: &'static str,
    /// The channel it was done to; empty where it was done to the whole run.
    pub channel: &'static str,
    /// File of the run; none where it is in all of them.
    pub run: Option<String>,
}

/// The clear answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Seed and number of the case.
    pub case: (u64, u64),
    /// What it is about.
    pub stratum: Stratum,
    /// `servo`, `rigid` or `axis`.
    pub machine: &'static str,
    /// True values of the stated model's parameters, by key.
    pub model: Vec<(&'static str, f64)>,
    /// Listed effects that are missing from the stated model.
    pub effects: Vec<TrueEffect>,
    /// Name of the flaw where no library holds it.
    pub unlisted: Option<&'static str>,
    /// Effects that the data of this case cannot tell apart.
    pub groups: Vec<Vec<&'static str>>,
    /// Effects whose naming is no wrong name.
    pub tolerated: Vec<&'static str>,
    /// What is wrong with the data.
    pub fault: Option<Fault>,
    /// Whether `bad-data` is as right a verdict as any.
    pub bad_data_accepted: bool,
    /// Chi2 of the refitted baseline on the run held out: one, and what the flaw adds without noise.
    pub baseline_chi2: f64,
}

impl Answer {
    /// Strength class by what it came to be; none for a null and for bad data.
    pub fn strength(&self) -> Option<Strength> {
        (!matches!(self.stratum, Stratum::Null | Stratum::BadData)).then(|| Strength::of(self.baseline_chi2))
    }

    /// As JSON: what the seal is taken of.
    pub fn to_json(&self) -> Value {
        let effects: Vec<Value> = self
            .effects
            .iter()
            .map(|effect| {
                let parameters: serde_json::Map<String, Value> =
                    effect.parameters.iter().map(|(key, value)| ((*key).to_string(), json!(value))).collect();
                json!({"id": effect.id, "parameters": parameters})
            })
            .collect();
        let model: serde_json::Map<String, Value> =
            self.model.iter().map(|(key, value)| ((*key).to_string(), json!(value))).collect();
        let fault = self.fault.as_ref().map(|f| json!({"problem": f.problem, "channel": f.channel, "run": f.run}));
        json!({
            "seed": self.case.0, "case": self.case.1, "stratum": self.stratum.name(), "machine": self.machine,
            "model": model, "strength": self.strength().map(Strength::name), "effects": effects, "unlisted": self.unlisted,
            "groups": self.groups, "tolerated": self.tolerated, "fault": fault,
            "bad_data_accepted": self.bad_data_accepted, "baseline_chi2": self.baseline_chi2,
        })
    }
}

/// Why an answer was not opened.
#[derive(Debug, thiserror::Error)]
pub enum SealError {
    /// The examinee has not answered yet.
    #[error("{path}: no answer of the examinee lies there ({cause}); the case stays sealed")]
    NotAnswered {
        /// Where its answer should lie.
        path: PathBuf,
        /// What the file system said.
        cause: std::io::Error,
    },
    /// The file is empty.
    #[error("{0}: the examinee's answer is empty; the case stays sealed")]
    Empty(PathBuf),
}

/// An answer behind a salted hash.
#[derive(Debug, Clone)]
pub struct Sealed {
    answer: Answer,
    clean: Sheets,
    salt: [u8; 32],
    /// SHA-256 of salt and answer, in hexadecimal: fit to be published before the examination.
    pub seal: String,
}

/// An opened answer.
#[derive(Debug, Clone)]
pub struct Opened {
    /// The answer.
    pub answer: Answer,
    /// The salt, in hexadecimal, so that anybody can check the seal.
    pub salt: String,
    /// The same experiment without noise, its model declaring the effects that are there: what the library's own form
    /// fits best is the value that its intervals are to cover.
    pub clean: Sheets,
}

impl Sealed {
    pub(crate) fn new(answer: Answer, clean: Sheets, salt: [u8; 32]) -> Self {
        let seal = seal(&salt, &answer);
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

impl Opened {
    /// The seal that the opened answer must have had.
    pub fn seal(&self) -> String {
        let salt: Vec<u8> = (0..self.salt.len() / 2)
            .filter_map(|i| u8::from_str_radix(&self.salt[2 * i..2 * i + 2], 16).ok())
            .collect();
        seal(&salt, &self.answer)
    }
}

fn seal(salt: &[u8], answer: &Answer) -> String {
    let mut hash = Sha256::new();
    hash.update(salt);
    hash.update(answer.to_json().to_string().as_bytes());
    hex(&hash.finalize())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}
