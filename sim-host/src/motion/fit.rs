//! Records fitted to a table's limits, offline.
//!
//! The velocity v of the fitted motion is linear between samples, its acceleration piecewise constant, its displacement
//! their exact integral. Given up is e = r - v, r being the reference's velocity, and the acceleration error is e'.
//! Every fit starts at rest at the reference's first displacement and ends at rest where [`Limits::end`] says.
//!
//! - [`taut`]: the velocity limit alone. Least acceleration error in a tube is the taut string, found in one pass.
//! - [`convex`]: displacement, acceleration, jerk and the force-dependent flow limit too, as a quadratic or cone program.
//! - [`spectrum`]: keeps the response spectrum over a band of periods rather than the waveform.
//! - [`online`]: the core's own modifiers, run over a record.
//! - [`method`]: all of them, from a motion to the motion that is written; [`named`]: by the names that users give.
//! - [`certificate`]: what was given up and where, a proof that no motion does better, and the smallest relaxation that
//!   would meet a target.

pub(crate) mod answer;
pub mod certificate;
pub mod convex;
pub(crate) mod method;
pub(crate) mod named;
pub mod online;
pub(crate) mod spectrum;
pub mod taut;

pub use convex::Norm;

/// The motion asked for, by its velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Sampling interval, s.
    pub dt: f64,
    /// Velocity, m/s.
    pub velocity: Vec<f64>,
    /// Displacement at the first sample, m.
    pub start: f64,
}

/// What the table allows. What is `None` does not bind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest speed, m/s.
    pub velocity: f64,
    /// Largest displacement from centre, m.
    pub stroke: Option<f64>,
    /// Largest acceleration, m/s2.
    pub acceleration: Option<f64>,
    /// Largest jerk, m/s3.
    pub jerk: Option<f64>,
    /// Acceleration at which the actuator stalls, A `p_s` / m in m/s2: the flow that remains under load is
    /// v^2 <= `velocity`^2 (1 - |a| / stall), the safe convex form of the load-dependent flow limit.
    pub stall: Option<f64>,
    /// Displacement at the last sample, m; `None` leaves it free.
    pub end: Option<f64>,
}

impl Limits {
    /// A velocity limit, m/s, and nothing else.
    pub fn velocity(velocity: f64) -> Self {
        Self { velocity, stroke: None, acceleration: None, jerk: None, stall: None, end: None }
    }

    /// Velocity, m/s, and stroke, m; the motion ends at the centre.
    pub fn table(velocity: f64, stroke: f64) -> Self {
        Self { stroke: Some(stroke), end: Some(0.0), ..Self::velocity(velocity) }
    }

    /// Every limit by its name, in the order of the fields, `None` where it does not bind.
    pub fn named(&self) -> [(&'static str, Option<f64>); 5] {
        [
            ("velocity", Some(self.velocity)),
            ("stroke", self.stroke),
            ("acceleration", self.acceleration),
            ("jerk", self.jerk),
            ("stall", self.stall),
        ]
    }

    /// Refuses limits that are not positive numbers, and an end outside the stroke.
    pub fn check(&self, reference: &Reference) -> Result<(), FitError> {
        for (name, value) in self.named() {
            if let Some(value) = value
                && !(value.is_finite() && value > 0.0)
            {
                return Err(FitError::Limit { name, value });
            }
        }
        let stroke = self.stroke.unwrap_or(f64::INFINITY);
        for (place, value) in [("start", Some(reference.start)), ("end", self.end)] {
            if let Some(value) = value
                && (value.is_nan() || value.abs() > stroke)
            {
                return Err(FitError::OutsideStroke { place, value, stroke });
            }
        }
        Ok(())
    }
}

/// Why a fit could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// A limit makes no sense.
    #[error("the {name} limit is {value}; it has to be a positive number")]
    Limit {
        /// Which limit.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// The motion would have to start or end outside the stroke.
    #[error("the {place} of the motion, {value} m, lies outside the stroke of {stroke} m")]
    OutsideStroke {
        /// `start` or `end`.
        place: &'static str,
        /// Where, m.
        value: f64,
        /// The stroke, m.
        stroke: f64,
    },
    /// The reference is too short, or not made of numbers.
    #[error("the reference is not usable: {0}")]
    Reference(String),
    /// No motion satisfies the limits.
    #[error("no motion keeps within the limits: {0}")]
    Infeasible(String),
    /// A band of periods makes no sense.
    #[error("the spectrum's band is not usable: {0}")]
    Band(String),
    /// The solver gave up.
    #[error("the solver stopped without an answer: {0}")]
    Solver(String),
    /// An online modifier refused its settings.
    #[error("the online modifier refused {0}")]
    Online(String),
}

/// A fitted motion by its velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// Velocity, m/s, at the reference's samples.
    pub velocity: Vec<f64>,
    /// No motion within the limits has a lower objective than this, proven by weak duality whatever the solver did;
    /// `None` where the method proves nothing.
    pub bound: Option<f64>,
}

impl Reference {
    /// A reference of at least three samples, all of them numbers.
    pub fn new(dt: f64, velocity: Vec<f64>, start: f64) -> Result<Self, FitError> {
        if velocity.len() < 3 {
            return Err(FitError::Reference(format!("{} samples; at least 3 are needed", velocity.len())));
        }
        if !(dt.is_finite() && dt > 0.0) {
            return Err(FitError::Reference(format!("a sampling interval of {dt} s")));
        }
        if let Some(k) = velocity.iter().position(|v| !v.is_finite()) {
            return Err(FitError::Reference(format!("sample {k} of the velocity is {}", velocity[k])));
        }
        Ok(Self { dt, velocity, start })
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.velocity.len()
    }

    /// Never true: a reference has three samples at least.
    pub fn is_empty(&self) -> bool {
        self.velocity.is_empty()
    }

    /// Displacement at the samples, m, of a motion with this `velocity`, m/s, from this reference's start.
    pub fn displacement(&self, velocity: &[f64]) -> Vec<f64> {
        let mut x = self.start;
        let mut before = velocity.first().copied().unwrap_or(0.0);
        velocity
            .iter()
            .map(|&v| {
                x += 0.5 * self.dt * (before + v);
                before = v;
                x
            })
            .collect()
    }

    /// Relative error of the acceleration, E_a unsquared and without shift: |r' - v'| / |r'|; 0 where nothing moves.
    pub fn acceleration_error(&self, velocity: &[f64]) -> f64 {
        let (mut error, mut whole) = (0.0, 0.0);
        for (r, v) in self.velocity.windows(2).zip(velocity.windows(2)) {
            let asked = r[1] - r[0];
            error += (asked - (v[1] - v[0])).powi(2);
            whole += asked.powi(2);
        }
        if whole > 0.0 { (error / whole).sqrt() } else { 0.0 }
    }
}

/// Largest magnitude of the slope of a signal.
pub(crate) fn steepest(signal: &[f64], dt: f64) -> f64 {
    signal.windows(2).map(|w| (w[1] - w[0]).abs() / dt).fold(0.0, f64::max)
}
