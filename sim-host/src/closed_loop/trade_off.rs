//! The gain trade-off of Fig. 11, which the paper draws as a sketch: with the gain, tracking improves where the record is
//! weak, and the velocity limit costs more where it is strong.

use super::named;
use super::published::PublishedGains;
use super::trial::{ScoredSignal, Setup, TrialError, strong_and_weak};
use super::twin::Twin;
use crate::motion::Motion;
use crate::plant::sensors::SensorModel;
use rayon::prelude::*;

/// What one gain costs and brings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    /// Proportional gain, 1.
    pub gain: f64,
    /// Acceleration error (ratio of norms) over the weak stretch.
    pub weak_e_a: f64,
    /// Acceleration error (ratio of norms) over the strong stretch.
    pub strong_e_a: f64,
    /// Peak acceleration of the table over the reference's, on the strong stretch.
    pub spike_ratio: f64,
    /// Time at the velocity limit over the whole record, s.
    pub saturated_s: f64,
}

/// Gains between the paper's unity and twice its strong ones.
pub(crate) const GAINS: [f64; 12] = [1.0, 1.5, 2.0, 3.0, 3.7, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0];

/// Plays `motion` at every gain, Ki = Kp / 10 as in the paper's strong gains, over all cores.
pub(crate) fn trade_off(motion: &Motion, done: impl Fn() + Sync) -> Result<Vec<Point>, TrialError> {
    let (strong, weak) = strong_and_weak(motion);
    let point = |&gain: &f64| {
        let gains =
            PublishedGains { displacement: (gain, gain / 10.0), acceleration: (0.0, 0.0), velocity: (0.0, 0.0) };
        let (table, sensors) = (Twin::default(), SensorModel::default());
        let setup = Setup { settings: named::settings(gains, 1000.0), table, sensors, steps: 10 };
        let trial = setup.play(motion)?;
        let scores = |window| trial.scores(ScoredSignal::Truly, Some(window)).map(|s| s.against_wanted);
        let (strong, weak) = (scores(strong)?, scores(weak)?);
        done();
        Ok(Point {
            gain,
            weak_e_a: weak.e_a.ratio,
            strong_e_a: strong.e_a.ratio,
            spike_ratio: strong.spike_ratio(),
            saturated_s: trial.trace.saturated_s(),
        })
    };
    GAINS.par_iter().map(point).collect()
}
