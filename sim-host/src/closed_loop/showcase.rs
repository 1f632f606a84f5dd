//! The main job from end to end on one motion: the table as it is tuned today, tuned up, and with the record fitted to what
//! it can do. What `shakedown demo` shows.

use super::published::Named;
use super::trial::{ScoredSignal, Scores, Setup, Trial, TrialError};
use crate::motion::Motion;
use crate::motion::fit::method::{Method, modify};
use crate::motion::fit::{FitError, Limits, Norm};
use crate::plant::sensors::SensorModel;
use shakedown_core::{Modification, Settings};

/// One way to run the test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Way {
    /// The gains in use, the record as it is.
    Current,
    /// Strong gains, the record as it is.
    Strong,
    /// Strong gains, velocity clipped online (Eq. 10).
    Clip,
    /// Strong gains, the core's drift-free modifier online, without preview.
    Causal,
    /// Strong gains, the record fitted with half a second of preview.
    Preview,
    /// Strong gains, the record fitted beforehand: the nearest within speed and stroke.
    Fitted,
}

impl Way {
    /// In the order of the story.
    pub(crate) const ALL: [Self; 6] =
        [Self::Current, Self::Strong, Self::Clip, Self::Causal, Self::Preview, Self::Fitted];

    /// Name in tables.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Current => "current gains",
            Self::Strong => "strong gains",
            Self::Clip => "strong, clipped online (Eq. 10)",
            Self::Causal => "strong, modified online, causal",
            Self::Preview => "strong, modified with 0.5 s preview",
            Self::Fitted => "strong, record fitted beforehand",
        }
    }

    /// How the record is fitted before the test.
    fn method(self) -> Option<Method> {
        match self {
            Self::Preview => Some(Method::Preview(0.5)),
            Self::Fitted => Some(Method::Convex(Norm::Two)),
            _ => None,
        }
    }

    /// The core's settings.
    fn settings(self) -> Settings {
        let strong = Named::Strong.settings(super::named::RATE);
        match self {
            Self::Current => Named::Current.settings(super::named::RATE),
            Self::Clip => Settings { modification: Modification::Clip, ..strong },
            Self::Causal => Settings { modification: Modification::Causal, ..strong },
            Self::Strong | Self::Preview | Self::Fitted => strong,
        }
    }
}

/// What one way comes to.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    /// Which way.
    pub way: Way,
    /// The test.
    pub trial: Trial,
    /// Scores of the true motion against the record as it was.
    pub scores: Scores,
    /// Largest displacement of the table, m.
    pub farthest: f64,
    /// Displacement of the table at the end, m.
    pub end: f64,
}

/// Why the story could not be told.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ShowcaseError {
    /// A record could not be fitted.
    #[error("fit: {0}")]
    Fit(#[from] FitError),
    /// A test could not be run.
    #[error(transparent)]
    Trial(#[from] TrialError),
}

/// The stroke that the table's records are fitted to, m: the paper's largest amplitude.
pub(crate) const STROKE: f64 = 0.12;

/// Runs the test one way. The motion should be sampled no finer than needed: fitting takes every sample as a variable.
pub(crate) fn play(motion: &Motion, way: Way, sensors: &SensorModel) -> Result<Entry, ShowcaseError> {
    let table = super::twin::Twin::default();
    let played = match way.method() {
        None => motion.clone(),
        Some(method) => modify(motion, &Limits::table(table.velocity_limit(), STROKE), method, |_| ())?.motion,
    };
    let setup = Setup { settings: way.settings(), table, sensors: sensors.clone(), steps: 10 };
    let original = setup.at_rate(motion)?;
    let trial = setup.play(&played)?.fitted_from(&original);
    let scores = trial.scores(ScoredSignal::Truly, None)?;
    let farthest = trial.trace.displacement.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let end = trial.trace.displacement.last().copied().unwrap_or(0.0);
    Ok(Entry { way, trial, scores, farthest, end })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::condition::Recipe;
    use crate::motion::generate::NEAR_FIELD_MODERATE;

    /// What the paper concludes: on a motion beyond the limit, strong gains spike, and a record fitted to the limit does
    /// not, and tracks better than either.
    #[test]
    fn a_fitted_record_tracks_better_than_any_gain() {
        let motion = Recipe::table1(200.0).apply(&NEAR_FIELD_MODERATE.generate(1).unwrap()).unwrap();
        assert!(motion.peaks().1 > 0.242);
        let play = |way| play(&motion, way, &SensorModel::default()).unwrap();
        let (current, strong, fitted) = (play(Way::Current), play(Way::Strong), play(Way::Fitted));
        let e_a = |entry: &Entry| entry.scores.against_wanted.e_a.ratio;
        assert!(e_a(&fitted) < e_a(&strong) && e_a(&fitted) < e_a(&current));
        assert!(strong.scores.saturated_s > fitted.scores.saturated_s);
        assert!(fitted.farthest < STROKE * 1.05 && fitted.end.abs() < 0.005);
    }
}
