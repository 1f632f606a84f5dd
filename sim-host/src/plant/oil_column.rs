//! The paper's plant with the mass it carries: the flow drives the table through the spring of the oil column.
//!
//! ```text
//! a' = w_h^2 (v_q - v) - 2 zeta_h w_h a      v' = a      x' = v      w_h^2 = k_h / m      k_h = 4 beta A / L
//! ```
//! `v_q` is the velocity that the limited flow would give a stiff column, [`super::paper`]. The damping is the
//! cylinder's leakage, which fixes `2 zeta_h w_h` whatever the mass. The paper bolts 5 t to its 5 t table and sees its
//! Bode diagram unchanged: up to 6 Hz the column is nearly rigid. Here that is computed, not assumed. Exact for a flow
//! held over a step at its mean.

use super::Plant;
use super::paper::{FixedStep, Paper, ParameterError, finite, positive};

/// Oil column and mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Column {
    /// Stiffness of both oil columns together, N/m.
    pub stiffness: f64,
    /// Moving mass, kg.
    pub mass: f64,
    /// Twice damping ratio times natural frequency, 1/s; does not depend on the mass.
    pub damping_rate: f64,
}

impl Column {
    /// The paper's cylinder, 240 cm2 over a stroke of 0.3 m, in oil of 1e9 Pa, damped 10 % at 5 t; only the area is the
    /// paper's own figure, the others are usual ones.
    pub(crate) fn usual(mass: f64) -> Self {
        let stiffness = 4.0 * 1e9 * 0.024 / 0.3;
        Self { stiffness, mass, damping_rate: 2.0 * 0.1 * (stiffness / 5000.0f64).sqrt() }
    }

    /// Natural frequency, Hz.
    pub(crate) fn natural_frequency(&self) -> f64 {
        (self.stiffness / self.mass).sqrt() / std::f64::consts::TAU
    }
}

/// A loaded table at a fixed step.
#[derive(Debug, Clone)]
pub(crate) struct Loaded {
    flow: FixedStep,
    /// Natural frequency squared, 1/s2.
    square: f64,
    damping_rate: f64,
    /// One step of `(v - v_q, a)`, row by row.
    step: [[f64; 2]; 2],
    displacement: f64,
    velocity: f64,
    acceleration: f64,
}

impl Loaded {
    /// The loaded table at rest at centre, to be moved on in steps of `dt` seconds.
    pub(crate) fn new(paper: Paper, column: Column, dt: f64) -> Result<Self, ParameterError> {
        positive("stiffness", column.stiffness)?;
        finite("stiffness", column.stiffness)?;
        positive("mass", column.mass)?;
        finite("mass", column.mass)?;
        let square = column.stiffness / column.mass;
        let half = column.damping_rate / 2.0;
        // Light damping only: the closed form below is that of an oscillation.
        positive("w_h^2 - (damping_rate / 2)^2", square - half * half)?;
        let wd = (square - half * half).sqrt();
        let (sine, cosine) = (wd * dt).sin_cos();
        let kept = (-half * dt).exp();
        let step = [
            [kept * (cosine + half / wd * sine), kept * sine / wd],
            [-kept * square / wd * sine, kept * (cosine - half / wd * sine)],
        ];
        let flow = FixedStep::new(paper, dt, 0.0)?;
        let damping_rate = column.damping_rate;
        Ok(Self { flow, square, damping_rate, step, displacement: 0.0, velocity: 0.0, acceleration: 0.0 })
    }
}

impl Plant for Loaded {
    fn step_length(&self) -> f64 {
        self.flow.step_length()
    }

    fn advance(&mut self, command: f64, steps: usize) {
        let dt = self.flow.step_length();
        for _ in 0..steps {
            let before = self.flow.displacement();
            self.flow.advance(command, 1);
            let mean = (self.flow.displacement() - before) / dt;
            let (slip, a) = (self.velocity - mean, self.acceleration);
            let [[p, q], [r, s]] = self.step;
            let (next_slip, next_a) = (p * slip + q * a, r * slip + s * a);
            // The equation of a, integrated over the step, gives the integral of the slip.
            self.displacement += mean * dt - (next_a - a + self.damping_rate * (next_slip - slip)) / self.square;
            (self.velocity, self.acceleration) = (mean + next_slip, next_a);
        }
    }

    fn displacement(&self) -> f64 {
        self.displacement
    }

    fn velocity(&self, _command: f64) -> f64 {
        self.velocity
    }

    fn saturated(&self, command: f64) -> bool {
        self.flow.saturated(command)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runge-Kutta on the equations above for a flow that is a step: the linear oscillation after it.
    #[test]
    fn oscillation_agrees_with_runge_kutta() {
        let (column, dt) = (Column::usual(10_000.0), 1e-4);
        let mut plant = Loaded::new(Paper { velocity_limit: 0.242, ..Paper::default() }, column, dt).unwrap();
        // Deep in saturation the flow is a constant 0.242 m/s after the first step's ramp.
        plant.flow.advance(10.0, 1000);
        plant.advance(10.0, 1500);
        let (w2, c) = (column.stiffness / column.mass, column.damping_rate);
        let rate = |v: f64, a: f64| (a, w2 * (0.242 - v) - c * a);
        let (mut x, mut v, mut a, h) = (0.0, 0.0, 0.0, 1e-5);
        for _ in 0..15_000 {
            let k1 = rate(v, a);
            let k2 = rate(v + h / 2.0 * k1.0, a + h / 2.0 * k1.1);
            let k3 = rate(v + h / 2.0 * k2.0, a + h / 2.0 * k2.1);
            let k4 = rate(v + h * k3.0, a + h * k3.1);
            x += h * v + h * h / 6.0 * (k1.0 + k2.0 + k3.0);
            v += h / 6.0 * (k1.0 + 2.0 * (k2.0 + k3.0) + k4.0);
            a += h / 6.0 * (k1.1 + 2.0 * (k2.1 + k3.1) + k4.1);
        }
        assert!((plant.displacement() - x).abs() < 1e-9, "{} {x}", plant.displacement());
        assert!((plant.velocity(0.0) - v).abs() < 1e-8);
    }

    #[test]
    fn five_tonnes_more_lower_the_frequency_by_the_root_of_two() {
        let (empty, loaded) = (Column::usual(5000.0), Column::usual(10_000.0));
        assert!((empty.natural_frequency() / loaded.natural_frequency() - 2f64.sqrt()).abs() < 1e-12);
        assert!(empty.natural_frequency() > 30.0);
    }

    #[test]
    fn heavy_damping_is_refused() {
        let column = Column { damping_rate: 1e4, ..Column::usual(5000.0) };
        assert!(Loaded::new(Paper::default(), column, 1e-4).is_err());
    }
}
