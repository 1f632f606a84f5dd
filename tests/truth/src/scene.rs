//! An experiment before any flaw: machine, loop, references, sensors, and what its author states of them.

use crate::baseline::{Prediction, predict, predict_noisy};
use crate::closed_loop::{Controller, Run};
use crate::effect::Scales;
use crate::excitation::{Excitation, Shape, reference};
use crate::noise::Noise;
use crate::plant::Machine;
use crate::refit::{Parameter, Sigma};
use crate::rng::Stream;

/// Kind of machine and loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Servo-hydraulic table under a PI loop.
    Servo,
    /// Rigid mass under a PI loop.
    Rigid,
    /// Rigid mass on an electromechanical axis under a cascade.
    Axis,
}

/// Size of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Size {
    /// Whatever comes.
    Any,
    /// Some runs at the velocity limit.
    Saturating,
    /// Small and slow, so that effects look alike.
    Slow,
}

/// What a case asks of its scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wish {
    /// Kind.
    pub kind: Kind,
    /// Size of the motion.
    pub size: Size,
    /// The accelerometer is needed.
    pub accelerometer: bool,
    /// The damping may not be re-estimated: it would swallow the flaw.
    pub damping_known: bool,
    /// A quiet accelerometer: a flaw that only it sees is to be seen well.
    pub quiet: bool,
}

impl Wish {
    /// Nothing in particular.
    pub fn plain(kind: Kind) -> Self {
        Self { kind, size: Size::Any, accelerometer: false, damping_known: false, quiet: false }
    }
}

/// The experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Kind.
    pub kind: Kind,
    /// True parameters.
    pub truth: Machine,
    /// Parameters as stated.
    pub stated: Machine,
    /// Parameters that the experiment lets be re-estimated.
    pub fit: Vec<Parameter>,
    /// Runs: those to fit first, the one held out last.
    pub runs: Vec<Run>,
    /// Sensor noise.
    pub noise: Noise,
    /// Noise as stated: the whole effective standard deviation.
    pub sigma: Sigma,
    /// Sizes of its motion.
    pub scales: Scales,
    /// Whether pressure difference and supply pressure are recorded.
    pub pressures: (bool, bool),
}

impl Scene {
    /// Draws a scene. `number` keeps its noise apart from that of other cases.
    pub fn draw(wish: Wish, number: u64, rng: &mut Stream) -> Self {
        let truth = machine(wish.kind, rng);
        let controller = controller(wish, &truth, rng);
        let runs = runs(wish, &truth, controller, number, rng);
        let predictions: Vec<_> = runs.iter().map(|run| predict(&truth, run)).collect();
        let noise = noise(wish, (rng.bits(), number), rng);
        let with_accelerometer = wish.kind != Kind::Axis || wish.accelerometer || rng.chance(0.5);
        let sigma = effective_sigma(&truth, &runs, &predictions, &noise, with_accelerometer);
        let saturated = predictions.split_last().is_some_and(|(_, fit)| fit.iter().any(|p| p.saturated > 0.01));
        let fit = free_parameters(wish, saturated, rng);
        let mut stated = truth;
        for parameter in &fit {
            if let Some(value) = parameter.of(&mut stated) {
                *value = rounded(*value * (1.0 + rng.sign() * rng.uniform(0.05, 0.2)), 4);
            }
        }
        let scales = scales(&truth, &runs, &predictions);
        let servo = wish.kind == Kind::Servo && wish.size != Size::Slow;
        let pressures = (servo && rng.chance(0.35), servo && rng.chance(0.2));
        Self { kind: wish.kind, truth, stated, fit, runs, noise, sigma, scales, pressures }
    }

    /// Runs to fit, and the one held out.
    pub fn fit_runs(&self) -> usize {
        self.runs.len() - 1
    }
}

/// To `digits` significant digits: what a person writes into a file is what the truth has.
pub fn rounded(value: f64, digits: i32) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let scale = 10.0_f64.powi(digits - 1 - value.abs().log10().floor() as i32);
    (value * scale).round() / scale
}

fn around(value: f64, spread: f64, rng: &mut Stream) -> f64 {
    rounded(value * rng.uniform(-spread, spread).exp(), 5)
}

fn machine(kind: Kind, rng: &mut Stream) -> Machine {
    match kind {
        Kind::Servo => Machine::Servo {
            b1: around(0.69, 0.3, rng),
            b0: around(138.0, 0.3, rng),
            a1: around(57.65, 0.25, rng),
            velocity_limit: rounded(rng.log_uniform(0.18, 0.45), 3),
        },
        Kind::Rigid => {
            let mass = rounded(rng.log_uniform(500.0, 8000.0), 4);
            Machine::Rigid { mass, viscous: rounded(mass * rng.uniform(15.0, 40.0), 4), gain: 1.0 }
        }
        Kind::Axis => Machine::Rigid {
            mass: around(95.1, 0.3, rng),
            viscous: around(203.5, 0.3, rng),
            gain: around(35.15, 0.1, rng),
        },
    }
}

fn controller(wish: Wish, truth: &Machine, rng: &mut Stream) -> Controller {
    match *truth {
        Machine::Servo { b0, a1, .. } => {
            let crossover = if wish.size == Size::Slow { rng.uniform(6.0, 10.0) } else { rng.uniform(7.0, 22.0) };
            let kp = rounded(crossover * a1 / b0, 3);
            Controller::Pi { kp, ki: rounded(rng.uniform(0.1, 0.8) * kp, 3) }
        }
        Machine::Rigid { mass, viscous, gain } if wish.kind == Kind::Rigid => {
            let kp = rounded(viscous * viscous / (mass * gain * rng.uniform(2.5, 5.0)), 4);
            Controller::Pi { kp, ki: rounded(rng.uniform(0.1, 0.5) * kp, 3) }
        }
        Machine::Rigid { .. } => Controller::Cascade { kp: around(160.18, 0.2, rng), kv: around(243.45, 0.2, rng) },
    }
}

fn runs(wish: Wish, truth: &Machine, controller: Controller, number: u64, rng: &mut Stream) -> Vec<Run> {
    let rate = match wish.kind {
        Kind::Axis => 1000.0,
        _ if rng.chance(0.06) => 1000.0,
        _ => rng.pick([200.0, 250.0, 256.0, 400.0, 500.0]),
    };
    let dt = 1.0 / rate;
    let seconds = if rate > 600.0 { rng.uniform(12.0, 16.0) } else { rng.uniform(20.0, 30.0) };
    let count = (seconds * rate) as usize;
    let limit = if let Machine::Servo { velocity_limit, .. } = truth { *velocity_limit } else { 0.3 };
    let mut kinds = Excitation::ALL;
    rng.shuffle(&mut kinds);
    let slow = wish.size == Size::Slow;
    let saturating = wish.size == Size::Saturating || (!slow && wish.kind == Kind::Servo && rng.chance(0.5));
    let levels: [f64; 4] = if slow {
        [0.04, 0.05, 0.06, 0.05]
    } else if saturating {
        [rng.uniform(0.4, 0.7), rng.uniform(1.0, 1.4), rng.uniform(1.4, 2.0), rng.uniform(1.1, 1.8)]
    } else {
        [rng.uniform(0.2, 0.4), rng.uniform(0.4, 0.6), rng.uniform(0.6, 0.75), rng.uniform(0.4, 0.75)]
    };
    let top = if slow { rng.uniform(0.6, 0.9) } else { rng.uniform(3.0, 8.0) };
    let count_of = if rng.chance(0.1) { 3 } else { 4 };
    (0..count_of)
        .map(|i| {
            let held_out = i + 1 == count_of;
            let level = if held_out { levels[3] } else { levels[i] };
            let displacement = if wish.kind == Kind::Axis { 0.15 } else { 0.11 };
            let shape = Shape { dt, count, velocity: level * limit, displacement, top };
            let start = if rng.chance(0.15) { rng.uniform(-0.03, 0.03) } else { 0.0 };
            let mut x = reference(kinds[i], &shape, rng);
            // The file holds tenths of a micrometre, and the controller saw what the file holds.
            for v in &mut x {
                *v = ((*v + start) * 1e7).round() / 1e7;
            }
            Run { reference: x, dt, controller, number: 8 * number + i as u64 }
        })
        .collect()
}

fn noise(wish: Wish, seed: (u64, u64), rng: &mut Stream) -> Noise {
    let (step, displacement) = match wish.kind {
        Kind::Axis => (1e-6, rng.log_uniform(1e-6, 3e-6)),
        // The paper's 0.04 mm, dithered by half a count of noise so that it does not stick; or a 16-bit converter.
        _ if rng.chance(0.25) => (4e-5, rng.uniform(1.8e-5, 3e-5)),
        _ => (5e-6, rng.log_uniform(5e-6, 2.5e-5)),
    };
    let acceleration = if wish.quiet { rng.log_uniform(0.01, 0.03) } else { rng.log_uniform(0.03, 0.196) };
    let colour = if rng.chance(0.25) { rng.uniform(0.2, 0.5) } else { 0.0 };
    let hum = rng.chance(0.1).then(|| (rng.pick([50.0, 60.0]), rng.uniform(0.15, 0.35) * acceleration));
    Noise { displacement, step, acceleration, colour, hum, seed }
}

/// What a laboratory would find from repeats: sensor noise, counts, and what the loop makes of both.
fn effective_sigma(
    truth: &Machine,
    runs: &[Run],
    clean: &[Prediction],
    noise: &Noise,
    with_accelerometer: bool,
) -> Sigma {
    let (mut d, mut a, mut n) = (0.0, 0.0, 0.0);
    for (run, clean) in runs.iter().zip(clean) {
        let noisy = predict_noisy(truth, run, noise);
        let squares = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(p, q)| (p - q).powi(2)).sum::<f64>();
        d += squares(&noisy.displacement, &clean.displacement);
        a += squares(&noisy.acceleration, &clean.acceleration);
        n += run.reference.len() as f64;
    }
    let acceleration = with_accelerometer.then(|| rounded((a / n).sqrt(), 3));
    Sigma { displacement: rounded((d / n).sqrt(), 3), acceleration }
}

fn free_parameters(wish: Wish, saturated: bool, rng: &mut Stream) -> Vec<Parameter> {
    let mut fit = Vec::new();
    if rng.chance(0.1) {
        return fit;
    }
    if wish.kind == Kind::Servo {
        fit.push(Parameter::B0);
        if !wish.damping_known {
            fit.push(Parameter::A1);
        }
        if rng.chance(0.4) && !wish.damping_known {
            fit.push(Parameter::B1);
        }
        if saturated && rng.chance(0.8) {
            fit.push(Parameter::VelocityLimit);
        }
    } else {
        fit.push(Parameter::Mass);
        if !wish.damping_known {
            fit.push(Parameter::Viscous);
        }
    }
    fit
}

fn scales(truth: &Machine, runs: &[Run], predictions: &[Prediction]) -> Scales {
    let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let mut accelerations: Vec<f64> = predictions.iter().flat_map(|p| p.acceleration.iter().map(|a| a.abs())).collect();
    accelerations.sort_by(f64::total_cmp);
    let rare = accelerations.get(accelerations.len() * 99 / 100).copied().unwrap_or(1.0);
    let dt = runs.first().map_or(1.0, |r| r.dt);
    let rate = predictions.iter().flat_map(|p| p.command.windows(2)).map(|w| (w[1] - w[0]).abs() / dt);
    let crossover = match (truth, runs.first().map(|r| r.controller)) {
        (Machine::Servo { b0, a1, .. }, Some(Controller::Pi { kp, .. })) => kp * b0 / a1,
        _ => 20.0,
    };
    Scales {
        command: predictions.iter().map(|p| largest(&p.command)).fold(0.0, f64::max),
        command_rate: rate.fold(0.0, f64::max),
        stroke: predictions.last().map_or(0.05, |p| largest(&p.displacement)),
        acceleration: rare,
        duration: runs.first().map_or(1.0, |r| r.reference.len() as f64 * r.dt),
        crossover,
    }
}
