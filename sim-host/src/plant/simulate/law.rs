//! The controllers that recordings state: plain laws with no limits and no anti-windup.

use crate::scalar::Scalar;
use std::collections::VecDeque;

/// The controller that ran.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
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

impl Law {
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

    /// The law at the start of a run that begins with this velocity (m/s), run every `tick` seconds.
    /// Its commands come `late` ticks after what they answer.
    pub(super) fn begin<S: Scalar>(self, tick: f64, late: usize, velocity: S) -> Running<S> {
        let waiting = std::iter::repeat_n(S::from(0.0), late).collect();
        Running { law: self, tick, sum: S::from(0.0), velocity, before: None, waiting }
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
    law: Law,
    tick: f64,
    sum: S,
    /// Velocity before the first tick, m/s.
    velocity: S,
    before: Option<S>,
    /// Commands on their way.
    waiting: VecDeque<S>,
}

impl<S: Scalar> Running<S> {
    /// One tick: input and measured displacement in, command out.
    pub(super) fn step(&mut self, input: f64, displacement: S) -> S {
        let command = self.answer(input, displacement);
        if self.waiting.is_empty() {
            return command;
        }
        self.waiting.push_back(command);
        self.waiting.pop_front().unwrap_or(command)
    }

    fn answer(&mut self, input: f64, displacement: S) -> S {
        let error = -displacement + input;
        match self.law {
            Law::Pi { kp, ki } => {
                self.sum += error;
                error * kp + self.sum * (ki * self.tick)
            }
            Law::Cascade { kp, kv } => {
                let velocity = self.before.map_or(self.velocity, |before| (displacement - before) / self.tick);
                self.before = Some(displacement);
                (error * kp - velocity) * kv
            }
            Law::Recorded => S::from(input),
        }
    }
}
