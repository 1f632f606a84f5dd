//! What a fit came to: its figures, once for the JSON and once for the page.

use super::super::Failure;
use serde_json::{Value, json};
use shakedown::motion::fit::certificate::{self, Relaxation, Stretch};
use shakedown::motion::fit::method::{Method, Modified};
use shakedown::motion::fit::{Limits, Reference};
use shakedown::motion::metrics::{Comparison, compare};
use shakedown::motion::{Motion, STANDARD_GRAVITY};

/// Everything the command found out.
pub(super) struct Answer {
    pub(super) name: String,
    pub(super) conditioning: String,
    pub(super) method: Method,
    pub(super) limits: Limits,
    /// What was asked for, after conditioning.
    pub(super) motion: Motion,
    pub(super) modified: Modified,
    /// What Eq. 10 makes of it.
    pub(super) clipped: Motion,
    pub(super) relaxations: Vec<Relaxation>,
    pub(super) target: Option<f64>,
    pub(super) seconds: f64,
    /// What was written, by key; empty where nothing was.
    pub(super) drive: Vec<(String, String)>,
}

impl Answer {
    /// The method in words.
    pub(super) fn method_name(&self) -> String {
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

    /// A motion against the one asked for.
    pub(super) fn compared(&self, motion: &Motion) -> Result<Comparison, Failure> {
        compare(&self.motion, motion, None).map_err(|e| Failure::Work(format!("modify: {e}")))
    }

    /// Where acceleration was given up.
    pub(super) fn stretches(&self) -> Vec<Stretch> {
        let start = self.motion.displacement.first().copied().unwrap_or(0.0);
        Reference::new(self.motion.dt, self.motion.velocity.clone(), start)
            .map(|reference| certificate::given_up(&reference, &self.modified.motion.velocity, &self.limits))
            .unwrap_or_default()
    }

    /// The shape that docs/formats.md states, and more.
    pub(super) fn json(&self) -> Result<Value, Failure> {
        let (fitted, clipped) = (self.compared(&self.modified.motion)?, self.compared(&self.clipped)?);
        let (displacement, velocity, acceleration) = self.modified.motion.peaks();
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
        Ok(json!({
            "record": self.name,
            "conditioning": self.conditioning,
            "method": self.method_name(),
            "e_a": fitted.e_a_unshifted.ratio,
            "e_a_shifted": fitted.e_a.ratio,
            "e_a_clip": clipped.e_a_unshifted.ratio,
            "e_a_bound": self.modified.bound,
            "e_d": fitted.e_d_unshifted.ratio,
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
        }))
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
