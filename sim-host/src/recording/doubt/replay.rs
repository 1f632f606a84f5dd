//! The controller's law as a linear model of the recorded command.

use crate::plant::simulate::NotchFilter;
use crate::recording::channel::Channel;
use crate::recording::check::Ticks;
use crate::recording::lag::lagged;
use crate::recording::law::RecordedLaw;
use crate::recording::run::Run;
use crate::recording::signal::{filled, shifted};
use crate::scalar::earlier;
use nalgebra::{DMatrix, DVector};

/// A law's recorded command and the signals that its gains multiply, the slow part of each taken off.
#[derive(Debug, Clone)]
pub(super) struct Linear {
    /// The recorded command, without what was declared as added to it.
    pub(super) command: Vec<f64>,
    /// One series a gain.
    pub(super) terms: Vec<Vec<f64>>,
    /// Which samples count.
    pub(super) known: Vec<bool>,
}

/// The gains that a law multiplies its terms by; none for a law without gains.
pub(super) fn gains(law: &RecordedLaw) -> Option<[f64; 2]> {
    match law {
        RecordedLaw::ProportionalIntegral { kp, ki } => Some([*kp, *ki]),
        RecordedLaw::Cascade { kp, kv } => Some([kp * kv, *kv]),
        RecordedLaw::Open | RecordedLaw::Core { .. } => None,
    }
}

impl Linear {
    /// The run's law, with the displacement `late` samples earlier and the whole law `delayed` samples later than recorded;
    /// `feed_forward` adds the rate of the reference as a last term.
    pub(super) fn of(run: &Run, late: i32, delayed: f64, feed_forward: bool) -> Option<Self> {
        let get = |channel| run.channel(channel);
        let (reference, displacement) = (get(Channel::Reference)?, get(Channel::Displacement)?);
        let command = get(Channel::Command)?;
        let finite = |k: usize| reference[k].is_finite() && displacement[k].is_finite() && command[k].is_finite();
        let known: Vec<bool> = (0..run.len()).map(finite).collect();
        let mut command = filled(command);
        if let Some(added) = get(Channel::Disturbance) {
            command.iter_mut().zip(filled(added)).for_each(|(u, d)| *u -= d);
        }
        if let Some(pressure) = get(Channel::PressureDifference).filter(|_| run.shaping.kdp != 0.0) {
            command.iter_mut().zip(filled(pressure)).for_each(|(u, p)| *u += run.shaping.kdp * p);
        }
        let (reference, displacement) = (filled(reference), shifted(&filled(displacement), late));
        let error: Vec<f64> = reference.iter().zip(&displacement).map(|(r, x)| r - x).collect();
        let ticks = Ticks::of(run);
        let mut terms: Vec<Vec<f64>> = match &run.law {
            RecordedLaw::ProportionalIntegral { .. } => {
                ticks.seen(&error, |error, dt| [error.to_vec(), integral(error, dt)]).into()
            }
            RecordedLaw::Cascade { .. } => {
                let [error, _] = ticks.seen(&error, |error, _| [error.to_vec(), Vec::new()]);
                let [velocity, _] = ticks.seen(&displacement, |x, dt| [backward(x, dt), Vec::new()]);
                vec![error, velocity.iter().map(|v| -v).collect()]
            }
            RecordedLaw::Open | RecordedLaw::Core { .. } => return None,
        };
        if feed_forward {
            let [rate, _] = ticks.seen(&reference, |r, dt| [backward(r, dt), Vec::new()]);
            terms.push(rate);
        }
        for term in &mut terms {
            if let Some(notch) = run.shaping.notch {
                let mut filter = NotchFilter::<f64>::new(notch, ticks.period());
                for x in term.iter_mut() {
                    *x = filter.step(*x);
                }
            }
            *term = earlier(term, -delayed);
        }
        Some(Self { command, terms, known })
    }

    /// The same law behind a lag of so many samples.
    pub(super) fn lagged(mut self, samples: f64) -> Self {
        if samples > 0.0 {
            self.terms.iter_mut().for_each(|term| *term = lagged(term, samples));
        }
        self
    }

    /// Command less the terms times these gains.
    pub(super) fn residual(&self, gains: &[f64]) -> Vec<f64> {
        let of = |k: usize| self.command[k] - gains.iter().zip(&self.terms).map(|(g, t)| g * t[k]).sum::<f64>();
        (0..self.command.len()).map(of).collect()
    }

    /// Command and terms with a parabola in time taken off each: offsets and drifts of sensors and of the converter, and the
    /// integral of an offset, are none of the gains' business.
    pub(super) fn without_trends(mut self) -> Self {
        let known = self.known.clone();
        for series in std::iter::once(&mut self.command).chain(&mut self.terms) {
            let parabola = parabola(series, &known);
            for (k, x) in series.iter_mut().enumerate() {
                let t = time(k, known.len());
                *x -= parabola[0] + t * (parabola[1] + t * parabola[2]);
            }
        }
        self
    }
}

/// What a law adds to its command where the displacement that it sees is less than the recorded one by this.
pub(super) fn answer(run: &Run, less: &[f64]) -> Option<Vec<f64>> {
    let ticks = Ticks::of(run);
    let [first, second] = match &run.law {
        RecordedLaw::ProportionalIntegral { .. } => ticks.seen(less, |error, dt| [error.to_vec(), integral(error, dt)]),
        RecordedLaw::Cascade { .. } => ticks.seen(less, |error, dt| [error.to_vec(), backward(error, dt)]),
        RecordedLaw::Open | RecordedLaw::Core { .. } => return None,
    };
    let [a, b] = gains(&run.law)?;
    Some(first.iter().zip(&second).map(|(p, q)| a * p + b * q).collect())
}

/// Place in a run of `n` samples, from -1 to 1.
pub(super) fn time(k: usize, n: usize) -> f64 {
    2.0 * k as f64 / (n.max(2) - 1) as f64 - 1.0
}

/// Coefficients of the least-squares parabola through the samples that are known, in [`time`].
pub(super) fn parabola(series: &[f64], known: &[bool]) -> [f64; 3] {
    let (mut matrix, mut right) = (DMatrix::<f64>::zeros(3, 3), DVector::<f64>::zeros(3));
    for (k, (x, known)) in series.iter().zip(known).enumerate() {
        if !known {
            continue;
        }
        let t = time(k, series.len());
        let row = [1.0, t, t * t];
        for i in 0..3 {
            right[i] += row[i] * x;
            for j in 0..3 {
                matrix[(i, j)] += row[i] * row[j];
            }
        }
    }
    matrix.cholesky().map_or([0.0; 3], |c| {
        let solved = c.solve(&right);
        [solved[0], solved[1], solved[2]]
    })
}

fn integral(error: &[f64], dt: f64) -> Vec<f64> {
    let sum = |sum: &mut f64, e: &f64| {
        *sum += e * dt;
        Some(*sum)
    };
    error.iter().scan(0.0, sum).collect()
}

fn backward(samples: &[f64], dt: f64) -> Vec<f64> {
    // What stood before the first sample of a part is not recorded: the slope there is the next one's.
    let first = samples.first().map_or(0.0, |first| 2.0 * first - samples.get(1).unwrap_or(first));
    let before = std::iter::once(first).chain(samples.iter().copied());
    before.zip(samples).map(|(before, &now)| (now - before) / dt).collect()
}
