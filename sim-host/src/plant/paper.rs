//! The paper's plant: Eq. 7 in series with the velocity limiter of Fig. 7.
//!
//! ```text
//! z' = -a1 z + (b0 - b1 a1) u      w = z + b1 u      G(s) = (b1 s + b0) / (s^2 + a1 s)
//! v  = clamp(w, -v_max, +v_max)    x' = v
//! ```
//! The pole of G at zero and the limiter's integrator are one state, so no differentiator is needed. Positive command
//! moves the table toward positive x. With the command held, w approaches `b0 u / a1` as one exponential; it is
//! monotone, so it crosses each limit at most once, and x is the integral of at most three pieces, each in closed form.
//! Nothing here is approximated: steps of any length give the same motion.

use super::Plant;

/// The parameters of Eq. 7 and of the limiter.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Paper {
    /// Direct feed of the command into velocity, 1/s.
    pub b1: f64,
    /// Gain, 1/s2; `b0 / a1` is the velocity per metre of command that the table settles to.
    pub b0: f64,
    /// Pole, 1/s.
    pub a1: f64,
    /// Largest speed, m/s; infinite for the linear plant.
    pub velocity_limit: f64,
}

impl Default for Paper {
    /// The University of Canterbury's table: Eq. 7 and 0.242 m/s.
    fn default() -> Self {
        Self { b1: 0.69, b0: 138.0, a1: 57.65, velocity_limit: 0.242 }
    }
}

/// Why parameters were refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// A parameter must be a positive number.
    #[error("{name} = {value}: it must be a number above zero")]
    NotPositive {
        /// The parameter's name.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// A parameter must not be negative, and finite.
    #[error("{name} = {value}: it must be zero or more, and finite")]
    Negative {
        /// The parameter's name.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// A parameter must be finite.
    #[error("{name} = {value}: it must be a finite number")]
    NotFinite {
        /// The parameter's name.
        name: &'static str,
        /// What was given.
        value: f64,
    },
}

/// Refuses a parameter that is not a number above zero; infinity passes.
pub(super) fn positive(name: &'static str, value: f64) -> Result<(), ParameterError> {
    if value > 0.0 { Ok(()) } else { Err(ParameterError::NotPositive { name, value }) }
}

/// Refuses a parameter that is infinite or not a number.
pub(super) fn finite(name: &'static str, value: f64) -> Result<(), ParameterError> {
    if value.is_finite() { Ok(()) } else { Err(ParameterError::NotFinite { name, value }) }
}

/// Refuses a parameter that is negative, infinite or not a number.
pub(super) fn not_negative(name: &'static str, value: f64) -> Result<(), ParameterError> {
    if value >= 0.0 && value.is_finite() { Ok(()) } else { Err(ParameterError::Negative { name, value }) }
}

/// Where the plant is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Lagged part of the velocity, z, m/s.
    pub lag: f64,
    /// Displacement, m.
    pub displacement: f64,
}

impl Paper {
    /// Checks every parameter.
    pub fn validate(&self) -> Result<(), ParameterError> {
        finite("b1", self.b1)?;
        finite("b0", self.b0)?;
        finite("a1", self.a1)?;
        positive("a1", self.a1)?;
        positive("velocity_limit", self.velocity_limit)
    }

    /// Velocity of the table with `command` (m) acting, m/s.
    pub fn velocity(&self, state: State, command: f64) -> f64 {
        (state.lag + self.b1 * command).clamp(-self.velocity_limit, self.velocity_limit)
    }

    /// The state after `dt` seconds with `command` (m) held, exactly.
    pub fn advance(&self, state: State, command: f64, dt: f64) -> State {
        let decay = Decay {
            rate: self.a1,
            end: self.b0 / self.a1 * command,
            excess: state.lag + self.b1 * command - self.b0 / self.a1 * command,
        };
        State {
            lag: decay.end + decay.excess * (-self.a1 * dt).exp() - self.b1 * command,
            displacement: state.displacement + decay.limited_travel(dt, self.velocity_limit),
        }
    }
}

/// `w(t) = end + excess exp(-rate t)`: the velocity ahead of the limiter while the command is held.
#[derive(Debug, Clone, Copy)]
struct Decay {
    rate: f64,
    end: f64,
    excess: f64,
}

impl Decay {
    fn at(&self, t: f64) -> f64 {
        self.end + self.excess * (-self.rate * t).exp()
    }

    /// Integral of w from `from` to `to`.
    fn travel(&self, from: f64, to: f64) -> f64 {
        let lost = -(-self.rate * (to - from)).exp_m1() / self.rate;
        self.end * (to - from) + self.excess * (-self.rate * from).exp() * lost
    }

    /// When w passes `level`, held within [0, `dt`] against rounding.
    fn crossing(&self, level: f64, dt: f64) -> f64 {
        ((self.excess / (level - self.end)).ln() / self.rate).clamp(0.0, dt)
    }

    /// Integral over [0, `dt`] of w held within `limit`: a stretch at one limit, one between, one at a limit.
    fn limited_travel(&self, dt: f64, limit: f64) -> f64 {
        let (first, last) = (self.at(0.0), self.at(dt));
        if first.min(last) >= limit || first.max(last) <= -limit {
            return first.clamp(-limit, limit) * dt;
        }
        let enters = if first.abs() > limit { self.crossing(limit.copysign(first), dt) } else { 0.0 };
        let leaves = if last.abs() > limit { self.crossing(limit.copysign(last), dt) } else { dt };
        first.clamp(-limit, limit) * enters + self.travel(enters, leaves) + last.clamp(-limit, limit) * (dt - leaves)
    }
}

/// The plant at a fixed step: what is constant is worked out once, so that a step away from the limits' edges costs
/// a handful of multiplications. The same answers as [`Paper::advance`] up to rounding.
#[derive(Debug, Clone)]
pub struct FixedStep {
    paper: Paper,
    dt: f64,
    /// `exp(-a1 dt)`.
    kept: f64,
    /// `(1 - exp(-a1 dt)) / a1`, s.
    lost: f64,
    /// `b0 / a1`, 1/s.
    gain: f64,
    state: State,
}

impl FixedStep {
    /// The plant at rest at `displacement` (m), to be moved on in steps of `dt` seconds.
    pub fn new(paper: Paper, dt: f64, displacement: f64) -> Result<Self, ParameterError> {
        paper.validate()?;
        positive("dt", dt)?;
        finite("dt", dt)?;
        finite("displacement", displacement)?;
        let (kept, lost) = ((-paper.a1 * dt).exp(), -(-paper.a1 * dt).exp_m1() / paper.a1);
        let state = State { lag: 0.0, displacement };
        Ok(Self { paper, dt, kept, lost, gain: paper.b0 / paper.a1, state })
    }

    /// Where the plant is.
    pub fn state(&self) -> State {
        self.state
    }

    /// The parameters.
    pub fn parameters(&self) -> &Paper {
        &self.paper
    }
}

impl Plant for FixedStep {
    fn step_length(&self) -> f64 {
        self.dt
    }

    #[inline]
    fn advance(&mut self, command: f64, steps: usize) {
        let (limit, end) = (self.paper.velocity_limit, self.gain * command);
        let (at_end, at_limit) = (end * self.dt, limit * self.dt);
        let mut excess = self.state.lag + self.paper.b1 * command - end;
        let mut first = end + excess;
        let mut x = self.state.displacement;
        for _ in 0..steps {
            let next = excess * self.kept;
            let last = end + next;
            x += if first.abs() <= limit && last.abs() <= limit {
                at_end + excess * self.lost
            } else if first.min(last) >= limit {
                at_limit
            } else if first.max(last) <= -limit {
                -at_limit
            } else {
                Decay { rate: self.paper.a1, end, excess }.limited_travel(self.dt, limit)
            };
            (excess, first) = (next, last);
        }
        self.state = State { lag: first - self.paper.b1 * command, displacement: x };
    }

    fn displacement(&self) -> f64 {
        self.state.displacement
    }

    #[inline]
    fn velocity(&self, command: f64) -> f64 {
        self.paper.velocity(self.state, command)
    }

    #[inline]
    fn saturated(&self, command: f64) -> bool {
        (self.state.lag + self.paper.b1 * command).abs() >= self.paper.velocity_limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Classical Runge-Kutta on the equations as the paper writes them: the independent answer.
    fn runge_kutta(p: &Paper, mut s: State, u: f64, dt: f64, n: usize) -> State {
        let rate = |z: f64| -p.a1 * z + (p.b0 - p.b1 * p.a1) * u;
        let v = |z: f64| (z + p.b1 * u).clamp(-p.velocity_limit, p.velocity_limit);
        let h = dt / n as f64;
        for _ in 0..n {
            let k1 = rate(s.lag);
            let k2 = rate(s.lag + h / 2.0 * k1);
            let k3 = rate(s.lag + h / 2.0 * k2);
            let k4 = rate(s.lag + h * k3);
            s.displacement += h / 6.0 * (v(s.lag) + 4.0 * v(s.lag + h / 2.0 * k2) + v(s.lag + h * k3));
            s.lag += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        }
        s
    }

    proptest! {
        #[test]
        fn closed_form_agrees_with_runge_kutta(lag in -1.0..1.0f64, u in -0.5..0.5f64, dt in 1e-4..0.1f64) {
            let (paper, start) = (Paper::default(), State { lag, displacement: 0.01 });
            let exact = paper.advance(start, u, dt);
            let numeric = runge_kutta(&paper, start, u, dt, 4000);
            prop_assert!((exact.lag - numeric.lag).abs() < 1e-11);
            // A kink within a Runge-Kutta step costs it at most the slope's change times h^2.
            prop_assert!((exact.displacement - numeric.displacement).abs() < 1e-8);
        }

        #[test]
        fn one_long_step_is_many_short_ones(lag in -1.0..1.0f64, u in -0.5..0.5f64, n in 1usize..40) {
            let paper = Paper::default();
            let once = paper.advance(State { lag, displacement: 0.0 }, u, 1e-3 * n as f64);
            let mut fixed = FixedStep::new(paper, 1e-3, 0.0).unwrap();
            fixed.state.lag = lag;
            fixed.advance(u, n);
            prop_assert!((once.lag - fixed.state.lag).abs() < 1e-13);
            prop_assert!((once.displacement - fixed.state.displacement).abs() < 1e-13);
        }

        #[test]
        fn never_faster_than_the_limit(lag in -5.0..5.0f64, u in -5.0..5.0f64, dt in 1e-5..1.0f64) {
            let (paper, start) = (Paper::default(), State { lag, displacement: 0.0 });
            prop_assert!(paper.velocity(start, u).abs() <= 0.242);
            prop_assert!(paper.advance(start, u, dt).displacement.abs() <= 0.242 * dt * (1.0 + 1e-12));
        }
    }

    #[test]
    fn both_limits_crossed_in_one_step() {
        let (paper, start) = (Paper::default(), State { lag: 2.0, displacement: 0.0 });
        let exact = paper.advance(start, -1.0, 0.2);
        let numeric = runge_kutta(&paper, start, -1.0, 0.2, 200_000);
        assert!((exact.displacement - numeric.displacement).abs() < 1e-10);
    }

    #[test]
    fn parameters_are_checked() {
        let bad = Paper { a1: 0.0, ..Paper::default() };
        assert_eq!(bad.validate(), Err(ParameterError::NotPositive { name: "a1", value: 0.0 }));
        assert!(Paper { b0: f64::NAN, ..Paper::default() }.validate().is_err());
        assert!(Paper { velocity_limit: f64::INFINITY, ..Paper::default() }.validate().is_ok());
        assert!(FixedStep::new(Paper::default(), f64::INFINITY, 0.0).is_err());
    }
}
