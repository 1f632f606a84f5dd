//! Draws the experiment.

use super::test::{self, Extent, Test};
use super::{Says, Scene};
use crate::excitation::{Excitation, Shape, reference};
use crate::lab::forms::Scales;
use crate::lab::setup::draw::setup;
use crate::lab::setup::noise::stated_noise;
use crate::lab::stated::{Controller, Kind as Law, Prediction, Run, predict};
use crate::plant::Machine;
use crate::refit::Parameter;
use crate::rng::Stream;

/// Kind of machine and loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Servo-hydraulic table.
    Servo,
    /// Rigid mass driven by a force.
    Rigid,
    /// Rigid mass on an electromechanical axis under a cascade.
    Axis,
}

/// What a case asks of its experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wish {
    /// Kind.
    pub kind: Kind,
    /// Some runs at the velocity limit.
    pub saturating: bool,
    /// The accelerometer is needed.
    pub accelerometer: bool,
    /// The damping may not be re-estimated.
    pub damping_known: bool,
    /// Everything is as stated, but for the noise, which is always an estimate.
    pub perfect: bool,
    /// A test that shows little; any other without.
    pub test: Option<Test>,
}

pub use crate::scene::rounded;

impl Scene {
    /// Draws an experiment; `number` keeps its noise apart from that of other cases. None where the loop drawn is unstable.
    pub fn draw(wish: Wish, seed: (u64, u64), rng: &mut Stream) -> Option<Self> {
        let truth = machine(wish.kind, rng);
        let extent = match wish.test {
            Some(test) => test::extent(test.motion, rng),
            None => Extent::draw(wish.kind, rng),
        };
        let controller = controller(wish.kind, &truth, extent.rate, rng);
        let (runs, top) = match wish.test {
            Some(test) => test::runs(test.motion, &truth, controller, &extent, rng),
            None => runs(wish, &truth, controller, &extent, rng),
        };
        let predictions: Vec<_> = runs.iter().map(|run| predict(&truth, run, None)).collect();
        if !sound(&runs, &predictions) {
            return None;
        }
        let saturated = predictions.iter().take(runs.len() - 1).any(|p| p.saturated > 0.01);
        let scales = scales(&truth, &runs, &predictions, top);
        let fit = wish.test.map_or_else(|| free_parameters(wish, saturated, rng), |test| test.free.to_vec());
        let mut stated = truth;
        for parameter in &fit {
            if let Some(value) = parameter.of(&mut stated) {
                *value = rounded(*value * (rng.sign() * rng.uniform(0.02, 0.3)).exp(), 4);
            }
        }
        let says = Says { gains: [1.0; 3], clock: 1.0, ..Says::default() };
        let sigma = crate::refit::Sigma { displacement: 1.0, acceleration: None };
        let mut scene = Self {
            kind: wish.kind,
            truth,
            stated,
            fit,
            runs,
            sensor: crate::lab::setup::sensing::Sensor { seed, ..Default::default() },
            sigma,
            scales,
            says,
            misstated: Vec::new(),
        };
        setup(&mut scene, wish, rng);
        stated_noise(&mut scene, wish, rng);
        crate::lab::setup::visible::measure(&mut scene);
        Some(scene)
    }
}

impl Extent {
    /// Most cases have some ten thousand rows; one in sixty more than half a million.
    fn draw(kind: Kind, rng: &mut Stream) -> Self {
        let class = rng.unit();
        let rows = if class < 0.80 {
            rng.log_uniform(8e3, 3e4)
        } else if class < 0.94 {
            rng.log_uniform(3e4, 1e5)
        } else if class < 0.985 {
            rng.log_uniform(1e5, 5e5)
        } else {
            rng.log_uniform(5e5, 4e6)
        };
        let rates: [f64; 12] = [100.0, 128.0, 200.0, 250.0, 256.0, 400.0, 500.0, 512.0, 1000.0, 1024.0, 2000.0, 5000.0];
        let mut rate = rng.pick(rates);
        if kind == Kind::Axis {
            rate = rate.max(500.0);
        }
        // A run has at least 8 s and at most ten minutes.
        while rows / rate < 16.0 && rate > 100.0 {
            rate = (0.5 * rate).max(100.0);
        }
        let most = ((rows / rate / 8.0) as usize).clamp(1, 10);
        let least = (rows / rate / 600.0).ceil().clamp(1.0, 10.0) as usize;
        let wanted = 1 + (9.0 * rng.unit().powi(2)) as usize;
        let count = if rng.chance(0.08) { 1 } else { wanted.max(2) }.clamp(least, most.max(least));
        let seconds = (rows / rate / count as f64).clamp(8.0, 600.0);
        Self { rate, seconds, count }
    }
}

fn machine(kind: Kind, rng: &mut Stream) -> Machine {
    match kind {
        Kind::Servo => {
            let a1 = rng.log_uniform(25.0, 120.0);
            let b0 = a1 * rng.log_uniform(1.2, 5.0);
            Machine::Servo {
                b1: rounded(b0 / a1 * rng.uniform(0.0, 0.5), 4),
                b0: rounded(b0, 4),
                a1: rounded(a1, 4),
                velocity_limit: rounded(rng.log_uniform(0.1, 1.5), 4),
            }
        }
        Kind::Rigid => {
            let mass = rounded(rng.log_uniform(50.0, 50_000.0), 4);
            Machine::Rigid { mass, viscous: rounded(mass * rng.log_uniform(8.0, 40.0), 4), gain: 1.0 }
        }
        Kind::Axis => {
            let mass = rng.log_uniform(50.0, 400.0);
            Machine::Rigid {
                mass: rounded(mass, 4),
                viscous: rounded(mass * rng.log_uniform(1.0, 4.0), 4),
                gain: rounded(mass * rng.uniform(0.25, 0.5), 4),
            }
        }
    }
}

fn controller(kind: Kind, truth: &Machine, rate: f64, rng: &mut Stream) -> Controller {
    let mut out = match *truth {
        Machine::Servo { b0, a1, b1, .. } => {
            let gain = b0 / a1;
            // A loop is tuned to its pole and to its rate.
            let crossover = rng.log_uniform(4.0, 25.0).min(0.4 * a1).min(0.08 * rate);
            if rng.chance(0.12) && rate < 600.0 && b1 < 0.3 * gain {
                let kv = rounded(rng.uniform(0.2, 0.6) / gain, 3);
                Controller::plain(Law::Cascade { kp: rounded(crossover * (1.0 + kv * gain) / (kv * gain), 3), kv })
            } else {
                let kp = rounded(crossover / gain, 3);
                Controller::plain(Law::Pi { kp, ki: rounded(rng.uniform(0.0, 0.8) * kp, 3) })
            }
        }
        Machine::Rigid { mass, viscous, gain } if kind == Kind::Rigid => {
            let kp = rounded(viscous * viscous / (mass * gain * rng.uniform(2.5, 5.0)), 4);
            Controller::plain(Law::Pi { kp, ki: rounded(rng.uniform(0.0, 0.5) * kp, 3) })
        }
        Machine::Rigid { mass, gain, .. } => {
            let inner = rng.uniform(50.0, 100.0);
            Controller::plain(Law::Cascade {
                kp: rounded(inner * rng.uniform(0.3, 0.6), 4),
                kv: rounded(inner * mass / gain, 4),
            })
        }
    };
    if kind == Kind::Servo && rng.chance(0.12) {
        let Machine::Servo { b0, a1, .. } = truth else { return out };
        out.kvf = rounded(rng.uniform(0.3, 0.95) * a1 / b0, 3);
    }
    if kind == Kind::Servo && rate > 150.0 && rng.chance(0.04) {
        out.notch = Some([
            rounded(rng.uniform(8.0, 25.0), 3),
            rounded(rng.uniform(0.2, 0.7), 2),
            rounded(rng.uniform(0.1, 0.5), 2),
        ]);
    }
    out
}

fn runs(wish: Wish, truth: &Machine, controller: Controller, extent: &Extent, rng: &mut Stream) -> (Vec<Run>, f64) {
    let dt = 1.0 / extent.rate;
    let limit =
        if let Machine::Servo { velocity_limit, .. } = truth { *velocity_limit } else { rng.log_uniform(0.1, 0.6) };
    let mut kinds = Excitation::ALL;
    rng.shuffle(&mut kinds);
    let saturating = wish.saturating || (wish.kind == Kind::Servo && rng.chance(0.3));
    let stroke = rng.log_uniform(0.1, 0.6) * limit.max(0.2);
    let top = rng.uniform(2.0, 8.0).min(0.04 * extent.rate);
    let list = (0..extent.count).map(|i| {
        let level = if saturating && (i % 2 == 1 || i + 1 == extent.count) {
            rng.uniform(1.05, 1.7)
        } else {
            rng.uniform(0.2, 0.75)
        };
        let seconds = extent.seconds * if extent.count > 1 { rng.uniform(0.8, 1.2) } else { 1.0 };
        let count = (seconds.clamp(8.0, 600.0) * extent.rate) as usize;
        let shape = Shape { dt, count, velocity: level * limit, displacement: stroke, top };
        let start = if rng.chance(0.15) { rng.uniform(-0.2, 0.2) * stroke } else { 0.0 };
        let mut x = reference(kinds[i % kinds.len()], &shape, rng);
        for v in &mut x {
            *v += start;
        }
        test::as_filed(&mut x);
        Run { reference: x, dt, controller, number: i as u64 }
    });
    (list.collect(), top)
}

/// Whether the loop drawn follows its reference at all.
fn sound(runs: &[Run], predictions: &[Prediction]) -> bool {
    let most = |x: &[f64]| x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    runs.iter().zip(predictions).all(|(run, p)| {
        let (asked, made) = (most(&run.reference), most(&p.displacement));
        let jerky = p.command.windows(3).filter(|w| (w[1] - w[0]) * (w[2] - w[1]) < 0.0).count();
        made.is_finite() && made < 2.0 * asked && jerky * 5 < p.command.len() * 2
    })
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
            if rng.chance(0.4) {
                fit.push(Parameter::B1);
            }
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

fn scales(truth: &Machine, runs: &[Run], predictions: &[Prediction], top: f64) -> Scales {
    let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let rare = |mut all: Vec<f64>| {
        all.sort_by(f64::total_cmp);
        all.get(all.len() * 99 / 100).copied().unwrap_or(1.0)
    };
    let dt = runs.first().map_or(1.0, |r| r.dt);
    let rates = |of: fn(&Prediction) -> &Vec<f64>| {
        predictions.iter().flat_map(move |p| of(p).windows(2)).map(move |w| (w[1] - w[0]).abs() / dt)
    };
    let (pole, mass, gain) = match *truth {
        Machine::Servo { b0, a1, .. } => (a1, 1.0, b0 / a1),
        Machine::Rigid { mass, viscous, gain } => (viscous / mass, mass, gain / viscous),
    };
    let velocity = rare(rates(|p| &p.displacement).collect());
    let crossover = match runs.first().map(|r| r.controller.kind) {
        Some(Law::Pi { kp, .. }) => kp * gain,
        Some(Law::Cascade { kp, .. }) => 0.5 * kp,
        None => 10.0,
    };
    Scales {
        command: predictions.iter().map(|p| largest(&p.command)).fold(0.0, f64::max),
        command_rate: rates(|p| &p.command).fold(0.0, f64::max),
        stroke: predictions.last().map_or(0.05, |p| largest(&p.displacement)),
        velocity,
        acceleration: rare(predictions.iter().flat_map(|p| p.acceleration.iter().map(|a| a.abs())).collect()),
        duration: runs.iter().map(|r| r.reference.len() as f64 * r.dt).fold(f64::INFINITY, f64::min),
        crossover,
        limit: if let Machine::Servo { velocity_limit, .. } = truth { *velocity_limit } else { velocity },
        pole,
        mass,
        top,
    }
}
