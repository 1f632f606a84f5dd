//! Is the examination fair? For each effect whose truth has other equations than the simple form, the simple form is
//! fitted to data without noise, together with the baseline, and what it leaves of the excess is printed.
//!
//! `cargo run --release -p shakedown-truth --example fairness [SCENES [EFFECT]]`

use shakedown_truth::closed_loop::simulate;
use shakedown_truth::effect::{Draw, Effect, Parameters};
use shakedown_truth::plant::{Actuator, Backlash, Base, Friction, Lag, Overlap, Payload, Physics, Stop, Supply};
use shakedown_truth::refit::{Parameter, least_squares};
use shakedown_truth::rng::Stream;
use shakedown_truth::scene::{Kind, Scene, Size, Wish};
use shakedown_truth::strength::seek;
use std::io::Write as _;

const EFFECTS: [Effect; 14] = [
    Effect::ValveDeadband,
    Effect::ValveLag,
    Effect::SupplyDroop,
    Effect::LoadDependentFlow,
    Effect::OilCompliance,
    Effect::Leakage,
    Effect::ViscousFriction,
    Effect::CoulombFriction,
    Effect::StribeckFriction,
    Effect::Backlash,
    Effect::EndStop,
    Effect::BaseCompliance,
    Effect::PayloadResonance,
    Effect::GainDrift,
];

/// The simple form of an effect with these parameters, in the order in which the truth states them.
fn simple(effect: Effect, p: &[f64], sign: f64, physics: &mut Physics) {
    match effect {
        Effect::ValveDeadband => physics.valve.overlap = Some(Overlap { half_width: p[0], rounding: 0.01 }),
        Effect::ValveLag => physics.valve.lag = Some(Lag { frequency: p[0], damping: p[1], motor: 60.0 }),
        Effect::SupplyDroop => {
            physics.flow.supply = Some(Supply { depth: p[0], recovery: p[1], exponent: 1e9, band: 1.0 });
        }
        Effect::LoadDependentFlow => {
            physics.actuator =
                Actuator::Chambers { frequency: 400.0, damping: 0.5, stroke: 100.0, supply: p[0], orifices: true };
        }
        Effect::OilCompliance => {
            physics.actuator =
                Actuator::Chambers { frequency: p[0], damping: p[1], stroke: 100.0, supply: 1e5, orifices: false };
        }
        Effect::Leakage => physics.actuator = Actuator::Leaking { laminar: p[0], turbulent: 0.0 },
        Effect::ViscousFriction => physics.table.viscous = Some((p[0], 1e9)),
        Effect::CoulombFriction | Effect::StribeckFriction => {
            let (breakaway, stribeck) = if p.len() > 1 { (p[1], p[2]) } else { (p[0], 0.01) };
            physics.table.friction =
                Some(Friction { sliding: p[0], breakaway, stribeck, presliding: 4e-6, patch: None });
        }
        Effect::Backlash => physics.table.backlash = Some(Backlash { gap: p[0], sharpness: 300.0 }),
        Effect::EndStop => {
            physics.table.stop =
                Some(Stop { position: p[0], stiffness: p[1], exponent: 1.0, scale: 0.01, damping: 0.0 });
        }
        Effect::BaseCompliance => {
            physics.base = Some(Base { frequency: p[0], damping: p[1], mass_ratio: p[2], cubic: 0.0 });
        }
        Effect::PayloadResonance => {
            physics.payload = Some(Payload {
                mass_ratio: p[0],
                frequency: p[1],
                damping: p[2],
                cubic: 0.0,
                second: None,
                pounding: None,
            });
        }
        _ => physics.command.warming = Some((sign * p[0], 1e6)),
    }
}

/// Baseline parameters, effect parameters (both in the logarithm) and the displacement's offset in noise units.
struct Model<'a> {
    scene: &'a Scene,
    effect: Effect,
    sign: f64,
}

impl Model<'_> {
    fn physics(&self, q: &[f64]) -> Physics {
        let mut machine = self.scene.truth;
        for (parameter, change) in self.scene.fit.iter().zip(q) {
            if let Some(value) = Parameter::of(*parameter, &mut machine) {
                *value *= change.exp();
            }
        }
        let own: Vec<f64> = q[self.scene.fit.len()..q.len() - 1].iter().map(|v| v.exp()).collect();
        let mut physics = Physics::baseline(machine);
        simple(self.effect, &own, self.sign, &mut physics);
        physics
    }

    /// Signals of runs `from..to` over their noise.
    fn signals(&self, q: &[f64], from: usize, to: usize) -> Option<Vec<f64>> {
        signals(self.scene, &self.physics(q), q[q.len() - 1], from, to)
    }
}

fn signals(scene: &Scene, physics: &Physics, offset: f64, from: usize, to: usize) -> Option<Vec<f64>> {
    let mut out = Vec::new();
    for run in &scene.runs[from..to] {
        let traces = simulate(physics, run, None)?;
        out.extend(traces.displacement.iter().map(|x| x / scene.sigma.displacement + offset));
        if let Some(sigma) = scene.sigma.acceleration {
            out.extend(traces.acceleration.iter().map(|a| a / sigma));
        }
    }
    Some(out)
}

fn misfit(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>() / a.len() as f64
}

/// Fits by Gauss and Newton; gives the misfit per sample of the run held out, and the effect's parameters.
fn fitted(model: &Model<'_>, start: &Parameters, truth: &[f64], held_out: &[f64]) -> Option<(f64, Vec<f64>)> {
    let n = model.scene.fit_runs();
    let mut q = vec![0.0; model.scene.fit.len()];
    q.extend(start.iter().map(|(_, v)| v.abs().ln()));
    q.push(0.0);
    let mut here = model.signals(&q, 0, n)?;
    for _ in 0..8 {
        let residual: Vec<f64> = truth.iter().zip(&here).map(|(t, h)| t - h).collect();
        let columns: Vec<Vec<f64>> = (0..q.len())
            .map(|i| {
                let mut moved = q.clone();
                moved[i] += 1e-4;
                let there = model.signals(&moved, 0, n)?;
                Some(there.iter().zip(&here).map(|(a, b)| (a - b) / 1e-4).collect())
            })
            .collect::<Option<_>>()?;
        let step = least_squares(&columns, &residual)?;
        let mut share = 1.0;
        let mut moved_on = false;
        while share > 0.02 {
            let trial: Vec<f64> = q.iter().zip(&step).map(|(v, s)| v + (share * s).clamp(-0.7, 0.7)).collect();
            if let Some(there) = model.signals(&trial, 0, n)
                && misfit(&there, truth) < misfit(&here, truth)
            {
                moved_on = misfit(&there, truth) < 0.995 * misfit(&here, truth);
                (q, here) = (trial, there);
                break;
            }
            share *= 0.3;
        }
        if !moved_on {
            break;
        }
    }
    let own = q[model.scene.fit.len()..q.len() - 1].iter().map(|v| v.exp()).collect();
    Some((misfit(&model.signals(&q, n, n + 1)?, held_out), own))
}

fn main() {
    let only = std::env::args().nth(2);
    let scenes: u64 = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(2);
    let mut out = std::io::stdout().lock();
    for effect in EFFECTS.into_iter().filter(|e| only.as_ref().is_none_or(|id| e.id() == id)) {
        for target in [20.0, 200.0] {
            for number in 0..scenes {
                let size = if effect.needs_saturation() { Size::Saturating } else { Size::Any };
                let wish = Wish {
                    size,
                    damping_known: effect == Effect::ViscousFriction,
                    quiet: effect.needs_accelerometer(),
                    ..Wish::plain(Kind::Servo)
                };
                let mut rng = Stream::new(77, number, effect as u64);
                let scene = Scene::draw(wish, number, &mut rng);
                let draw = Draw::new(&mut rng);
                let apply = |s: f64, physics: &mut Physics| {
                    effect.apply(s, &draw, &scene.scales, physics);
                };
                let Some((strength, sized)) = seek(&scene, target, &apply) else { continue };
                let mut physics = Physics::baseline(scene.truth);
                let parameters = effect.apply(strength, &draw, &scene.scales, &mut physics);
                let n = scene.fit_runs();
                let truth = signals(&scene, &physics, 0.0, 0, n).unwrap_or_default();
                let held_out = signals(&scene, &physics, 0.0, n, n + 1).unwrap_or_default();
                let model = Model { scene: &scene, effect, sign: draw.sign };
                let Some((left, own)) = fitted(&model, &parameters, &truth, &held_out) else { continue };
                let shown: Vec<String> = parameters
                    .iter()
                    .zip(&own)
                    .map(|((key, truth), best)| format!("{key} {truth:.4} -> {best:.4}"))
                    .collect();
                let share = 100.0 * left / sized.excess;
                // A closed pipe is no error.
                drop(writeln!(
                    out,
                    "{:<20} excess {:>8.2}, left {left:>7.3} ({share:.2} %)  {}",
                    effect.id(),
                    sized.excess,
                    shown.join(", ")
                ));
            }
        }
    }
}
