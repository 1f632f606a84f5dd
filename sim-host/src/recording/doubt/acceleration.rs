//! Slow drift of the accelerometer against the motion that displacement shows.
//!
//! Over a second or more the mean acceleration of a table that stays within its stroke is next to nothing, and what there is
//! the displacement shows. Means of both under a smooth window are compared: their difference is the sensor's. A constant is
//! left to the models, as a bias; what follows displacement is tilt; what settles from nothing at the start of a run is drift.
//! Where the measured motion drives the model no model has a bias: a constant beyond doubt is taken off there.
//! The window is von Hann's: by parts its mean of a second difference is a mean of the displacement itself, whose noise is not
//! differentiated.

use super::{Doubt, SetUpFinding};
use crate::recording::channel::Channel;
use crate::recording::experiment::Experiment;
use crate::recording::model::Baseline;
use crate::recording::noise;
use crate::recording::run::Run;
use crate::recording::signal::{curvature, filled};
use nalgebra::{DMatrix, DVector};

/// Windows that means are taken under, each overlapping the next by half.
const WINDOWS: usize = 24;
/// Standard errors beyond which a rise is a drift.
const CERTAIN: f64 = 6.0;
/// Drift, in standard deviations of the noise, below which it is left alone.
const LEAST: f64 = 0.03;
/// Time constants with which a sensor may settle, in durations of the run; the last is a straight line.
const SETTLES: [f64; 7] = [0.1, 0.2, 0.4, 0.7, 1.2, 2.5, 1e3];
/// Standard errors by which windows that overlap by half scatter less than ones that do not.
const OVERLAP: f64 = 1.2;

/// Offset, in standard deviations of the noise, below which it is left alone.
const LEAST_OFFSET: f64 = 0.1;

/// How a sensor drifts over a run.
struct Drift {
    /// What it reaches at the end of the run, m/s2, and its standard error.
    size: f64,
    std: f64,
    /// Time constant, in durations of the run.
    settles: f64,
}

/// Finds the drift of each run and takes it off.
pub(super) fn doubt(experiment: &mut Experiment) -> Vec<SetUpFinding> {
    let all = experiment.runs.clone();
    let balance = matches!(experiment.model.baseline, Baseline::ForceBalance(_));
    let mut findings = Vec::new();
    for run in &mut experiment.runs {
        let noise = noise::floors(run, &all).get(Channel::Acceleration).map_or(0.0, |floor| floor.std);
        let Some(means) = Means::of(run) else { continue };
        let Some(drift) = means.drift().filter(|drift| drift.size.abs() > LEAST * noise) else {
            let offset = means.offset().filter(|offset| balance && offset.first.abs() > LEAST_OFFSET * noise);
            findings.extend(offset.map(|offset| without_offset(run, &offset)));
            continue;
        };
        let n = run.len();
        if let Some(a) = run.channel(Channel::Acceleration) {
            let without = |(k, a): (usize, &f64)| a - drift.size * settled(k as f64 / n as f64, drift.settles);
            let without = a.iter().enumerate().map(without).collect();
            run.channels.set(Channel::Acceleration, without);
        }
        let finding = SetUpFinding::new(Doubt::Drift, drift.size, "m/s2").against(0.0).within(drift.std);
        findings.push(finding.of_run(&run.name).of_channel(Channel::Acceleration));
    }
    findings
}

/// Share of its end value that a drift has reached at a share of the run.
fn settled(at: f64, constant: f64) -> f64 {
    (-at / constant).exp_m1() / (-1.0 / constant).exp_m1()
}

/// Takes the offset off.
fn without_offset(run: &mut Run, offset: &Fitted) -> SetUpFinding {
    if let Some(a) = run.channel(Channel::Acceleration) {
        let without = a.iter().map(|a| a - offset.first).collect();
        run.channels.set(Channel::Acceleration, without);
    }
    let finding = SetUpFinding::new(Doubt::Offset, offset.first, "m/s2").against(0.0).within(offset.std);
    finding.of_run(&run.name).of_channel(Channel::Acceleration)
}

/// What acceleration and displacement show apart, as means under windows.
struct Means {
    /// Acceleration less the displacement's second derivative, m/s2.
    difference: DVector<f64>,
    /// Displacement about its mean, of length one: what tilt follows; none of a table at rest.
    place: Option<DVector<f64>>,
    /// Middles of the windows, in durations of the run.
    at: Vec<f64>,
}

impl Means {
    fn of(run: &Run) -> Option<Self> {
        let (x, a) = (run.channel(Channel::Displacement)?, run.channel(Channel::Acceleration)?);
        let length = 2 * run.len() / (WINDOWS + 1);
        if length < 32 {
            return None;
        }
        let (x, a) = (filled(x), filled(a));
        let kinematic = curvature(&x, run.dt);
        let weights: Vec<f64> =
            (0..length).map(|j| 1.0 - (std::f64::consts::TAU * (j as f64 + 0.5) / length as f64).cos()).collect();
        let mean = |series: &[f64], i: usize| {
            let own = &series[i * length / 2..];
            own.iter().zip(&weights).map(|(x, w)| x * w).sum::<f64>() / length as f64
        };
        let about = x.iter().sum::<f64>() / x.len() as f64;
        let difference = DVector::from_fn(WINDOWS, |i, _| mean(&a, i) - mean(&kinematic, i));
        let place = DVector::from_fn(WINDOWS, |i, _| mean(&x, i) - about);
        let place = Some(place.norm()).filter(|norm| *norm > 0.0).map(|norm| place / norm);
        let at = |i: usize| (i + 1) as f64 * 0.5 * length as f64 / run.len() as f64;
        Some(Self { difference, place, at: (0..WINDOWS).map(at).collect() })
    }

    /// A constant beside what follows displacement.
    fn constant(&self) -> Option<Fitted> {
        fitted(&self.difference, &[Some(&DVector::from_element(WINDOWS, 1.0)), self.place.as_ref()])
    }

    /// The constant where it is beyond doubt.
    fn offset(&self) -> Option<Fitted> {
        self.constant().filter(|constant| constant.first.abs() > CERTAIN * constant.std)
    }

    /// The drift that displacement does not show, where the differences rise for certain and no constant is as good.
    fn drift(&self) -> Option<Drift> {
        let (one, place) = (DVector::from_element(WINDOWS, 1.0), self.place.as_ref());
        let constant = self.constant()?;
        let drifts = SETTLES.iter().filter_map(|&settles| {
            let course = DVector::from_fn(WINDOWS, |i, _| settled(self.at[i], settles));
            let alone = fitted(&self.difference, &[Some(&course), place])?;
            let beside = fitted(&self.difference, &[Some(&course), Some(&one), place])?;
            Some((settles, alone, beside))
        });
        let (settles, alone, beside) = drifts.min_by(|a, b| a.2.left.total_cmp(&b.2.left))?;
        let rises = beside.first.abs() > CERTAIN * beside.std;
        // A zero that is off from the start and nothing more is a bias: a drift that begins at nothing must be far better.
        let noise = beside.left / WINDOWS as f64;
        let better = (constant.left - alone.left) > CERTAIN * CERTAIN * OVERLAP * noise;
        let begins_at_nothing = better && alone.left - beside.left < CERTAIN * noise;
        let found = if begins_at_nothing { alone } else { Some(beside).filter(|_| rises)? };
        Some(Drift { size: found.first, std: found.std, settles })
    }
}

/// A least-squares fit: the first coefficient, its standard error, and the squares left.
struct Fitted {
    first: f64,
    std: f64,
    left: f64,
}

fn fitted(series: &DVector<f64>, columns: &[Option<&DVector<f64>>]) -> Option<Fitted> {
    let columns: Vec<DVector<f64>> = columns.iter().flatten().map(|c| (*c).clone()).collect();
    let matrix = DMatrix::from_columns(&columns);
    let inverse = matrix.tr_mul(&matrix).try_inverse()?;
    let found = &inverse * matrix.tr_mul(series);
    let left = (series - &matrix * &found).norm_squared();
    let std = OVERLAP * (left * inverse[(0, 0)] / (series.len() - columns.len()) as f64).sqrt();
    Some(Fitted { first: found[0], std, left })
}
