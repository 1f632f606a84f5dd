//! The controllers that recordings state: plain laws with no limits and no anti-windup.

use super::Excitation;
use crate::scalar::Scalar;
use std::collections::VecDeque;

/// The controller that ran.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SimulatedLaw {
    /// `u[k] = kp e[k] + ki dt (e[0] + ... + e[k])`, `e = reference - displacement`.
    Pi {
        /// Proportional gain, unit of u per m.
        kp: f64,
        /// Integral gain, unit of u per m and s.
        ki: f64,
    },
    /// `u[k] = kv (kp e[k] - velocity[k])`, velocity being the backward difference of the measured displacement.
    Cascade {
        /// Outer gain, 1/s.
        kp: f64,
        /// Inner gain, unit of u per m/s.
        kv: f64,
    },
    /// The recorded command drives the model.
    Recorded,
}

impl SimulatedLaw {
    /// True where the loop is closed from a reference, false where a recorded command drives the model.
    pub fn simulates_reference(&self) -> bool {
        !matches!(self, Self::Recorded)
    }

    /// The same law with all that it sends times `factor`; a recorded command stays what it was.
    pub fn times(self, factor: f64) -> Self {
        match self {
            Self::Pi { kp, ki } => Self::Pi { kp: factor * kp, ki: factor * ki },
            Self::Cascade { kp, kv } => Self::Cascade { kp, kv: factor * kv },
            Self::Recorded => Self::Recorded,
        }
    }

    /// What white noise of the displacement sensor (m) makes of the command, at a controller period of `tick` seconds.
    pub fn noise(&self, sensor_noise: f64, tick: f64) -> CommandNoise {
        let (white, rate, damping) = match *self {
            Self::Pi { kp, .. } => (kp.abs() * sensor_noise, 0.0, 0.0),
            Self::Cascade { kp, kv } => ((kp * kv).abs() * sensor_noise, kv.abs() * sensor_noise, kv),
            Self::Recorded => (0.0, 0.0, 0.0),
        };
        CommandNoise { white, rate, damping, tick }
    }

    /// 1 where the input is interpolated between samples, 0 where it is held.
    pub(super) fn between_samples(&self) -> f64 {
        if matches!(self, Self::Recorded) { 0.0 } else { 1.0 }
    }

    /// The law at the start of a run that begins with this velocity (m/s), and what surrounds it.
    pub(super) fn begin<S: Scalar>(self, drive: &Excitation<'_>, velocity: S) -> Running<S> {
        let (tick, shaping) = (drive.dt / drive.ticks as f64, drive.shaping);
        let waiting = std::iter::repeat_n(S::from(shaping.integral), shaping.late_command).collect();
        let notch = shaping.notch.map(|notch| {
            let filter = NotchFilter::new(notch, tick);
            match shaping.notch_start {
                Some(outputs) => filter.having_given(outputs),
                None => filter.resting_at(S::from(shaping.integral)),
            }
        });
        Running {
            law: self,
            shaping,
            tick,
            sum: S::from(0.0),
            velocity,
            before: None,
            reference: None,
            waiting,
            seen: VecDeque::new(),
            notch,
            begins: drive.before.is_some(),
        }
    }
}

/// What surrounds a law: feed-forward, a notch behind it, and delays.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shaping {
    /// Feed-forward of the backward difference of the reference, unit of u s per m.
    pub kvf: f64,
    /// A notch that the whole command passes.
    pub notch: Option<Notch>,
    /// Ticks by which the command comes late.
    pub late_command: usize,
    /// Ticks by which the controller sees the displacement late.
    pub late_displacement: usize,
    /// What the integral of the error contributes to the command when the run begins, unit of u.
    pub integral: f64,
    /// How fast the reference moves when the run begins, m/s.
    pub reference_slope: f64,
    /// State of the notch when the run begins, as its outputs at the two ticks before, the latest first, with inputs of zero, unit of u;
    /// none where it rests at what the integral holds.
    pub notch_start: Option<[f64; 2]>,
}

/// A notch `(s^2 + 2 z d w s + w^2) / (s^2 + 2 z w s + w^2)`, made discrete by the bilinear rule with its centre kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Notch {
    /// Centre w / 2 pi, Hz.
    pub frequency: f64,
    /// Damping z, 1.
    pub damping: f64,
    /// Gain d at the centre, 1.
    pub depth: f64,
}

/// A notch on its way through a run.
#[derive(Debug, Clone)]
pub(crate) struct NotchFilter<S> {
    b: [f64; 3],
    a: [f64; 2],
    x: [S; 2],
    y: [S; 2],
}

impl<S: Scalar> NotchFilter<S> {
    /// At rest, run every `tick` seconds.
    pub(crate) fn new(notch: Notch, tick: f64) -> Self {
        let k = (std::f64::consts::PI * notch.frequency * tick).tan();
        let size = 1.0 + 2.0 * notch.damping * k + k * k;
        let narrow = 2.0 * notch.damping * notch.depth * k;
        let middle = 2.0 * (k * k - 1.0) / size;
        let zero = S::from(0.0);
        Self {
            b: [(1.0 + narrow + k * k) / size, middle, (1.0 - narrow + k * k) / size],
            a: [middle, (1.0 - 2.0 * notch.damping * k + k * k) / size],
            x: [zero; 2],
            y: [zero; 2],
        }
    }

    /// The same after it has stood at a value for long: its gain at rest is one.
    #[must_use]
    pub(crate) fn resting_at(self, value: S) -> Self {
        Self { x: [value; 2], y: [value; 2], ..self }
    }

    /// The same with these outputs at the last two ticks, the latest first, and inputs of zero.
    #[must_use]
    pub(crate) fn having_given(self, outputs: [f64; 2]) -> Self {
        Self { y: outputs.map(S::from), ..self }
    }

    /// One tick.
    pub(crate) fn step(&mut self, x: S) -> S {
        let y = x * self.b[0] + self.x[0] * self.b[1] + self.x[1] * self.b[2]
            - self.y[0] * self.a[0]
            - self.y[1] * self.a[1];
        self.x = [x, self.x[0]];
        self.y = [y, self.y[0]];
        y
    }
}

/// Noise that a loop passes on from its displacement sensor to the command, in standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommandNoise {
    /// Of what is proportional to the sensor's, unit of u.
    pub white: f64,
    /// Of what the rest is the backward difference a period of, unit of u times s.
    pub rate: f64,
    /// What the law feeds back of velocity, unit of u per m/s.
    pub damping: f64,
    /// Controller period, s.
    pub tick: f64,
}

impl CommandNoise {
    /// Standard deviation of the whole, unit of u.
    pub fn size(&self) -> f64 {
        let step = self.rate / self.tick;
        ((self.white + step).powi(2) + step.powi(2)).sqrt()
    }
}

/// A law on its way through a run.
#[derive(Debug, Clone)]
pub(super) struct Running<S> {
    law: SimulatedLaw,
    shaping: Shaping,
    tick: f64,
    sum: S,
    /// Velocity before the first tick, m/s.
    velocity: S,
    before: Option<S>,
    /// Reference at the tick before, m.
    reference: Option<f64>,
    /// Commands on their way.
    waiting: VecDeque<S>,
    /// Displacements on their way.
    seen: VecDeque<S>,
    notch: Option<NotchFilter<S>>,
    /// True until the first command of a run that begins in the middle of a motion.
    begins: bool,
}

impl<S: Scalar> Running<S> {
    /// One tick: input and measured displacement in, command out.
    pub(super) fn step(&mut self, input: f64, displacement: S) -> S {
        let displacement = self.seen_late(displacement);
        let mut command = self.answer(input, displacement);
        if self.shaping.kvf != 0.0 {
            let before = self.reference.replace(input).unwrap_or(input - self.shaping.reference_slope * self.tick);
            command += S::from(self.shaping.kvf * (input - before) / self.tick);
        }
        if let Some(notch) = &mut self.notch {
            command = notch.step(command);
        }
        if self.waiting.is_empty() {
            return command;
        }
        if self.begins {
            self.waiting.iter_mut().for_each(|waiting| *waiting = command);
        }
        self.begins = false;
        self.waiting.push_back(command);
        self.waiting.pop_front().unwrap_or(command)
    }

    fn seen_late(&mut self, displacement: S) -> S {
        if self.shaping.late_displacement == 0 {
            return displacement;
        }
        self.seen.push_back(displacement);
        if self.seen.len() > self.shaping.late_displacement + 1 {
            self.seen.pop_front();
        }
        self.seen.front().copied().unwrap_or(displacement)
    }

    fn answer(&mut self, input: f64, displacement: S) -> S {
        let error = -displacement + input;
        match self.law {
            SimulatedLaw::Pi { kp, ki } => {
                self.sum += error;
                error * kp + self.sum * (ki * self.tick) + self.shaping.integral
            }
            SimulatedLaw::Cascade { kp, kv } => {
                let velocity = self.before.map_or(self.velocity, |before| (displacement - before) / self.tick);
                self.before = Some(displacement);
                (error * kp - velocity) * kv
            }
            SimulatedLaw::Recorded => S::from(input),
        }
    }
}
