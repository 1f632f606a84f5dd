//! The controllers that recordings state: plain laws with no limits and no anti-windup.

use crate::scalar::Scalar;

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

    /// Standard deviation of the command (unit of u) that white noise of the displacement sensor (m) causes, at a
    /// controller period of `tick` seconds.
    pub fn command_noise(&self, sensor_noise: f64, tick: f64) -> f64 {
        match *self {
            Self::Pi { kp, .. } => kp.abs() * sensor_noise,
            Self::Cascade { kp, kv } => (kv * sensor_noise).abs() * ((kp + 1.0 / tick).powi(2) + tick.powi(-2)).sqrt(),
            Self::Recorded => 0.0,
        }
    }

    /// 1 where the input is interpolated between samples, 0 where it is held.
    pub(super) fn between_samples(&self) -> f64 {
        if matches!(self, Self::Recorded) { 0.0 } else { 1.0 }
    }

    /// The law at the start of a run, run every `tick` seconds.
    pub(super) fn begin<S: Scalar>(self, tick: f64) -> Running<S> {
        Running { law: self, tick, sum: S::from(0.0), before: None }
    }
}

/// A law on its way through a run.
#[derive(Debug, Clone)]
pub(super) struct Running<S> {
    law: Law,
    tick: f64,
    sum: S,
    before: Option<S>,
}

impl<S: Scalar> Running<S> {
    /// One tick: input and measured displacement in, command out.
    pub(super) fn step(&mut self, input: f64, displacement: S) -> S {
        let error = -displacement + input;
        match self.law {
            Law::Pi { kp, ki } => {
                self.sum += error;
                error * kp + self.sum * (ki * self.tick)
            }
            Law::Cascade { kp, kv } => {
                let velocity = (displacement - self.before.unwrap_or(displacement)) / self.tick;
                self.before = Some(displacement);
                (error * kp - velocity) * kv
            }
            Law::Recorded => S::from(input),
        }
    }
}
