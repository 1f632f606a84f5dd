//! Transducers: what they do to a signal before noise and counts.

use crate::ode::State;
use crate::plant::state as at;
use std::f64::consts::TAU;

const GRAVITY: f64 = 9.80665;

/// Imperfections of the transducers.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensors {
    /// Displacement conditioner's lag (s).
    pub displacement_lag: f64,
    /// Displacement sensor's curvature (1/m): `sin(c x)/c`, or `sinh` where it stretches.
    pub displacement_bend: f64,
    /// Accelerometer's lag (s).
    pub acceleration_lag: f64,
    /// Accelerometer's gain (1).
    pub acceleration_gain: f64,
    /// Accelerometer's offset (m/s2).
    pub acceleration_bias: f64,
    /// Table tilt per displacement (rad/m).
    pub tilt: f64,
    /// Pick-up from the mains.
    pub hum: Option<Hum>,
    /// Accelerometer bracket: frequency (Hz) and damping ratio (1).
    pub bracket: Option<(f64, f64)>,
    /// Loose connection: share of the accelerometer's signal lost in bursts (1).
    pub loose: f64,
}

impl Default for Sensors {
    fn default() -> Self {
        Self {
            displacement_lag: 0.0,
            displacement_bend: 0.0,
            acceleration_lag: 0.0,
            acceleration_gain: 1.0,
            acceleration_bias: 0.0,
            tilt: 0.0,
            hum: None,
            bracket: None,
            loose: 0.0,
        }
    }
}

/// Mains pick-up on the accelerometer's line: a fundamental, its third harmonic, and a slow change of size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hum {
    /// Frequency (Hz).
    pub frequency: f64,
    /// Amplitude (m/s2).
    pub amplitude: f64,
    /// Third harmonic over the fundamental (1).
    pub third: f64,
}

/// A second pole of each lag, as a share of the first, where the lag is long enough for a second one to matter (s).
const SECOND_POLE: f64 = 0.1;
const LONG: f64 = 2e-3;

impl Sensors {
    pub(super) fn derivative(&self, x: f64, table: f64, y: &State, dy: &mut State) {
        two_lags(self.displacement_lag, x, at::LVDT, y, dy);
        let mut v = table;
        if let Some((frequency, damping)) = self.bracket {
            let w = TAU * frequency;
            dy[at::BRACKET] = table - y[at::BRACKET + 1];
            dy[at::BRACKET + 1] = w * w * y[at::BRACKET] + 2.0 * damping * w * dy[at::BRACKET];
            v = y[at::BRACKET + 1];
        }
        two_lags(self.acceleration_lag, v, at::ACCELEROMETER, y, dy);
    }

    /// Velocity whose difference over a sample is what the accelerometer gives.
    pub(super) fn sensed_velocity(&self, table: f64, y: &State) -> f64 {
        if self.acceleration_lag > 0.0 {
            y[at::ACCELEROMETER + 1]
        } else if self.bracket.is_some() {
            y[at::BRACKET + 1]
        } else {
            table
        }
    }

    /// Displacement as the sensor gives it, before noise and counts (m).
    pub fn displacement(&self, y: &State) -> f64 {
        let x = if self.displacement_lag > 0.0 { y[at::LVDT + 1] } else { y[at::X] };
        let c = self.displacement_bend;
        if c > 0.0 {
            (c * x).sinh() / c
        } else if c < 0.0 {
            (c * x).sin() / c
        } else {
            x
        }
    }

    /// Acceleration as the sensor gives it, before noise (m/s2), from the mean over a sample, the displacement, the time
    /// (s) and the phase of the mains in this run (rad).
    pub fn acceleration(&self, mean: f64, x: f64, t: f64, phase: f64) -> f64 {
        let mut a = self.acceleration_gain * mean + self.acceleration_bias + GRAVITY * (self.tilt * x).sin();
        if let Some(hum) = &self.hum {
            let angle = TAU * hum.frequency * t + phase;
            let size = hum.amplitude * (1.0 + 0.05 * (TAU * 0.07 * t + 2.0 * phase).sin());
            a += size * (angle.sin() + hum.third * (3.0 * angle + phase).sin());
        }
        a
    }
}

fn two_lags(time: f64, input: f64, first: usize, y: &State, dy: &mut State) {
    if time > LONG {
        dy[first] = (input - y[first]) / (SECOND_POLE * time);
        dy[first + 1] = (y[first] - y[first + 1]) / time;
    } else if time > 0.0 {
        dy[first + 1] = (input - y[first + 1]) / time;
    }
}
