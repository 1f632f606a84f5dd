//! What the sensors make of the motion: the LVDT's quantisation, the accelerometer's noise, and the mains hum and
//! saw-tooth that the cables pick up (the noise source of Fig. 7). Everything is seeded: the same seed, the same noise.

use super::paper::{ParameterError, finite, not_negative, positive};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use shakedown_core::blocks::filter::{MotionObserver, MotionState};
use std::f64::consts::TAU;

pub use crate::scalar::GRAVITY;

/// What disturbs each channel.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SensorModel {
    /// Step of the LVDT's reading, m; zero for an ideal one.
    pub displacement_step: f64,
    /// Standard deviation of the accelerometer's white noise at each sample, m/s2.
    pub acceleration_noise: f64,
    /// Standard deviation of a velocity transducer's white noise at each sample, m/s; none where there is no transducer, and
    /// the velocity is what the core's observer makes of LVDT and accelerometer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity_noise: Option<f64>,
    /// Piston area over moving mass by which a load becomes a pressure difference, m2/kg; none where no sensor is fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area_per_mass: Option<f64>,
    /// What the LVDT's cable picks up; amplitudes in m.
    pub displacement_lines: Vec<Line>,
    /// What the accelerometer's cable picks up; amplitudes in m/s2.
    pub acceleration_lines: Vec<Line>,
    /// Seed of all noise and of the lines' phases.
    pub seed: u64,
}

impl Default for SensorModel {
    /// Ideal sensors.
    fn default() -> Self {
        Self {
            displacement_step: 0.0,
            acceleration_noise: 0.0,
            velocity_noise: None,
            area_per_mass: None,
            displacement_lines: Vec::new(),
            acceleration_lines: Vec::new(),
            seed: 1,
        }
    }
}

impl SensorModel {
    /// The paper's laboratory: 0.04 mm LVDT, 0.02 g accelerometer, and a mains hum with a saw-tooth on both lines. The
    /// paper gives no amplitude of either; here they are half a step of the LVDT and half the accelerometer's noise,
    /// at New Zealand's 50 Hz and at twice that, where rectifiers work.
    pub fn laboratory(seed: u64) -> Self {
        let (step, noise) = (4e-5, 0.02 * GRAVITY);
        let lines = |amplitude: f64| {
            vec![
                Line { shape: Shape::Sine, frequency_hz: 50.0, amplitude },
                Line { shape: Shape::SawTooth, frequency_hz: 100.0, amplitude: 0.5 * amplitude },
            ]
        };
        Self {
            displacement_step: step,
            acceleration_noise: noise,
            displacement_lines: lines(0.5 * step),
            acceleration_lines: lines(0.5 * noise),
            seed,
            ..Self::default()
        }
    }

    /// Whether LVDT and accelerometer read what is true.
    fn exact(&self) -> bool {
        let silent = self.displacement_lines.is_empty() && self.acceleration_lines.is_empty();
        silent && self.displacement_step == 0.0 && self.acceleration_noise == 0.0
    }

    /// Standard deviations of LVDT (m) and accelerometer (m/s2), steps and lines among them.
    fn deviations(&self) -> (f64, f64) {
        let of = |white: f64, lines: &[Line]| lines.iter().map(Line::square).fold(white * white, |a, b| a + b).sqrt();
        let step = self.displacement_step / 12_f64.sqrt();
        (of(step, &self.displacement_lines), of(self.acceleration_noise, &self.acceleration_lines))
    }

    /// Checks every number.
    pub fn validate(&self) -> Result<(), ParameterError> {
        not_negative("displacement_step", self.displacement_step)?;
        not_negative("acceleration_noise", self.acceleration_noise)?;
        not_negative("velocity_noise", self.velocity_noise.unwrap_or(0.0))?;
        positive("area_per_mass", self.area_per_mass.unwrap_or(1.0))?;
        finite("area_per_mass", self.area_per_mass.unwrap_or(1.0))?;
        self.displacement_lines.iter().chain(&self.acceleration_lines).try_for_each(|line| {
            not_negative("frequency_hz", line.frequency_hz)?;
            finite("amplitude", line.amplitude)
        })
    }
}

/// One periodic disturbance of zero mean.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// Its shape.
    pub shape: Shape,
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// Its peak, in the unit of the channel.
    pub amplitude: f64,
}

/// Shape of a periodic disturbance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// A sine.
    Sine,
    /// A rising saw-tooth.
    SawTooth,
}

impl Line {
    /// Its mean square.
    fn square(&self) -> f64 {
        let share = if self.shape == Shape::Sine { 0.5 } else { 1.0 / 3.0 };
        share * self.amplitude * self.amplitude
    }

    /// Value at `cycles` periods from its zero.
    fn at(&self, cycles: f64) -> f64 {
        self.amplitude
            * match self.shape {
                Shape::Sine => (TAU * cycles).sin(),
                Shape::SawTooth => 2.0 * (cycles - (cycles + 0.5).floor()),
            }
    }
}

/// Sensors at work: the model, its generator and the lines' phases.
#[derive(Debug, Clone)]
pub struct Sensors {
    model: SensorModel,
    generator: ChaCha8Rng,
    spare: Option<f64>,
    displacement_phases: Vec<f64>,
    acceleration_phases: Vec<f64>,
    /// What a velocity is derived with, from the first reading on.
    observer: Option<(MotionObserver, MotionState)>,
}

impl Sensors {
    /// Sensors as `model` describes them, at the start of their noise.
    pub fn new(model: SensorModel) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(model.seed);
        let mut phases = |lines: &[Line]| lines.iter().map(|_| uniform(&mut generator)).collect::<Vec<_>>();
        let displacement_phases = phases(&model.displacement_lines);
        let acceleration_phases = phases(&model.acceleration_lines);
        Self { model, generator, spare: None, displacement_phases, acceleration_phases, observer: None }
    }

    /// What the LVDT reads at `time` (s) where the table is at `x` (m): `step floor(x / step + 1/2)`.
    #[inline]
    pub fn displacement(&mut self, time: f64, x: f64) -> f64 {
        let x = x + sum(&self.model.displacement_lines, &self.displacement_phases, time);
        let step = self.model.displacement_step;
        if step > 0.0 { step * (x / step + 0.5).floor() } else { x }
    }

    /// What the accelerometer reads at `time` (s) where the table accelerates at `a` (m/s2).
    #[inline]
    pub fn acceleration(&mut self, time: f64, a: f64) -> f64 {
        let a = a + sum(&self.model.acceleration_lines, &self.acceleration_phases, time);
        let noise = self.model.acceleration_noise;
        if noise > 0.0 { a + noise * self.normal() } else { a }
    }

    /// What is known of the velocity where the table moves at `v` (m/s) and LVDT (m) and accelerometer (m/s2) read `seen`, at
    /// `rate` readings a second (Hz): a transducer's reading, or what the core's observer makes of the other two.
    #[inline]
    pub fn velocity(&mut self, v: f64, seen: (f64, f64), rate: f64) -> f64 {
        match self.model.velocity_noise {
            Some(noise) if noise > 0.0 => v + noise * self.normal(),
            None if !self.model.exact() => self.observed(seen, rate).unwrap_or(v),
            _ => v,
        }
    }

    /// The velocity that a Kalman observer for these sensors' noise derives; none at a rate that it cannot have.
    fn observed(&mut self, (displacement, acceleration): (f64, f64), rate: f64) -> Option<f64> {
        let (x, a) = (displacement as f32, acceleration as f32);
        if self.observer.is_none() {
            let noise = self.model.deviations();
            let (of_x, of_a) = (noise.0.clamp(1e-9, 0.01), noise.1.clamp(1e-4, 1000.0));
            let observer = MotionObserver::kalman(of_x as f32, of_a as f32, (1.0 / rate) as f32).ok()?;
            self.observer = Some((observer, MotionState::at(x)));
        }
        let (observer, state) = self.observer.as_mut()?;
        observer.advance(state, x, a);
        Some(f64::from(state.velocity))
    }

    /// What a sensor of the pressure difference reads, Pa, under a `load` of this acceleration of the table, m/s2.
    pub fn pressure_difference(&self, load: f64) -> f64 {
        self.model.area_per_mass.map_or(f64::NAN, |area| load / area)
    }

    /// A standard normal number (Box and Muller's pair, the second kept for the next call).
    fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * (1.0 - uniform(&mut self.generator)).ln()).sqrt();
        let (sine, cosine) = (TAU * uniform(&mut self.generator)).sin_cos();
        self.spare = Some(radius * sine);
        radius * cosine
    }
}

/// The lines' sum at `time`.
#[inline]
fn sum(lines: &[Line], phases: &[f64], time: f64) -> f64 {
    lines.iter().zip(phases).map(|(line, phase)| line.at(line.frequency_hz * time + phase)).sum()
}

/// Uniform in [0, 1), 53 bits.
fn uniform(generator: &mut ChaCha8Rng) -> f64 {
    (generator.next_u64() >> 11) as f64 / 9_007_199_254_740_992.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ideal_sensors_change_nothing() {
        let mut sensors = Sensors::new(SensorModel::default());
        assert_eq!(sensors.displacement(0.3, 0.012_345), 0.012_345);
        assert_eq!(sensors.acceleration(0.3, -1.5), -1.5);
    }

    #[test]
    fn lvdt_rounds_to_its_step() {
        let mut sensors = Sensors::new(SensorModel { displacement_step: 4e-5, ..SensorModel::default() });
        for x in [0.0, 1.9e-5, 2.1e-5, -2.1e-5, 0.1] {
            let read = sensors.displacement(0.0, x);
            assert!((read - x).abs() <= 2e-5 + 1e-15);
            assert!((read / 4e-5 - (read / 4e-5).round()).abs() < 1e-9);
        }
        assert_eq!(sensors.displacement(0.0, 1.9e-5), 0.0);
        assert_eq!(sensors.displacement(0.0, 2.1e-5), 4e-5);
    }

    #[test]
    fn noise_has_its_standard_deviation_and_repeats_with_its_seed() {
        let model = SensorModel { acceleration_noise: 0.2, seed: 7, ..SensorModel::default() };
        let draw = |model: &SensorModel| {
            let mut sensors = Sensors::new(model.clone());
            (0..40_000).map(|_| sensors.acceleration(0.0, 0.0)).collect::<Vec<f64>>()
        };
        let (first, again) = (draw(&model), draw(&model));
        assert_eq!(first, again);
        assert_ne!(first, draw(&SensorModel { seed: 8, ..model }));
        let mean = first.iter().sum::<f64>() / 40_000.0;
        let deviation = (first.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / 40_000.0).sqrt();
        assert!(mean.abs() < 4.0 * 0.2 / 200.0, "{mean}");
        assert!((deviation / 0.2 - 1.0).abs() < 4.0 / (2.0 * 40_000.0f64).sqrt(), "{deviation}");
    }

    #[test]
    fn lines_have_zero_mean_and_their_peak() {
        for shape in [Shape::Sine, Shape::SawTooth] {
            let line = Line { shape, frequency_hz: 50.0, amplitude: 3.0 };
            let values: Vec<f64> = (0..1000).map(|i| line.at((f64::from(i) + 0.5) / 1000.0)).collect();
            assert!((values.iter().sum::<f64>() / 1000.0).abs() < 1e-12);
            let peak = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            assert!((2.99..=3.0).contains(&peak), "{peak}");
        }
    }

    /// A run with sensors has no other velocity than these show: derived from LVDT and accelerometer, near the truth and not the
    /// truth; a transducer's with its own noise; exact where they are ideal.
    #[test]
    fn velocity_is_what_the_sensors_show() {
        let deviation = |model: SensorModel| {
            let mut sensors = Sensors::new(model);
            let (mut squares, mut counted) = (0.0, 0.0);
            for k in 0..6000 {
                let t = f64::from(k) * 1e-3;
                let (x, v, a) = (0.05 * (6.0 * t).sin(), 0.3 * (6.0 * t).cos(), -1.8 * (6.0 * t).sin());
                let seen = (sensors.displacement(t, x), sensors.acceleration(t, a));
                let read = sensors.velocity(v, seen, 1000.0);
                if k > 2000 {
                    squares += (read - v).powi(2);
                    counted += 1.0;
                }
            }
            (squares / counted).sqrt()
        };
        assert_eq!(deviation(SensorModel::default()), 0.0);
        let derived = deviation(SensorModel::laboratory(1));
        assert!(derived > 1e-4 && derived < 0.02, "{derived} m/s");
        let transducer = deviation(SensorModel { velocity_noise: Some(0.01), ..SensorModel::default() });
        assert!((transducer / 0.01 - 1.0).abs() < 0.05, "{transducer} m/s");
    }

    #[test]
    fn a_pressure_is_the_load_by_the_area_that_is_stated() {
        let sensors = |area_per_mass| Sensors::new(SensorModel { area_per_mass, ..SensorModel::default() });
        assert_eq!(sensors(Some(2e-5)).pressure_difference(3.0), 1.5e5);
        assert!(sensors(None).pressure_difference(3.0).is_nan());
        let refused = SensorModel { area_per_mass: Some(0.0), ..SensorModel::default() }.validate();
        assert!(refused.unwrap_err().to_string().contains("area_per_mass"));
    }
}
