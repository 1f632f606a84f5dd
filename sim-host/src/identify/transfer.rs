//! The table as a transfer function: from the recorded command to its motion, the order chosen by hold-out records.
//!
//! No physics is assumed beside the integrator from valve to displacement, so that this is a second opinion on the fit in
//! time: a delay or a lag that it finds and the fitted model lacks is missing physics. The response is the cross spectrum
//! over the command's power; in a closed loop the sensor's noise returns through the command and biases it where the
//! motion is not well above the noise, so points of low coherence are left out.

use super::data::{Channel, Run};
use super::frequency::multitaper::multitaper;
use super::frequency::transfer::{Order, Trial, choose};
use super::frequency::{Response, ResponseError};
use crate::motion::filter::Edge;
use crate::plant::simulate::SimulatedLaw;
use crate::recording::signal::filled;

/// Windows of the response.
const TAPERS: usize = 8;
/// Coherence below which a point is left out.
const COHERENT: f64 = 0.8;
/// Highest degrees of numerator and denominator beside the integrator.
const DEGREES: (usize, usize) = (2, 4);
/// Longest delay that is tried, s, or this many samples where they are longer.
const DELAY: (f64, f64) = (0.03, 4.0);

/// A transfer function and what it was fitted to.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    /// What the command moves.
    pub output: Channel,
    /// The response of the runs fitted.
    pub response: Response,
    /// The response that chose the order.
    pub held_back: Response,
    /// Whether whole runs were held out; else the second halves of the runs fitted.
    pub by_runs: bool,
    /// Every order tried, the chosen one first.
    pub trials: Vec<Trial>,
}

/// The transfer function from command to displacement, or to velocity where that is what was measured.
pub(crate) fn transfer(fit: &[Run], holdout: &[Run]) -> Result<Transfer, ResponseError> {
    let nothing = ResponseError::TooFew { what: "runs with a command and a motion", found: 0, least: 1 };
    let first = fit.first().ok_or_else(|| nothing.clone())?;
    let output = [Channel::Displacement, Channel::Velocity].into_iter().find(|c| first.channel(*c).is_some());
    let output = output.filter(|_| first.motion.is_none()).ok_or(nothing)?;
    let of = |runs: &[Run]| -> Vec<Pair> {
        runs.iter().filter(|run| (run.dt / first.dt - 1.0).abs() < 1e-6).filter_map(|run| pair(run, output)).collect()
    };
    let (mut fitted, mut judging) = (of(fit), of(holdout));
    let by_runs = !judging.is_empty();
    if !by_runs {
        let halved = |(u, y): &mut Pair| (u.split_off(u.len() / 2), y.split_off(y.len() / 2));
        judging = fitted.iter_mut().map(halved).collect();
    }
    let response = |pairs: &[Pair]| -> Result<Response, ResponseError> {
        let records: Vec<(&[f64], &[f64])> = pairs.iter().map(|(u, y)| (u.as_slice(), y.as_slice())).collect();
        Ok(multitaper(&records, first.dt, TAPERS)?.within(0.0, f64::INFINITY, COHERENT))
    };
    let (response, held_back) = (response(&fitted)?, response(&judging)?);
    let longest = DELAY.0.max(DELAY.1 * first.dt);
    let integrators = usize::from(output == Channel::Displacement);
    let orders: Vec<Order> = (0..=DEGREES.0)
        .flat_map(|numerator| (numerator.max(1)..=DEGREES.1).map(move |denominator| (numerator, denominator)))
        .flat_map(|(numerator, denominator)| {
            [0.0, longest].map(|longest_delay| Order { numerator, denominator, integrators, longest_delay })
        })
        .collect();
    let mut trials = choose(&response, &held_back, &orders)?;
    // A table at rest stays at rest: what grows by itself is no model of it.
    trials.retain(|trial| trial.fit.function.is_stable());
    if trials.is_empty() {
        return Err(ResponseError::Singular);
    }
    Ok(Transfer { output, response, held_back, by_runs, trials })
}

/// Command and motion.
type Pair = (Vec<f64>, Vec<f64>);

/// The command that reached the valve and the motion it made; none where one of them was not recorded.
fn pair(run: &Run, output: Channel) -> Option<Pair> {
    let motion = filled(&run.channel(output)?.values);
    let command = match run.law {
        // What is compared was low-passed, so what drives has to be.
        SimulatedLaw::Recorded => {
            run.filter.as_ref().map_or(run.input.clone(), |f| f.zero_phase(&run.input, Edge::Hold))
        }
        _ => filled(&run.channel(Channel::Command)?.values),
    };
    Some((command, motion))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::data::Measured;
    use crate::identify::evaluate::{Local, predict};
    use crate::identify::model::{Model, ModelEffect, SignalScales, Value};
    use crate::plant::effects::entry;
    use crate::plant::model::Kind;

    /// The paper's valve behind a delay, moved by tones that stay below its limit.
    fn run(number: i32, delay: f64) -> Run {
        let (n, dt) = (8000, 0.005);
        let tone = |k: usize, i: i32| {
            let hz = 0.15 * 1.12_f64.powi(i) * f64::from(20 + number) / 20.0;
            0.001 * (std::f64::consts::TAU * hz * k as f64 * dt + f64::from(i * i * number)).sin()
        };
        let displacement = Measured {
            channel: Channel::Displacement,
            values: vec![0.0; n],
            noise: 1e-6,
            stated: Some(1e-6),
            judged: true,
        };
        let mut run = Run {
            name: format!("run {number}"),
            dt,
            from: 0.0,
            elapsed: 0.0,
            ticks: 1,
            input: (0..n).map(|k| (0..40).map(|i| tone(k, i)).sum()).collect(),
            added: Vec::new(),
            law: SimulatedLaw::Recorded,
            shaping: crate::plant::simulate::Shaping::default(),
            loop_noise: None,
            sent_before: Vec::new(),
            moving_start: false,
            measured: vec![displacement],
            motion: None,
            filter: None,
        };
        let own = [0.69, 138.0, 57.65, 0.242].map(Value::fixed).to_vec();
        let sizes = SignalScales {
            command: 1.0,
            command_rate: 1.0,
            speed: 1.0,
            displacement: 1.0,
            force: 1.0,
            duration: 1.0,
            line: 50.0,
        };
        let mut effect = ModelEffect::start(entry("command_delay").unwrap(), 0, &sizes).unwrap();
        effect.values[0] = Value::fixed(delay);
        let model = Model::bare(Kind::Servo, own).with(effect);
        let mut noise = 0.37_f64;
        run.measured[0].values = predict(&model, &run, &Local::start(&model, &run)).unwrap().channels.remove(0);
        for value in &mut run.measured[0].values {
            noise = (noise * 997.13 + 0.1).fract();
            *value += 4e-6 * (noise - 0.5);
        }
        run
    }

    #[test]
    fn order_and_delay_of_the_papers_valve_are_found() {
        for delay in [2e-4, 0.012] {
            let found = transfer(&[run(1, delay)], &[run(2, delay)]).unwrap();
            let chosen = &found.trials[0];
            // The command is held between samples, which delays it by half of one.
            let expected = delay + 0.0025;
            let lag = |f: &crate::identify::frequency::transfer::TransferFunction| {
                // The slope of the phase at rest beside that of the pole.
                f.delay + f.denominator.get(1).copied().unwrap_or(1.0) / f.denominator[0]
                    - f.numerator.get(1).copied().unwrap_or(0.0) / f.numerator[0]
            };
            let function = &chosen.fit.function;
            let gain = function.numerator[0] / function.denominator[0];
            assert!((gain / (138.0 / 57.65) - 1.0).abs() < 0.02, "{function}");
            assert!((lag(function) - (expected + 1.0 / 57.65 - 0.69 / 138.0)).abs() < 1e-3, "{function}");
            assert!(chosen.order.denominator <= 2, "{function}");
            assert!(delay < 0.01 || (chosen.fit.function.delay - expected).abs() < 3e-3, "{function}");
        }
    }
}
