//! Short runs that a laboratory can make, within what the table was seen to reach.

use crate::identify::data::Run;
use crate::identify::model::Model;
use crate::identify::prepare::Prepared;
use crate::plant::simulate::SimulatedLaw;
use std::f64::consts::PI;

/// Length of a test, s.
const DURATION: f64 = 8.0;
/// Time in which a test comes up and goes down, s.
const EASED: f64 = 0.5;

/// What a test moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape {
    /// A sine about the middle.
    Sine {
        /// Frequency, Hz.
        frequency: f64,
        /// Amplitude, m.
        amplitude: f64,
    },
    /// Constant speed to and fro.
    Triangle {
        /// Speed, m/s.
        speed: f64,
        /// Travel either side, m.
        amplitude: f64,
    },
    /// A small sine while the table crosses its stroke.
    Crossing {
        /// Frequency of the small sine, Hz.
        frequency: f64,
        /// Its amplitude, m.
        amplitude: f64,
    },
    /// At rest in the middle.
    Hold,
}

/// The loop's gains in a test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GainScaling {
    /// As in the runs at hand.
    AsTheyWere,
    /// Half of that.
    Halved,
}

/// What the table may be asked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    displacement: f64,
    speed: f64,
    middle: f64,
}

impl Reach {
    /// What the runs reached, and the velocity limit where the model has one.
    pub(super) fn of(prepared: &Prepared, model: &Model) -> Self {
        let parameters = model.kind.parameters();
        let limit = parameters.iter().zip(&model.own).find(|(p, _)| p.key == "velocity_limit").map(|(_, v)| v.value);
        let seen = prepared.signal_scales;
        let middle = prepared.fit.first().and_then(|run| run.input.first()).copied().unwrap_or(0.0);
        let speed = limit.filter(|limit| limit.is_finite()).map_or(seen.speed, |limit| limit.min(1.3 * seen.speed));
        Self { displacement: seen.displacement, speed, middle }
    }
}

/// Every test worth trying at a run's sampling rate.
pub(super) fn shapes(pattern: &Run, reach: &Reach) -> Vec<Shape> {
    let mut all = vec![Shape::Hold];
    for frequency in [0.3, 1.0, 3.0, 8.0, 20.0].into_iter().filter(|f| f * pattern.dt < 0.15) {
        for share in [0.1, 0.5, 1.05] {
            let amplitude = (share * reach.speed / (2.0 * PI * frequency)).min(reach.displacement);
            all.push(Shape::Sine { frequency, amplitude });
        }
        all.push(Shape::Crossing { frequency, amplitude: 0.2 * reach.speed / (2.0 * PI * frequency) });
    }
    for share in [0.05, 0.3, 0.7, 1.05] {
        for amplitude in [0.1, 0.7] {
            all.push(Shape::Triangle { speed: share * reach.speed, amplitude: amplitude * reach.displacement });
        }
    }
    all
}

/// A run of a shape: rate, loop, channels and noise as in `pattern`; its measurements are yet to come.
pub(super) fn run(pattern: &Run, shape: Shape, gains: GainScaling, reach: &Reach) -> Run {
    let samples = (DURATION / pattern.dt) as usize;
    let at = |k: usize| {
        let t = k as f64 * pattern.dt;
        let ease = (t.min(DURATION - t) / EASED).clamp(0.0, 1.0);
        reach.middle + place(shape, t, reach) * ease * ease * (3.0 - 2.0 * ease)
    };
    let law = match (gains, pattern.law) {
        (GainScaling::Halved, SimulatedLaw::Pi { kp, ki }) => SimulatedLaw::Pi { kp: 0.5 * kp, ki: 0.5 * ki },
        (GainScaling::Halved, SimulatedLaw::Cascade { kp, kv }) => SimulatedLaw::Cascade { kp: 0.5 * kp, kv },
        (_, law) => law,
    };
    let mut run = pattern.clone();
    run.name = "next test".into();
    run.input = (0..samples).map(at).collect();
    run.added.clear();
    run.moving_start = false;
    run.law = law;
    run.measured.iter_mut().for_each(|m| m.values = vec![f64::NAN; samples]);
    run
}

/// Where a shape is at a time (s), m.
fn place(shape: Shape, t: f64, reach: &Reach) -> f64 {
    match shape {
        Shape::Sine { frequency, amplitude } => amplitude * (2.0 * PI * frequency * t).sin(),
        Shape::Triangle { speed, amplitude } => {
            let quarter = (amplitude / speed.max(1e-9)).max(1e-9);
            let phase = (t / quarter).rem_euclid(4.0);
            amplitude
                * if phase < 1.0 {
                    phase
                } else if phase < 3.0 {
                    2.0 - phase
                } else {
                    phase - 4.0
                }
        }
        Shape::Crossing { frequency, amplitude } => {
            0.7 * reach.displacement * (2.0 * PI * t / DURATION).sin() + amplitude * (2.0 * PI * frequency * t).sin()
        }
        Shape::Hold => 0.0,
    }
}

/// A test as one would ask for it.
pub(super) fn in_words(shape: Shape, gains: GainScaling, reach: &Reach) -> String {
    let mm = |m: f64| format!("{:.3} mm", m * 1e3);
    let moved = match shape {
        Shape::Sine { frequency, amplitude } => format!("a sine of {frequency} Hz, {} either side", mm(amplitude)),
        Shape::Triangle { speed, amplitude } => {
            format!("to and fro at a constant {:.1} mm/s, {} either side", speed * 1e3, mm(amplitude))
        }
        Shape::Crossing { frequency, amplitude } => format!(
            "a sine of {frequency} Hz and {} on a slow one of {} either side",
            mm(amplitude),
            mm(0.7 * reach.displacement)
        ),
        Shape::Hold => "the loop closed, the reference at rest".to_owned(),
    };
    let gains = match gains {
        GainScaling::AsTheyWere => "gains as they were",
        GainScaling::Halved => "outer gains halved",
    };
    format!("{moved}, {DURATION} s, {gains}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_shape_goes_beyond_the_reach() {
        let reach = Reach { displacement: 0.05, speed: 0.2, middle: 0.0 };
        for k in 0..8000 {
            let t = f64::from(k) * 1e-3;
            for shape in
                [Shape::Triangle { speed: 0.2, amplitude: 0.035 }, Shape::Sine { frequency: 1.0, amplitude: 0.03 }]
            {
                assert!(place(shape, t, &reach).abs() <= 0.05, "{shape:?} at {t}");
            }
        }
        let triangle = Shape::Triangle { speed: 0.2, amplitude: 0.02 };
        let slope = (place(triangle, 0.05, &reach) - place(triangle, 0.04, &reach)) / 0.01;
        assert!((slope - 0.2).abs() < 1e-9);
    }
}
