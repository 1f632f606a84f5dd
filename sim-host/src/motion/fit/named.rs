//! Every way to fit a record beforehand, by the name that files and flags call it.

use super::super::Motion;
use super::super::fit_area::{self, Choice};
use super::method::{Method, modify};
use super::spectrum::Band;
use super::{FitError, Limits, Norm};
use serde::Deserialize;

/// A way to fit a record before it is played.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(try_from = "String")]
pub enum RecordFit {
    /// One of the paper's choices (Fig. 13), which know the velocity limit alone.
    Area(Choice),
    /// A method of this project, or the paper's Eq. 10 beside them.
    Method(Method),
    /// The nearest waveform within speed and stroke, a fortieth of the speed left for the loop to work with.
    Nearest,
}

/// Share of a table's speed that a record asks for, where the loop is to have room.
pub const ASKED: f64 = 0.975;

/// Seconds of preview where a name says only `preview`.
pub const PREVIEW: f64 = 0.5;

impl RecordFit {
    /// Every fit with its name.
    pub const ALL: [(&'static str, Self); 11] = [
        ("clip", Self::Method(Method::Clip)),
        ("taut", Self::Method(Method::Taut)),
        ("convex", Self::Method(Method::Convex(Norm::Two))),
        ("spectrum", Self::Method(Method::Spectrum(Band::USUAL))),
        ("causal", Self::Method(Method::Causal)),
        ("preview", Self::Method(Method::Preview(PREVIEW))),
        ("nearest", Self::Nearest),
        ("peak-kept", Self::Area(Choice::PeakKept)),
        ("peak-scaled", Self::Area(Choice::PeakScaled)),
        ("record-scaled", Self::Area(Choice::RecordScaled)),
        ("time-compressed", Self::Area(Choice::TimeCompressed)),
    ];

    /// The fit of a name.
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| *known == name).map(|(_, fit)| *fit)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, fit)| *fit == self).map_or("a method of its own", |(name, _)| name)
    }

    /// Every name.
    pub fn names() -> [&'static str; 11] {
        Self::ALL.map(|(name, _)| name)
    }

    /// The motion within `velocity` (m/s) and, where the fit knows it, `stroke` (m). `progress` is told what is being done.
    pub fn apply(
        self,
        motion: &Motion,
        velocity: f64,
        stroke: f64,
        progress: impl FnMut(&str),
    ) -> Result<Motion, FitError> {
        match self {
            Self::Area(choice) => fit_area::fit(motion, velocity, choice)
                .map_err(|error| FitError::Limit { name: "velocity", value: error.0 }),
            Self::Nearest => {
                let limits = Limits::table(ASKED * velocity, stroke);
                Ok(modify(motion, &limits, Method::Convex(Norm::Two), progress)?.motion)
            }
            Self::Method(method) => Ok(modify(motion, &Limits::table(velocity, stroke), method, progress)?.motion),
        }
    }
}

impl TryFrom<String> for RecordFit {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::parse(&name).ok_or_else(|| format!("unknown fit `{name}`: expected one of {}", Self::names().join(" ")))
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::generate::NEAR_FIELD_MODERATE;
    use super::super::super::peak;
    use super::*;

    #[test]
    fn every_name_fits_a_motion_to_its_velocity_limit() {
        let recipe = super::super::super::generate::Recipe { duration: 12.0, rate: 100.0, ..NEAR_FIELD_MODERATE };
        let motion = recipe.generate(2).unwrap().motion();
        let limit = 0.6 * peak(&motion.velocity);
        let stroke = 2.0 * peak(&motion.displacement);
        for name in RecordFit::names() {
            let fit = RecordFit::parse(name).unwrap();
            let fitted = fit.apply(&motion, limit, stroke, |_| {}).unwrap();
            assert!(peak(&fitted.velocity) <= limit * 1.0001, "{name}: {} of {limit}", peak(&fitted.velocity));
            assert!(peak(&fitted.acceleration) > 0.2 * peak(&motion.acceleration), "{name}");
        }
        assert!(RecordFit::try_from(String::from("cut")).unwrap_err().contains("expected one of clip taut convex"));
    }
}
