//! What a file holds ([`Record`]) and what a table is asked to follow ([`Motion`]).

use super::peak;

/// The family of file formats a record came from and is written back in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// PEER `.AT2`, headers of the strong-motion database (before NGA) and of NGA.
    Peer,
    /// CSMIP (CDMG, CESMD) Volume 2, `.V2`.
    Csmip,
    /// COSMOS strong-motion data format, version 1.20, `.V2c`.
    Cosmos,
    /// GeoNet `.V2A`.
    GeoNet,
    /// K-NET and KiK-net ASCII.
    KNet,
    /// Columns of text.
    Columns,
    /// Made by [`super::generate`]; written as columns.
    Generated,
}

impl Format {
    /// The name people know the format by.
    pub fn name(self) -> &'static str {
        match self {
            Self::Peer => "PEER AT2",
            Self::Csmip => "CSMIP V2",
            Self::Cosmos => "COSMOS",
            Self::GeoNet => "GeoNet V2A",
            Self::KNet => "K-NET ASCII",
            Self::Columns => "columns of text",
            Self::Generated => "generated",
        }
    }
}

impl std::fmt::Display for Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// One thing a file's header states, in the file's own words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fact {
    /// What it is about, such as `station` or `peak acceleration`.
    pub key: &'static str,
    /// What the header says, unit included.
    pub value: String,
    /// The line it stands on, from 1.
    pub line: usize,
}

/// One component of a ground-motion record, sampled evenly.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// A short name, the file's stem.
    pub name: String,
    /// Sampling interval, s.
    pub dt: f64,
    /// Ground acceleration, m/s².
    pub acceleration: Vec<f64>,
    /// Which component of the ground motion, as the file says it; empty where it does not.
    pub component: String,
    /// The format of the file.
    pub format: Format,
    /// What the header states, in its order.
    pub facts: Vec<Fact>,
}

impl Record {
    /// What the header says under a key, the first where it says it twice.
    pub fn fact(&self, key: &str) -> Option<&str> {
        self.facts.iter().find(|f| f.key == key).map(|f| f.value.as_str())
    }

    /// Time from the first sample to the last, s.
    pub fn duration(&self) -> f64 {
        self.acceleration.len().saturating_sub(1) as f64 * self.dt
    }

    /// The motion from rest that this acceleration makes.
    pub fn motion(&self) -> Motion {
        Motion::from_acceleration(self.dt, self.acceleration.clone())
    }
}

/// Displacement, velocity and acceleration that belong together.
///
/// The acceleration is linear between samples, and velocity and displacement are its exact integrals:
/// ```text
/// v[k+1] = v[k] + dt (a[k] + a[k+1]) / 2
/// x[k+1] = x[k] + dt v[k] + dt^2 (2 a[k] + a[k+1]) / 6
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Sampling interval, s.
    pub dt: f64,
    /// Displacement, m.
    pub displacement: Vec<f64>,
    /// Velocity, m/s.
    pub velocity: Vec<f64>,
    /// Acceleration, m/s².
    pub acceleration: Vec<f64>,
}

impl Motion {
    /// The motion that an acceleration (m/s², every `dt` s) makes from rest at zero.
    pub fn from_acceleration(dt: f64, acceleration: Vec<f64>) -> Self {
        Self::from_state(dt, acceleration, 0.0, 0.0)
    }

    /// The motion that an acceleration (m/s², every `dt` s) makes from a displacement (m) and a velocity (m/s).
    pub fn from_state(dt: f64, acceleration: Vec<f64>, displacement: f64, velocity: f64) -> Self {
        let n = acceleration.len();
        let (mut x, mut v) = (Vec::with_capacity(n), Vec::with_capacity(n));
        let (mut xk, mut vk) = (displacement, velocity);
        for (k, &a) in acceleration.iter().enumerate() {
            x.push(xk);
            v.push(vk);
            let next = acceleration.get(k + 1).copied().unwrap_or(a);
            xk += dt * vk + dt * dt * (2.0 * a + next) / 6.0;
            vk += dt * (a + next) / 2.0;
        }
        Self { dt, displacement: x, velocity: v, acceleration }
    }

    /// The motion whose velocity (m/s, every `dt` s) is given, starting from a displacement (m).
    ///
    /// Velocity is linear between samples here, as a limiter leaves it: displacement is its trapezoidal integral and the
    /// acceleration of a sample the mean over the sample, `(v[k+1] - v[k-1]) / (2 dt)`, one-sided at the ends.
    pub fn from_velocity(dt: f64, velocity: Vec<f64>, displacement: f64) -> Self {
        let mut xk = displacement;
        let mut x = Vec::with_capacity(velocity.len());
        for (k, &v) in velocity.iter().enumerate() {
            x.push(xk);
            xk += dt * (v + velocity.get(k + 1).copied().unwrap_or(v)) / 2.0;
        }
        Self { dt, displacement: x, acceleration: central_difference(&velocity, dt), velocity }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.acceleration.len()
    }

    /// True where there is no sample.
    pub fn is_empty(&self) -> bool {
        self.acceleration.is_empty()
    }

    /// Time from the first sample to the last, s.
    pub fn duration(&self) -> f64 {
        self.len().saturating_sub(1) as f64 * self.dt
    }

    /// Times of the samples, s, from 0.
    pub fn time(&self) -> Vec<f64> {
        (0..self.len()).map(|k| k as f64 * self.dt).collect()
    }

    /// The mean acceleration over each interval between samples, `(v[k+1] - v[k]) / dt`, m/s²: one fewer than samples.
    /// Errors of motions whose velocity is limited are measured with it, for it is exact where velocity has corners.
    pub fn interval_acceleration(&self) -> Vec<f64> {
        self.velocity.windows(2).map(|w| (w[1] - w[0]) / self.dt).collect()
    }

    /// Largest magnitudes of displacement (m), velocity (m/s) and acceleration (m/s²).
    pub fn peaks(&self) -> (f64, f64, f64) {
        (peak(&self.displacement), peak(&self.velocity), peak(&self.acceleration))
    }

    /// Largest magnitudes of displacement (m) and velocity (m/s) between samples too, where the acceleration is linear: no
    /// finite difference of the displacement, at whatever rate it is sampled, is larger than that velocity.
    pub fn peaks_between(&self) -> (f64, f64) {
        let (mut far, mut fast, _) = self.peaks();
        for k in 1..self.len() {
            let (a, v) = (self.acceleration[k - 1], self.velocity[k - 1]);
            let slope = (self.acceleration[k] - a) / self.dt;
            let velocity = |t: f64| v + t * (a + t * slope / 2.0);
            // The velocity turns where the acceleration is zero, the displacement where the velocity is.
            let turn = -a / slope;
            let inside = |t: f64| (t > 0.0 && t < self.dt).then_some(t);
            if let Some(t) = inside(turn) {
                fast = fast.max(velocity(t).abs());
            }
            let spread = (turn * turn - 2.0 * v / slope).sqrt();
            let straight = if slope == 0.0 { -v / a } else { f64::NAN };
            for t in [turn - spread, turn + spread, straight].into_iter().filter_map(inside) {
                far = far.max((self.displacement[k - 1] + t * (v + t * (a / 2.0 + t * slope / 6.0))).abs());
            }
        }
        (far, fast)
    }

    /// The same motion, every quantity times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let times = |signal: &[f64]| signal.iter().map(|x| x * factor).collect();
        Self {
            dt: self.dt,
            displacement: times(&self.displacement),
            velocity: times(&self.velocity),
            acceleration: times(&self.acceleration),
        }
    }
}

/// The derivative of a signal by central differences, one-sided at its ends.
pub(crate) fn central_difference(signal: &[f64], dt: f64) -> Vec<f64> {
    let last = signal.len().saturating_sub(1);
    (0..signal.len())
        .map(|k| {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
            if after == before { 0.0 } else { (signal[after] - signal[before]) / ((after - before) as f64 * dt) }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_linear_acceleration_is_integrated_exactly() {
        let dt = 0.01;
        let motion = Motion::from_acceleration(dt, (0..=100).map(|k| 3.0 * f64::from(k) * dt).collect());
        assert!((motion.velocity[100] - 1.5).abs() < 1e-12, "{}", motion.velocity[100]);
        assert!((motion.displacement[100] - 0.5).abs() < 1e-12, "{}", motion.displacement[100]);
    }

    #[test]
    fn central_differences_are_exact_on_a_parabola() {
        let slope = central_difference(&(0..5).map(|k| f64::from(k * k)).collect::<Vec<_>>(), 1.0);
        assert_eq!(slope, [1.0, 2.0, 4.0, 6.0, 7.0]);
        assert_eq!(central_difference(&[1.0], 1.0), [0.0]);
    }

    proptest! {
        #[test]
        fn no_finer_sampling_finds_a_larger_peak(a in prop::collection::vec(-10.0..10.0f64, 2..60), start in -0.3..0.3f64) {
            let coarse = Motion::from_state(0.005, a.clone(), 0.01, start);
            let (far, fast) = coarse.peaks_between();
            let fine: Vec<f64> = super::super::resample::resample(
                &a, 0.005, 0.0001, super::super::resample::Interpolation::Linear);
            let fine = Motion::from_state(0.0001, fine, 0.01, start);
            let (x, v, _) = fine.peaks();
            prop_assert!(x <= far + 1e-12 && v <= fast + 1e-12, "{} {} {} {}", x, far, v, fast);
            // And it is a peak of the motion, not a bound above it.
            prop_assert!(far - x < 1e-7 && fast - v < 2e-5, "{} {} {} {}", x, far, v, fast);
        }

        #[test]
        fn integration_is_linear(a in prop::collection::vec(-10.0..10.0f64, 1..200), factor in -3.0..3.0f64) {
            let motion = Motion::from_acceleration(0.005, a.clone());
            let other = Motion::from_acceleration(0.005, a.iter().map(|x| x * factor).collect());
            let scaled = motion.scaled(factor);
            for (x, y) in scaled.displacement.iter().zip(&other.displacement) {
                prop_assert!((x - y).abs() < 1e-12);
            }
            prop_assert_eq!(motion.len(), a.len());
        }

        #[test]
        fn a_velocity_is_kept_and_its_displacement_is_its_integral(v in prop::collection::vec(-1.0..1.0f64, 2..100)) {
            let motion = Motion::from_velocity(0.1, v.clone(), 0.5);
            let area: f64 = v.windows(2).map(|w| 0.05 * (w[0] + w[1])).sum();
            prop_assert!((motion.displacement[v.len() - 1] - 0.5 - area).abs() < 1e-12);
            prop_assert_eq!(motion.velocity, v);
        }
    }
}
