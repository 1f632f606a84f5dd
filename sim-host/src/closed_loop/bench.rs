//! The public benchmark: records by tables by controllers, all by one rule.
//!
//! Every record is fitted beforehand to what the table can do, and every controller is given the same fitted record: what
//! is judged is tracking, not fitting. Every controller that can be tuned is tuned by the margins of its loop on the
//! table's linear model, none on a record. `E_a` is that of Eq. 11, unsquared, of the true motion: with ideal sensors as
//! it is, and with the table's sensors low-passed at 15 Hz like the record.

pub(crate) mod figures;
pub(crate) mod rivals;
pub(crate) mod score;
pub(crate) mod tables;
mod yielding;

pub(crate) use score::{Quartiles, Score};
pub(crate) use tables::{Bench, TABLES};

use super::design::{Corner, Demand, DesignError, design};
use super::margin::margins;
use super::published::Named;
use super::trial::TrialError;
use super::{Clock, ClosedLoopError, ControlLaw, run};
use crate::motion::condition::{Recipe, Step};
use crate::motion::fit::method::{Method, modify};
use crate::motion::fit::{FitError, Limits, Norm};
use crate::motion::resample::Interpolation;
use crate::motion::{Motion, Record};
use crate::plant::sensors::{SensorModel, Sensors};
use rayon::prelude::*;
use rivals::{Adrc, Lqi, OBSERVER_RATIOS, ThreeVariable, VELOCITY_GAINS};
use shakedown_core::{Controller, Settings};

/// Control rate, Hz.
pub(crate) const RATE: f64 = 1000.0;
/// Plant steps in a tick.
const STEPS: usize = 2;
/// Stroke that records are fitted to, m.
const STROKE: f64 = 0.12;

/// Why the benchmark could not be run.
#[derive(Debug, thiserror::Error)]
pub(crate) enum BenchError {
    /// A record could not be fitted.
    #[error("fit: {0}")]
    Fit(#[from] FitError),
    /// A design was refused.
    #[error("design: {0}")]
    Design(#[from] DesignError),
    /// A test could not be run or scored.
    #[error(transparent)]
    Trial(#[from] TrialError),
}

impl From<ClosedLoopError> for BenchError {
    fn from(error: ClosedLoopError) -> Self {
        Self::Trial(error.into())
    }
}

/// Who controls.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Contender {
    /// A row of the paper's Table 1, with its gains.
    Paper(Named),
    /// Three-variable control with velocity, acceleration and jerk feedforward, as sold today.
    ThreeVariable,
    /// Linear-quadratic regulator of the model's states with an integrator.
    Lqi,
    /// Active disturbance rejection: linear extended-state observer of second order.
    Adrc,
    /// The tracking law of the core, as `design` sets it.
    Tracking,
}

impl Contender {
    /// Everyone, in the order of the tables.
    pub(crate) fn all() -> Vec<Self> {
        let paper = Named::ALL.into_iter().map(Self::Paper);
        paper.chain([Self::ThreeVariable, Self::Lqi, Self::Adrc, Self::Tracking]).collect()
    }

    /// Name in tables.
    pub(crate) fn title(self) -> String {
        match self {
            Self::Paper(named) => format!("paper: {}", named.title()),
            Self::ThreeVariable => "three-variable, feedforward".into(),
            Self::Lqi => "LQI".into(),
            Self::Adrc => "ADRC".into(),
            Self::Tracking => "tracking (this project)".into(),
        }
    }
}

/// A record, conditioned.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    /// Its name.
    pub name: String,
    /// The motion at 200 Hz.
    pub motion: Motion,
}

impl Case {
    /// Conditions `record` as fits are measured ([`Recipe::fitting`]), scaled to `peak` (m/s2) first where given.
    pub(crate) fn new(name: &str, record: &Record, peak: Option<f64>) -> Result<Self, TrialError> {
        Ok(Self { name: name.into(), motion: Recipe::fitting(peak).apply(record)? })
    }

    /// The motion at the control rate.
    pub(crate) fn at_rate(&self) -> Result<Motion, TrialError> {
        at_rate(&self.motion)
    }

    /// Fitted to `velocity` (m/s) and the stroke, the nearest by the waveform, at the control rate.
    pub(crate) fn fitted(&self, velocity: f64) -> Result<Motion, BenchError> {
        let limits = Limits::table(velocity, STROKE);
        let fitted = modify(&self.motion, &limits, Method::Convex(Norm::Two), |_| ())?.motion;
        Ok(at_rate(&fitted)?)
    }
}

fn at_rate(motion: &Motion) -> Result<Motion, TrialError> {
    Ok(Step::Resample { rate_hz: RATE, between: Interpolation::Linear }.apply(motion.clone())?)
}

/// A controller tuned for a table, ready to be started.
#[derive(Debug, Clone)]
pub(crate) enum Tuned {
    /// On the core.
    Core(Box<Settings>),
    /// Three-variable.
    ThreeVariable(ThreeVariable),
    /// LQI.
    Lqi(Box<Lqi>),
    /// ADRC.
    Adrc(Adrc),
}

/// Margins that every tunable contender keeps on the table's linear model, dB and degrees.
pub(crate) const KEPT: (f64, f64) = (6.0, 30.0);
/// Bandwidths that a tunable contender may be given, Hz, from the widest.
const BANDWIDTHS: [f64; 12] = [40.0, 30.0, 24.0, 18.0, 14.0, 11.0, 8.0, 6.0, 4.5, 3.0, 2.0, 1.0];

impl Tuned {
    /// Starts it at rest at centre.
    pub(crate) fn start(&self) -> Result<Box<dyn ControlLaw>, ClosedLoopError> {
        Ok(match self {
            Self::Core(settings) => Box::new(Controller::new(settings)?),
            Self::ThreeVariable(law) => Box::new(law.clone()),
            Self::Lqi(law) => Box::new(law.as_ref().clone()),
            Self::Adrc(law) => Box::new(law.clone()),
        })
    }
}

impl ControlLaw for Box<dyn ControlLaw> {
    fn step(&mut self, measured: &super::Measured) -> super::Actuation {
        self.as_mut().step(measured)
    }
}

/// Largest root mean square of the table's acceleration at rest, shaken by its sensors' noise, that a tunable contender may
/// have, m/s2: about what the tracking law has on the paper's table.
pub(crate) const QUIET: f64 = 0.5;
/// How long it is watched at rest, s.
const AT_REST: f64 = 3.0;

/// Root mean square of the acceleration (m/s2) that the sensors' noise shakes the table with at rest.
fn shakes(bench: &Bench, tuned: &Tuned) -> Result<f64, BenchError> {
    let rest = Motion::from_acceleration(1.0 / RATE, vec![0.0; (AT_REST * RATE) as usize]);
    let trace = play(bench, &Corner::default(), &mut tuned.start()?, &rest, bench.sensors.clone())?;
    let sum: f64 = trace.acceleration.iter().map(|a| a * a).sum();
    Ok((sum / trace.acceleration.len() as f64).sqrt())
}

/// Tunes `contender` for `bench`: the paper's keep their gains, the core's is designed. A rival gets the widest bandwidth at
/// which any setting of its second number keeps [`KEPT`] and is no louder at rest than [`QUIET`], and of those settings the one
/// that leaves least of what acts on the table ([`super::margin::Margins::left`]).
pub(crate) fn tune(contender: Contender, bench: &Bench) -> Result<Tuned, BenchError> {
    let table = &bench.table;
    let widest = |seconds: &[f64], make: &dyn Fn((f64, f64)) -> Tuned| -> Result<Tuned, BenchError> {
        for bandwidth in BANDWIDTHS {
            let mut best: Option<(f64, Tuned)> = None;
            for &second in seconds {
                let tuned = make((bandwidth, second));
                let clock = Clock::new(RATE, STEPS).map_err(ClosedLoopError::from)?;
                let mut plant = table.linear(&Corner::default(), clock.plant_step()).map_err(DesignError::from)?;
                let kept = margins(&mut plant, &mut tuned.start()?, clock).filter(|m| m.reach(KEPT));
                let Some(kept) = kept.filter(|m| best.as_ref().is_none_or(|(left, _)| m.left < *left)) else {
                    continue;
                };
                if shakes(bench, &tuned)? <= QUIET {
                    best = Some((kept.left, tuned));
                }
            }
            if let Some((_, tuned)) = best {
                return Ok(tuned);
            }
        }
        Ok(make((BANDWIDTHS[BANDWIDTHS.len() - 1], seconds[0])))
    };
    match contender {
        Contender::Paper(named) => Ok(Tuned::Core(Box::new(named.settings(RATE)))),
        Contender::ThreeVariable => {
            widest(&VELOCITY_GAINS, &|numbers| Tuned::ThreeVariable(ThreeVariable::new(table, numbers, RATE)))
        }
        Contender::Lqi => widest(&[1.0], &|(hz, _)| Tuned::Lqi(Box::new(Lqi::new(table, hz, RATE)))),
        Contender::Adrc => widest(&OBSERVER_RATIOS, &|numbers| Tuned::Adrc(Adrc::new(table, numbers, RATE))),
        Contender::Tracking => {
            let demand = Demand { margins: KEPT, rate: RATE, ..Demand::default() };
            Ok(Tuned::Core(Box::new(design(table, &demand, |_, _| ())?.settings)))
        }
    }
}

/// Plays `wanted` (at the control rate) with `law` on the table at `corner`.
pub(crate) fn play(
    bench: &Bench,
    corner: &Corner,
    law: &mut impl ControlLaw,
    wanted: &Motion,
    sensors: SensorModel,
) -> Result<super::Trace, BenchError> {
    let clock = Clock::new(RATE, STEPS).map_err(ClosedLoopError::from)?;
    let mut plant = bench.plant(corner, clock.plant_step())?;
    Ok(run(&mut plant, law, &mut Sensors::new(sensors), &wanted.displacement, clock))
}

/// One row: a controller on a table.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    /// Which table.
    pub table: &'static str,
    /// Who.
    pub contender: Contender,
    /// One a record, in the order given.
    pub scores: Vec<Score>,
}

/// Runs every contender on every table along every record, over all cores; `done` is called after each row.
pub(crate) fn rows(cases: &[Case], benches: &[Bench], done: impl Fn() + Sync) -> Result<Vec<Row>, BenchError> {
    let mut rows = Vec::new();
    for bench in benches {
        let fitted: Vec<Motion> =
            cases.par_iter().map(|case| case.fitted(bench.usable)).collect::<Result<_, BenchError>>()?;
        let row = |contender: Contender| {
            let tuned = tune(contender, bench)?;
            let one = |wanted: &Motion| {
                let ideal = play(bench, &Corner::default(), &mut tuned.start()?, wanted, SensorModel::default())?;
                let sensed = play(bench, &Corner::default(), &mut tuned.start()?, wanted, bench.sensors.clone())?;
                Ok(Score::new(wanted, &ideal, &sensed)?)
            };
            let scores = fitted.par_iter().map(one).collect::<Result<Vec<Score>, BenchError>>()?;
            done();
            Ok(Row { table: bench.name, contender, scores })
        };
        let of_table: Result<Vec<Row>, BenchError> = Contender::all().into_par_iter().map(row).collect();
        rows.extend(of_table?);
    }
    Ok(rows)
}
