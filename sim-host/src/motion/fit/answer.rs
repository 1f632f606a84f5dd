//! What a fit came to: its figures, once for every host's JSON and once for the page.

use super::certificate::{self, Relaxation, Stretch};
use super::method::{Method, Modified};
use super::{Limits, Reference};
use crate::motion::metrics::{self, CompareError, Indices, RelativeError};
use crate::motion::spectrum::SpectrumError;
use crate::motion::{Motion, STANDARD_GRAVITY, peak};
use serde_json::{Value, json};

/// Why the figures of a fit cannot be told.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AnswerError {
    /// The fit cannot be compared with what was asked for.
    #[error(transparent)]
    Compare(#[from] CompareError),
    /// Its spectrum cannot be taken.
    #[error(transparent)]
    Spectrum(#[from] SpectrumError),
}

/// How near a motion comes to what was asked for, without shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Of the acceleration.
    pub e_a: RelativeError,
    /// Of the displacement.
    pub e_d: RelativeError,
}

/// How near the fit comes, taken once for JSON, terminal and page: spectra and shifts cost more than some fits.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// What came out.
    pub fitted: Errors,
    /// What Eq. 10 makes of it.
    pub clipped: Errors,
    /// The laboratory's indices of what came out.
    pub indices: Indices,
    /// What came out, by the steps of its velocity: E_a as a bound counts it. Slopes of samples, which E_a is taken from, are smoother.
    pub steps: f64,
}

impl Compared {
    /// The fit and the clipped motion against the one asked for.
    pub fn new(asked: &Motion, fitted: &Motion, clipped: &Motion) -> Result<Self, AnswerError> {
        let errors = |motion: &Motion| -> Result<Errors, CompareError> {
            let (e_a, e_d) = metrics::compare_unshifted(asked, motion)?;
            Ok(Errors { e_a, e_d })
        };
        let (near, far) = (errors(fitted)?, errors(clipped)?);
        let indices = metrics::indices(&asked.acceleration, &fitted.acceleration, asked.dt)?;
        let start = asked.displacement.first().copied().unwrap_or(0.0);
        let reference = Reference::new(asked.dt, asked.velocity.clone(), start);
        let steps = reference.map_or(f64::NAN, |reference| reference.acceleration_error(&fitted.velocity));
        Ok(Self { fitted: near, clipped: far, indices, steps })
    }
}

/// Everything that a fit found out.
#[derive(Debug)]
pub struct Answer {
    /// Name of the record.
    pub name: String,
    /// What was done to it, in words.
    pub conditioning: String,
    /// How it was fitted.
    pub method: Method,
    /// What it was fitted to.
    pub limits: Limits,
    /// What was asked for, after conditioning.
    pub motion: Motion,
    /// What came out.
    pub modified: Modified,
    /// What Eq. 10 makes of it.
    pub clipped: Motion,
    /// How near both come.
    pub compared: Compared,
    /// What it would take to meet the target.
    pub relaxations: Vec<Relaxation>,
    /// The E_a to come down to, 1.
    pub target: Option<f64>,
    /// How long the fit took, s.
    pub seconds: f64,
    /// What was written, by key; empty where nothing was.
    pub drive: Vec<(String, String)>,
}

impl Answer {
    /// The method in words.
    pub fn method_name(&self) -> String {
        match self.method {
            Method::Clip => "clip (Eq. 10)".into(),
            Method::Taut => "taut string".into(),
            Method::Convex(_) => "convex".into(),
            Method::Spectrum(band) => {
                format!("convex, S_a kept over {} to {} s", band.shortest, band.longest)
            }
            Method::Causal => "causal, no preview".into(),
            Method::Preview(seconds) => format!("preview of {seconds} s"),
        }
    }

    /// Where acceleration was given up.
    pub fn stretches(&self) -> Vec<Stretch> {
        let start = self.motion.displacement.first().copied().unwrap_or(0.0);
        Reference::new(self.motion.dt, self.motion.velocity.clone(), start)
            .map(|reference| certificate::given_up(&reference, &self.modified.motion.velocity, &self.limits))
            .unwrap_or_default()
    }

    /// The shape that docs/formats.md states, and more.
    pub fn json(&self) -> Value {
        let Compared { fitted, clipped, indices, steps } = &self.compared;
        let (displacement, velocity) = self.modified.motion.peaks_between();
        let acceleration = peak(&self.modified.motion.acceleration);
        let asked = self.motion.peaks();
        let stretches: Vec<Value> = self.stretches().iter().map(stretch).collect();
        let relaxations: Vec<Value> = self.relaxations.iter().map(relaxation).collect();
        let spectrum = self.modified.spectrum.as_ref().map(|found| {
            let ordinates: Vec<Value> = found
                .ordinates
                .iter()
                .map(|o| {
                    json!({"period_s": o.period, "asked": o.asked, "got": o.got, "reachable": o.reachable,
                           "deviation": o.deviation()})
                })
                .collect();
            json!({"deviation": found.deviation, "deviation_bound": found.bound,
                   "rounds": found.rounds, "ordinates": ordinates})
        });
        json!({
            "record": self.name,
            "conditioning": self.conditioning,
            "method": self.method_name(),
            "e_a": fitted.e_a.ratio,
            "e_a_shifted": indices.shifted,
            "e_a_clip": clipped.e_a.ratio,
            "indices": indices.json(),
            "e_a_steps": steps,
            "e_a_bound": self.modified.bound,
            "e_d": fitted.e_d.ratio,
            "peak_velocity": velocity,
            "peak_displacement": displacement,
            "peak_acceleration": acceleration,
            "end_displacement": self.modified.motion.displacement.last(),
            "reference": {"peak_velocity": asked.1, "peak_displacement": asked.0, "peak_acceleration": asked.2,
                          "peak_g": asked.2 / STANDARD_GRAVITY},
            "limits": self.limits.named().iter().map(|(name, value)| ((*name).to_owned(), json!(value)))
                .collect::<serde_json::Map<_, _>>(),
            "given_up": stretches,
            "target": self.target,
            "relaxations": relaxations,
            "spectrum": spectrum,
            "drive": (!self.drive.is_empty()).then(|| {
                self.drive.iter().map(|(key, value)| (key.clone(), json!(value))).collect::<serde_json::Map<_, _>>()
            }),
            "seconds": self.seconds,
        })
    }
}

fn stretch(stretch: &Stretch) -> Value {
    json!({"from_s": stretch.from, "to_s": stretch.to, "share": stretch.share, "peak_error": stretch.peak,
           "limits": stretch.limits})
}

fn relaxation(relaxation: &Relaxation) -> Value {
    json!({"relaxed": relaxation.relaxed.name(), "met_at": relaxation.met_at, "missed_at": relaxation.missed_at,
           "e_a": relaxation.error, "bound": relaxation.bound})
}
