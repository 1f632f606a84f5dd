//! A test of the loop with a ground motion, and what it scores: the rows of Table 1 and the figures of `run`.

use super::published::Named;
use super::twin::Twin;
use super::{Clock, ClosedLoopError, ControlLaw, Trace, pressure_by_settings};
use crate::motion::condition::{Recipe, Step};
use crate::motion::metrics::{Comparison, Indices, Window, compare, indices, intensity};
use crate::motion::resample::Interpolation;
use crate::motion::{Motion, Record};
use crate::plant::sensors::{SensorModel, Sensors};
use shakedown_core::{Controller, Modification, Settings};

/// Everything of a test but its motion.
#[derive(Debug, Clone)]
pub struct Setup {
    /// The control core's settings; their rate is the control rate.
    pub settings: Settings,
    /// The table.
    pub table: Twin,
    /// The sensors.
    pub sensors: SensorModel,
    /// Plant steps in a tick, an even number.
    pub steps: usize,
}

impl Setup {
    /// A controller of Table 1 on the paper's plant at 1 kHz, sensors off, 10 plant steps a tick.
    pub fn paper(named: Named) -> Self {
        let (table, sensors) = (Twin::default(), SensorModel::default());
        Self { settings: named.settings(1000.0), table, sensors, steps: 10 }
    }

    /// Control rate, Hz.
    pub fn rate(&self) -> f64 {
        f64::from(self.settings.rate)
    }

    /// The same motion at the control rate: acceleration is linear between samples, so nothing changes between them.
    pub fn at_rate(&self, motion: &Motion) -> Result<Motion, TrialError> {
        Ok(Step::Resample { rate_hz: self.rate(), between: Interpolation::Linear }.apply(motion.clone())?)
    }

    /// Plays a motion; it is brought to the control rate first, linear in acceleration between samples.
    pub fn play(&self, motion: &Motion) -> Result<Trial, TrialError> {
        self.play_with(&mut Controller::new(&self.settings).map_err(ClosedLoopError::from)?, motion)
    }

    /// The same with another law at the settings' rate.
    pub fn play_with(&self, law: &mut impl ControlLaw, motion: &Motion) -> Result<Trial, TrialError> {
        let lag = self.lag();
        let (wanted, played) = {
            let motion = self.at_rate(motion)?;
            (late(&motion, lag, 0), late(&motion, 0, lag))
        };
        let clock = Clock::new(self.rate(), self.steps).map_err(ClosedLoopError::from)?;
        let start = played.displacement.first().copied().unwrap_or(0.0);
        let mut sensors = Sensors::new(self.fitted()?);
        let trace = self.table.run(law, &mut sensors, &played.displacement, start, clock)?;
        if let Some(tick) = trace.first_without_number() {
            return Err(TrialError::NotFinite { time: tick as f64 * trace.dt });
        }
        Ok(Trial { wanted, played, lag, trace })
    }

    /// The sensors with the piston area that the law's pressure damping is set for, where they do not state one themselves.
    pub(super) fn fitted(&self) -> Result<SensorModel, ClosedLoopError> {
        let fitted = pressure_by_settings(&self.sensors, &self.settings);
        let limited = self.settings.guard.is_some_and(|guard| guard.envelope.force.is_some());
        if limited && fitted.area_per_mass.is_none() { Err(ClosedLoopError::AreaPerMass) } else { Ok(fitted) }
    }

    /// By how many ticks the core answers the reference late: what its modifier looks ahead.
    fn lag(&self) -> usize {
        match self.settings.modification {
            Modification::Preview { seconds } => (seconds * self.settings.rate).round() as usize,
            _ => 0,
        }
    }
}

/// Why a test could not be run or scored.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrialError {
    /// The loop could not be set up.
    #[error(transparent)]
    Loop(#[from] ClosedLoopError),
    /// The motion could not be brought to the control rate.
    #[error("motion: {0}")]
    Condition(#[from] crate::motion::condition::ConditionError),
    /// The motion could not be fitted to the table.
    #[error("fit: {0}")]
    Fit(#[from] crate::motion::fit::FitError),
    /// The test left the numbers.
    #[error(
        "the table's motion is no number from {time:.3} s on: what the settings, the table or the sensors state is out of all proportion"
    )]
    NotFinite {
        /// From when on, s.
        time: f64,
    },
    /// A signal could not be filtered.
    #[error("response: {0}")]
    Filter(#[from] crate::motion::filter::FilterError),
    /// The response has no spectrum.
    #[error("response: {0}")]
    Spectrum(#[from] crate::motion::spectrum::SpectrumError),
    /// The response could not be compared.
    #[error("response: {0}")]
    Compare(#[from] crate::motion::metrics::CompareError),
}

/// A test that was run.
#[derive(Debug, Clone)]
pub struct Trial {
    /// What the table was asked for, at the control rate, before any fit and any modification.
    pub wanted: Motion,
    /// What was played to the core, at the control rate: the same, unless it was fitted beforehand; where the core
    /// looks ahead, what is wanted is this so much later, and both rest for as long.
    pub played: Motion,
    /// How many ticks later.
    lag: usize,
    /// What it did.
    pub trace: Trace,
}

/// What a test scores. Accelerations are low-passed at 15 Hz on both sides of every comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scores {
    /// The response against what was asked for.
    pub against_wanted: Comparison,
    /// The response against what was commanded after modification.
    pub against_commanded: Comparison,
    /// Time at the velocity limit, s.
    pub saturated_s: f64,
}

/// Which response is scored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScoredSignal {
    /// The true motion.
    Truly,
    /// The motion as the sensors gave it.
    BySensors,
}

impl Trial {
    /// Scores the test over the whole record or over a window of it.
    pub fn scores(&self, seen: ScoredSignal, window: Option<Window>) -> Result<Scores, TrialError> {
        let response = self.response(seen)?;
        let within = |k: usize| {
            let t = k as f64 * self.trace.dt;
            window.is_none_or(|w| t >= w.from_s && t <= w.to_s)
        };
        let saturated = self.trace.flags.iter().enumerate().filter(|(k, f)| f.saturated && within(*k)).count();
        Ok(Scores {
            against_wanted: compare(&low_passed(&self.wanted)?, &response, window)?,
            against_commanded: compare(&low_passed(&self.commanded())?, &response, window)?,
            saturated_s: saturated as f64 * self.trace.dt,
        })
    }

    /// The response, its acceleration low-passed.
    pub fn response(&self, seen: ScoredSignal) -> Result<Motion, TrialError> {
        let trace = &self.trace;
        let (displacement, acceleration) = match seen {
            ScoredSignal::Truly => (&trace.displacement, &trace.acceleration),
            ScoredSignal::BySensors => (&trace.measured_displacement, &trace.measured_acceleration),
        };
        low_passed(&Motion {
            dt: trace.dt,
            displacement: displacement.clone(),
            velocity: trace.velocity.clone(),
            acceleration: acceleration.clone(),
        })
    }

    /// What was wanted, its acceleration low-passed as the response's is.
    pub fn wanted_response(&self) -> Result<Motion, TrialError> {
        low_passed(&self.wanted)
    }

    /// The laboratory's indices of the response, accelerations low-passed on both sides.
    pub fn indices(&self, seen: ScoredSignal) -> Result<Indices, TrialError> {
        let (wanted, response) = (self.wanted_response()?, self.response(seen)?);
        Ok(indices(&wanted.acceleration, &response.acceleration, wanted.dt)?)
    }

    /// The same test scored against `original`, of which what was played is a fit. A fit of another length (time run
    /// faster) has nothing to be held against sample by sample, and stays as it is.
    #[must_use]
    pub fn fitted_from(mut self, original: &Motion) -> Self {
        if original.dt == self.played.dt && original.len() + self.lag == self.played.len() {
            self.wanted = late(original, self.lag, 0);
        }
        self
    }

    /// The reference after modification; where nothing modified it, what was played, so that the core's `f32` adds no
    /// noise to its acceleration.
    pub fn commanded(&self) -> Motion {
        let trace = &self.trace;
        let changed = |(a, b): (&f64, &f64)| (a - b).abs() > 1e-6;
        if !trace.commanded.iter().zip(&trace.reference).any(changed) {
            return self.played.clone();
        }
        let rates = |x: &[f64]| -> Vec<f64> {
            let before = [x.first().copied().unwrap_or(0.0)];
            before.iter().chain(x).zip(x).map(|(a, b)| (b - a) / trace.dt).collect()
        };
        let velocity = rates(&trace.commanded);
        let acceleration = rates(&velocity);
        Motion { dt: trace.dt, displacement: trace.commanded.clone(), velocity, acceleration }
    }
}

/// The motion after resting where it begins for `before` samples, and where it ends for `after`.
fn late(motion: &Motion, before: usize, after: usize) -> Motion {
    let held = |signal: &[f64], first: f64, last: f64| {
        let rest = |value: f64, count: usize| std::iter::repeat_n(value, count);
        rest(first, before).chain(signal.iter().copied()).chain(rest(last, after)).collect()
    };
    let x = &motion.displacement;
    let (first, last) = (x.first().copied().unwrap_or(0.0), x.last().copied().unwrap_or(0.0));
    Motion {
        dt: motion.dt,
        displacement: held(x, first, last),
        velocity: held(&motion.velocity, 0.0, 0.0),
        acceleration: held(&motion.acceleration, 0.0, 0.0),
    }
}

/// The motion with its acceleration through the 15 Hz low-pass that Table 1 applies.
pub(super) fn low_passed(motion: &Motion) -> Result<Motion, TrialError> {
    use crate::motion::filter::Pass;
    let acceleration = Recipe::table1_response().apply(&motion.acceleration, motion.dt, Pass::ZeroPhase)?;
    Ok(Motion { acceleration, ..motion.clone() })
}

/// The strong and the weak stretch of a motion, as the paper takes them: its Kobe is strong from 1 to 5 s and weak from
/// 5 to 16 s. Records here start elsewhere, so the paper's second 1 is put where 5 % of the Arias intensity has passed.
pub(crate) fn strong_and_weak(motion: &Motion) -> (Window, Window) {
    let onset = intensity(&motion.acceleration, motion.dt).start;
    let window = |from: f64, to: f64| Window { from_s: onset - 1.0 + from, to_s: onset - 1.0 + to };
    (window(1.0, 5.0), window(5.0, 16.0))
}

/// Conditions a record as Table 1 needs it and plays it.
pub(crate) fn table1_motion(record: &Record, rate: f64) -> Result<Motion, TrialError> {
    Ok(Recipe::table1(rate).apply(record)?)
}
