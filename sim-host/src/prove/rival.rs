//! What else one might do with a residual, examined beside the diagnosis: refit the baseline and look at chi2; pick terms
//! by BIC as if the noise were white; regress the residual sparsely. All see the experiment as it is handed over.

use super::record::{Named, Record, Reply};
use shakedown_truth::baseline::{Prediction, predict};
use shakedown_truth::closed_loop::{Run, Traces};
use shakedown_truth::refit::{Refit, Sigma, chi2, least_squares, refit};
use shakedown_truth::sheet::Sheets;
use shakedown_truth::strength::paired;

/// The methods, in the order of their replies.
pub const NAMES: [&str; 3] = ["linear refit", "white-noise BIC", "sparse regression"];

/// The verdicts of all three; none where the experiment cannot be read as numbers on an even grid.
pub fn replies(experiment: &Sheets) -> Option<[Reply; 3]> {
    let data = Data::read(experiment)?;
    let n = data.runs.len() - 1;
    let fit = refit(experiment.machine, &experiment.fit, &paired(&data.runs[..n], &data.traces[..n]), &data.sigma);
    let left = chi2(&fit, &paired(&data.runs[n..], &data.traces[n..]), &data.sigma);
    let (terms, residual) = data.terms(&fit, n);
    let reply = |names: Vec<&str>| {
        let verdict = if left > FLAGGED || !names.is_empty() { "mismatch" } else { "consistent" };
        let effects = names.iter().map(|id| Named { id: (*id).into(), ..Named::default() }).collect();
        Reply { verdict: verdict.into(), effects, ..Reply::default() }
    };
    Some([reply(Vec::new()), reply(by_bic(&terms, &residual)), reply(sparsely(&terms, &residual))])
}

/// Held-out chi2 above which the refitted baseline counts as refuted.
const FLAGGED: f64 = 1.08;

/// The record as if a rival had replied.
pub fn in_place(record: &Record, reply: &Reply) -> Record {
    Record { reply: reply.clone(), attainable: None, ..record.clone() }
}

/// Effects that the regressions have a term for.
const TERMS: [&str; 13] = [
    "acceleration_bias",
    "acceleration_gain",
    "acceleration_lag",
    "tilt_coupling",
    "displacement_nonlinearity",
    "coulomb_friction",
    "stribeck_friction",
    "viscous_friction",
    "command_delay",
    "valve_lag",
    "gain_drift",
    "flow_softening",
    "mains_hum",
];

struct Data {
    runs: Vec<Run>,
    traces: Vec<Traces>,
    sigma: Sigma,
}

fn si(unit: &str) -> f64 {
    match unit {
        "mm" => 1e-3,
        "g" => crate::scalar::GRAVITY,
        _ => 1.0,
    }
}

impl Data {
    fn read(experiment: &Sheets) -> Option<Self> {
        let place = |channel: &str| experiment.columns.iter().position(|c| c.channel == channel);
        let column = |values: &[Vec<f64>], channel: &str| -> Option<Vec<f64>> {
            let i = place(channel)?;
            let factor = si(experiment.columns[i].unit);
            Some(values[i].iter().map(|v| v * factor).collect())
        };
        let (mut runs, mut traces) = (Vec::new(), Vec::new());
        for (number, sheet) in experiment.sheets.iter().enumerate() {
            let time = column(&sheet.values, "time")?;
            let dt = (time.last()? - time.first()?) / (time.len() - 1) as f64;
            let reference = column(&sheet.values, "reference")?;
            runs.push(Run { reference, dt, controller: sheet.controller, number: number as u64 });
            traces.push(Traces {
                displacement: column(&sheet.values, "displacement")?,
                acceleration: column(&sheet.values, "acceleration").unwrap_or_default(),
                ..Traces::default()
            });
        }
        let noise = |channel: &str| place(channel).and_then(|i| experiment.columns[i].noise);
        let sigma = Sigma { displacement: noise("displacement")?, acceleration: noise("acceleration") };
        Some(Self { runs, traces, sigma })
    }

    /// Terms and residual over the runs to fit, stacked; every value over the noise of its channel.
    fn terms(&self, fit: &Refit, n: usize) -> (Vec<Vec<f64>>, Vec<f64>) {
        let mut terms = vec![Vec::new(); TERMS.len()];
        let mut residual = Vec::new();
        for (run, traces) in self.runs[..n].iter().zip(&self.traces) {
            let model = predict(&fit.machine, run);
            let (measured, predicted, sigma) = match self.sigma.acceleration {
                Some(sigma) => (&traces.acceleration, &model.acceleration, sigma),
                None => (&traces.displacement, &model.displacement, self.sigma.displacement),
            };
            residual.extend(measured.iter().zip(predicted).map(|(y, m)| (y - m) / sigma));
            for (all, own) in terms.iter_mut().zip(signals(&model, run.dt)) {
                all.extend(own);
            }
        }
        (terms, residual)
    }
}

/// One signal a term, along the predicted motion.
fn signals(model: &Prediction, dt: f64) -> Vec<Vec<f64>> {
    let n = model.displacement.len();
    let slope = |x: &[f64]| -> Vec<f64> {
        (0..n).map(|k| (x[(k + 1).min(n - 1)] - x[k.saturating_sub(1)]) / (2.0 * dt)).collect()
    };
    let v = slope(&model.displacement);
    let jerk = slope(&model.acceleration);
    let rate = slope(&model.command);
    let fastest = v.iter().fold(1e-9_f64, |m, v| m.max(v.abs()));
    let of = |f: &dyn Fn(usize) -> f64| (0..n).map(f).collect::<Vec<f64>>();
    vec![
        of(&|_| 1.0),
        model.acceleration.clone(),
        jerk,
        model.displacement.clone(),
        of(&|k| model.displacement[k].powi(3)),
        of(&|k| v[k].signum()),
        of(&|k| v[k].signum() * (-(v[k] / 0.01).powi(2)).exp()),
        v.clone(),
        rate.clone(),
        slope(&rate),
        of(&|k| k as f64 * dt * model.acceleration[k]),
        of(&|k| (v[k] / fastest).powi(5)),
        of(&|k| (std::f64::consts::TAU * 50.0 * k as f64 * dt).sin()),
    ]
}

fn left(terms: &[Vec<f64>], chosen: &[usize], residual: &[f64]) -> Option<(f64, Vec<f64>)> {
    let columns: Vec<Vec<f64>> = chosen.iter().map(|i| terms[*i].clone()).collect();
    let x = if columns.is_empty() { Vec::new() } else { least_squares(&columns, residual)? };
    let sum = (0..residual.len())
        .map(|k| (residual[k] - columns.iter().zip(&x).map(|(c, x)| c[k] * x).sum::<f64>()).powi(2))
        .sum();
    Some((sum, x))
}

/// Forward selection by BIC, the noise treated as white.
fn by_bic(terms: &[Vec<f64>], residual: &[f64]) -> Vec<&'static str> {
    let n = residual.len() as f64;
    let mut chosen: Vec<usize> = Vec::new();
    let mut best = left(terms, &[], residual).map_or(f64::INFINITY, |(sum, _)| n * libm::log(sum / n));
    for _ in 0..4 {
        let bic = |i: usize| -> Option<(usize, f64)> {
            let trial: Vec<usize> = chosen.iter().copied().chain([i]).collect();
            let (sum, _) = left(terms, &trial, residual)?;
            Some((i, n * libm::log(sum / n) + trial.len() as f64 * libm::log(n)))
        };
        let next = (0..terms.len()).filter(|i| !chosen.contains(i)).filter_map(bic).min_by(|a, b| a.1.total_cmp(&b.1));
        match next {
            Some((i, value)) if value < best => {
                best = value;
                chosen.push(i);
            }
            _ => break,
        }
    }
    chosen.into_iter().map(|i| TERMS[i]).collect()
}

/// Sequentially thresholded least squares (Brunton et al. 2016): terms whose share of the residual's size stays above a
/// tenth.
fn sparsely(terms: &[Vec<f64>], residual: &[f64]) -> Vec<&'static str> {
    let size = |x: &[f64]| (x.iter().map(|v| v * v).sum::<f64>() / x.len().max(1) as f64).sqrt();
    let whole = size(residual);
    let mut chosen: Vec<usize> = (0..terms.len()).filter(|i| size(&terms[*i]) > 0.0).collect();
    loop {
        let Some((_, x)) = left(terms, &chosen, residual) else { return Vec::new() };
        let kept: Vec<usize> =
            chosen.iter().zip(&x).filter(|(i, x)| x.abs() * size(&terms[**i]) > 0.1 * whole).map(|(i, _)| *i).collect();
        if kept.len() == chosen.len() {
            return kept.into_iter().map(|i| TERMS[i]).collect();
        }
        chosen = kept;
    }
}
