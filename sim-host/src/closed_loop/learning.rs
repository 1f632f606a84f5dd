//! Iterative learning: the same motion again and again, the drive corrected from run to run, each next run's peaks
//! predicted and refused where they are not safe.
//!
//! ```text
//! T(f) = <X conj R> / <R conj R>                         response over drive, smoothed over neighbouring frequencies
//! R' = R + g W(f) c(f) (D - X) / T,   |1 / T| <= 4        W a low-pass; D the motion wanted, as late as the table is
//! c = |<X conj R>|^2 / (<R conj R> <X conj X>)            coherence: what is noise is not learned
//! X' = X + T (R' - R)                                    what the next run is predicted to do
//! ```
//! The share g falls from run to run, g = gain / run, so that noise, which differs from run to run, averages out instead of
//! gathering in the drive. Nothing of a model is used but that the next run will answer as the last did; saturation breaks that, which is why
//! peaks are predicted and held against what the table can do before anything moves.

mod spectrum;
pub mod stale;

use super::trial::{Setup, TrialError, low_passed};
use super::{Clock, ClosedLoopError};
use crate::motion::metrics::{Comparison, compare};
use crate::motion::{Motion, central_difference, peak};
use crate::plant::sensors::Sensors;
use shakedown_core::Controller;
use spectrum::{Spectrum, correction, predicted};

/// What the table may be asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest displacement, m.
    pub displacement: f64,
    /// Largest speed, m/s.
    pub velocity: f64,
    /// Largest acceleration, m/s2.
    pub acceleration: f64,
}

/// Largest displacement (m), speed (m/s) and acceleration (m/s2) of a motion, each within the band that is learned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peaks {
    /// m.
    pub displacement: f64,
    /// m/s.
    pub velocity: f64,
    /// m/s2.
    pub acceleration: f64,
}

/// How learning goes about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Learning {
    /// Share of the error that is corrected after the first run, 1; after the n-th an n-th of it.
    pub gain: f64,
    /// Frequency up to which is learned, Hz.
    pub band: f64,
    /// Runs at most, the first included.
    pub runs: usize,
    /// What the next drive follows from.
    pub update: Update,
    /// How often a correction that is predicted to pass a limit is halved before learning stops.
    pub halvings: usize,
}

/// What the next drive follows from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Update {
    /// The error through the inverse of the response found.
    #[default]
    Inverse,
    /// The error itself, `R' = R + g W (D - X)`: plain iterative learning, to compare with.
    Plain,
}

impl Default for Learning {
    fn default() -> Self {
        Self { gain: 1.0, band: 12.0, runs: 6, update: Update::Inverse, halvings: 4 }
    }
}

/// One run.
#[derive(Debug, Clone)]
pub struct Iteration {
    /// The true motion's peaks, whole band.
    pub reached: Peaks,
    /// The drive, m, one value a tick.
    pub drive: Vec<f64>,
    /// The true motion against the one wanted, both low-passed at 15 Hz.
    pub score: Comparison,
    /// What it was predicted to peak at; none for the first.
    pub predicted: Option<Peaks>,
    /// What the table did, seen by the sensors as the prediction sees it.
    pub peaks: Peaks,
}

/// Why a drive was not run.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "run {run} is not safe: its {what} is predicted to reach {predicted:.3} {unit} of {limit:.3}; learning stops here"
)]
pub struct Refusal {
    /// Which run, from 1.
    pub run: usize,
    /// What would be exceeded.
    pub what: &'static str,
    /// Predicted peak.
    pub predicted: f64,
    /// What is allowed.
    pub limit: f64,
    /// Its unit.
    pub unit: &'static str,
}

/// What came of it.
#[derive(Debug, Clone)]
pub struct Learned {
    /// The runs that were made.
    pub rounds: Vec<Iteration>,
    /// Why there was not another, where a drive was refused.
    pub refused: Option<Refusal>,
}

impl Peaks {
    /// Of displacements (m), one a tick of `dt` (s).
    fn of(displacement: &[f64], dt: f64) -> Self {
        let rate = |x: &[f64]| -> Vec<f64> { x.windows(2).map(|w| (w[1] - w[0]) / dt).collect() };
        let velocity = rate(displacement);
        Self { displacement: peak(displacement), velocity: peak(&velocity), acceleration: peak(&rate(&velocity)) }
    }

    /// The first that is beyond its limit.
    fn beyond(&self, limits: &Limits, run: usize) -> Option<Refusal> {
        let all = [
            ("displacement", self.displacement, limits.displacement, "m"),
            ("velocity", self.velocity, limits.velocity, "m/s"),
            ("acceleration", self.acceleration, limits.acceleration, "m/s2"),
        ];
        let safe = |predicted: f64, limit: f64| predicted <= limit;
        let broken = all.into_iter().find(|&(_, predicted, limit, _)| !safe(predicted, limit));
        broken.map(|(what, predicted, limit, unit)| Refusal { run, what, predicted, limit, unit })
    }
}

/// Learns to make `wanted` (at the control rate) on the twin that `setup` describes; the same controller, the same
/// sensors, new noise in every run.
pub fn learn(setup: &Setup, wanted: &Motion, limits: &Limits, how: &Learning) -> Result<Learned, TrialError> {
    learn_from(None, setup, wanted, limits, how)
}

/// The same from a drive that was learnt before, m, one value a tick; the motion wanted where there is none.
pub fn learn_from(
    begin: Option<Vec<f64>>,
    setup: &Setup,
    wanted: &Motion,
    limits: &Limits,
    how: &Learning,
) -> Result<Learned, TrialError> {
    let mut learned = Learned { rounds: Vec::new(), refused: None };
    let played_before = begin.is_some();
    let mut drive = begin.unwrap_or_else(|| wanted.displacement.clone());
    drive.resize(wanted.len(), drive.last().copied().unwrap_or(0.0));
    let mut forecast: Option<Peaks> = None;
    let mut delay = 0.0;
    // Of the first run nothing is known but that a table that follows does what it is told.
    let told = Peaks::of(&Spectrum::of(&drive).low_passed(how.band, wanted.dt), wanted.dt);
    learned.refused = if played_before { None } else { told.beyond(limits, 1) };
    if learned.refused.is_some() {
        return Ok(learned);
    }
    for run in 1..=how.runs {
        let (truth, seen) = play(setup, &drive, run as u64)?;
        let score = compare(&low_passed(wanted)?, &low_passed(&truth)?, None)?;
        if run == 1 {
            delay = score.e_a.delay;
        }
        let peaks = Peaks::of(&Spectrum::of(&seen).low_passed(how.band, wanted.dt), wanted.dt);
        learned.rounds.push(Iteration {
            drive: drive.clone(),
            score,
            predicted: forecast,
            peaks,
            reached: reached(&truth),
        });
        if run == how.runs {
            break;
        }
        let made = Made { drive: &drive, seen: &seen, delay, run };
        match next(&made, wanted, limits, how) {
            Ok((corrected, expected)) => (drive, forecast) = (corrected, Some(expected)),
            Err(refusal) => {
                learned.refused = Some(refusal);
                break;
            }
        }
    }
    Ok(learned)
}

/// A run that was made, on the twin or on a table.
#[derive(Debug, Clone, Copy)]
pub struct Made<'a> {
    /// Its drive, m, one value a tick.
    pub drive: &'a [f64],
    /// What the table made of it, as its sensor shows it, m.
    pub seen: &'a [f64],
    /// How late the table is, s.
    pub delay: f64,
    /// Which run, from 1.
    pub run: usize,
}

/// The drive of the run after one that was made, and what it is predicted to peak at.
pub fn next(made: &Made<'_>, wanted: &Motion, limits: &Limits, how: &Learning) -> Result<(Vec<f64>, Peaks), Refusal> {
    let (r, x) = (Spectrum::of(made.drive), Spectrum::of(made.seen));
    let d = Spectrum::of(&wanted.displacement).delayed(made.delay, wanted.dt);
    let (mut gain, mut halvings) = (how.gain / made.run as f64, how.halvings);
    // A correction too large for the table is made in smaller steps: the last run was within the limits, and so is a small one.
    loop {
        let mut next = correction(&r, &x, &d, &Learning { gain, ..*how }, wanted.dt);
        settle(&mut next, wanted);
        let expected = Peaks::of(&predicted(&r, &x, &next, how.band, wanted.dt), wanted.dt);
        match expected.beyond(limits, made.run + 1) {
            None => return Ok((next, expected)),
            Some(refusal) if halvings == 0 => return Err(refusal),
            Some(_) => (gain, halvings) = (gain / 2.0, halvings - 1),
        }
    }
}

/// How near a run came to the motion wanted, by its displacement alone (m, one value a tick), both accelerations low-passed at 15 Hz.
pub fn scored(seen: &[f64], wanted: &Motion) -> Result<Comparison, TrialError> {
    let velocity = central_difference(seen, wanted.dt);
    let acceleration = central_difference(&velocity, wanted.dt);
    let made = Motion { dt: wanted.dt, displacement: seen.to_vec(), velocity, acceleration };
    Ok(compare(&low_passed(wanted)?, &low_passed(&made)?, None)?)
}

/// Within so much of either end, s, a drive goes over into the motion wanted, which begins and ends at rest.
const SETTLES: f64 = 1.0;

/// Lets a drive begin and end where the motion wanted does: what was learnt of what is slower than the band has no end of its own.
fn settle(drive: &mut [f64], wanted: &Motion) {
    let (count, last) = (SETTLES / wanted.dt, drive.len().saturating_sub(1));
    for (k, (x, w)) in drive.iter_mut().zip(&wanted.displacement).enumerate() {
        let share = (k.min(last - k) as f64 / count).min(1.0);
        *x = w + share * share * (3.0 - 2.0 * share) * (*x - w);
    }
}

/// The true peaks of a motion.
fn reached(truth: &Motion) -> Peaks {
    let (acceleration, velocity, displacement) =
        (peak(&truth.acceleration), peak(&truth.velocity), peak(&truth.displacement));
    Peaks { displacement, velocity, acceleration }
}

/// Plays a drive (m, one value a tick) on the twin and gives its displacement as the LVDT shows it, m.
pub fn played(setup: &Setup, drive: &[f64], seed: u64) -> Result<Vec<f64>, TrialError> {
    play(setup, drive, seed).map(|(_, seen)| seen)
}

/// One run of the twin: its true motion, and its displacement as the LVDT shows it.
fn play(setup: &Setup, drive: &[f64], seed: u64) -> Result<(Motion, Vec<f64>), TrialError> {
    let clock = Clock::new(setup.rate(), setup.steps).map_err(ClosedLoopError::from)?;
    let start = drive.first().copied().unwrap_or(0.0);
    let mut law = Controller::new(&setup.settings).map_err(ClosedLoopError::from)?;
    let mut sensors = setup.fitted()?;
    sensors.seed = sensors.seed.wrapping_mul(1000).wrapping_add(seed);
    let trace = setup.table.run(&mut law, &mut Sensors::new(sensors), drive, start, clock)?;
    let truth = Motion {
        dt: trace.dt,
        displacement: trace.displacement,
        velocity: trace.velocity,
        acceleration: trace.acceleration,
    };
    Ok((truth, trace.measured_displacement))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_loop::published::Named;
    use crate::motion::condition::Recipe;
    use crate::motion::generate::FAR_FIELD;
    use crate::plant::sensors::SensorModel;

    fn wanted() -> Motion {
        Recipe::table1(1000.0).apply(&FAR_FIELD.generate(1).unwrap()).unwrap()
    }

    const WIDE: Limits = Limits { displacement: 0.12, velocity: 0.24, acceleration: 20.0 };

    /// The gains in use follow a far-field motion poorly; what they miss they miss alike in every run, and so it can be
    /// learned, and each run's peaks are known before it is made.
    #[test]
    fn weak_gains_learn_and_each_run_is_predicted() {
        let mut setup = Setup::paper(Named::Current);
        setup.sensors = SensorModel::laboratory(3);
        let learned = learn(&setup, &wanted(), &WIDE, &Learning::default()).unwrap();
        assert!(learned.refused.is_none(), "{:?}", learned.refused);
        let e_a: Vec<f64> = learned.rounds.iter().map(|r| r.score.e_a.ratio).collect();
        assert!(e_a[5] < 0.25 * e_a[0], "{e_a:?}");
        for round in &learned.rounds[1..] {
            let predicted = round.predicted.unwrap();
            let close = |p: f64, x: f64| (p / x - 1.0).abs() < 0.1;
            assert!(close(predicted.velocity, round.peaks.velocity), "{predicted:?} {:?}", round.peaks);
            assert!(close(predicted.displacement, round.peaks.displacement), "{predicted:?} {:?}", round.peaks);
            // Nothing steps where a drive begins or ends.
            let (drive, wanted) = (&round.drive, wanted().displacement);
            assert_eq!((drive.first(), drive.last()), (wanted.first(), wanted.last()));
        }
    }

    #[test]
    fn a_drive_that_would_pass_a_limit_is_not_run() {
        let setup = Setup::paper(Named::Current);
        let wanted = wanted();
        let free = learn(&setup, &wanted, &WIDE, &Learning::default()).unwrap();
        let found = |r: &Iteration| r.predicted.map_or(0.0, |p| p.velocity);
        let most = free.rounds.iter().map(found).fold(0.0, f64::max);
        // Told no more than the limit, a later drive is expected to pass it.
        let tight = Limits { velocity: 0.999 * most, ..WIDE };
        let at_once = Learning { halvings: 0, ..Learning::default() };
        let held = learn(&setup, &wanted, &tight, &at_once).unwrap();
        let refusal = held.refused.unwrap();
        assert_eq!((refusal.run, refusal.what), (held.rounds.len() + 1, "velocity"));
        assert!(refusal.run > 1 && held.rounds.iter().all(|r| r.peaks.velocity <= 1.02 * tight.velocity), "{refusal}");
        // In smaller steps it goes on, and no step is predicted to pass the limit.
        let slower = learn(&setup, &wanted, &tight, &Learning::default()).unwrap();
        assert!(slower.rounds.len() > held.rounds.len());
        assert!(slower.rounds.iter().filter_map(|r| r.predicted).all(|p| p.velocity <= tight.velocity));
    }

    #[test]
    fn what_asks_for_too_much_is_not_even_begun() {
        let setup = Setup::paper(Named::Current);
        for limits in [Limits { displacement: 1e-3, ..WIDE }, Limits { velocity: f64::NAN, ..WIDE }] {
            let held = learn(&setup, &wanted(), &limits, &Learning::default()).unwrap();
            assert!(held.rounds.is_empty() && held.refused.unwrap().run == 1);
        }
    }
}
