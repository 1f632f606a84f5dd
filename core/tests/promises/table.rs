//! A table to try the core on: the paper's Eq. 7 with its limiter, sampled as the file formats say. The simulator has
//! its own, exact to its discrete equations; this one is kept apart so that neither vouches for the other.

use shakedown_core::Sample;

/// Plant steps a tick.
const STEPS: usize = 10;

/// The paper's table, with what a test may change about it.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    pub(crate) dt: f64,
    /// Velocity limits toward positive and negative displacement, m/s.
    pub(crate) limits: (f64, f64),
    /// Gain relative to the paper's, 1.
    pub(crate) gain: f64,
    /// A valve that no longer listens: it goes on with this command, m.
    pub(crate) stuck: Option<f64>,
    /// Whether oil reaches the valve; without it the table stands.
    pub(crate) oil: bool,
    /// Whether a hard-wired loop subtracts the LVDT.
    pub(crate) hardwired: bool,
    /// What the LVDT says to a loop behind the device, where it is not the truth, m.
    pub(crate) heard: Option<f64>,
    /// Standard deviation of the accelerometer's noise, m/s2, and the LVDT's step, m.
    pub(crate) noise: f64,
    pub(crate) step: f64,
    pub(crate) x: f64,
    pub(crate) v: f64,
    pub(crate) a: f64,
    z: f64,
    before: f64,
    seed: u64,
}

impl Table {
    pub(crate) fn new(rate: f64) -> Self {
        Self {
            dt: 1.0 / rate,
            limits: (0.242, 0.242),
            gain: 1.0,
            stuck: None,
            oil: true,
            hardwired: false,
            heard: None,
            noise: 0.0,
            step: 0.0,
            x: 0.0,
            v: 0.0,
            a: 0.0,
            z: 0.0,
            before: 0.0,
            seed: 1,
        }
    }

    /// The paper's sensors: 0.02 g and 0.04 mm.
    pub(crate) fn noisy(mut self) -> Self {
        self.noise = 0.196;
        self.step = 4e-5;
        self
    }

    pub(crate) fn at(mut self, x: f64) -> Self {
        self.x = x;
        self
    }

    /// What the sensors read now.
    pub(crate) fn sample(&mut self, reference: f64) -> Sample {
        let x = if self.step > 0.0 { self.step * (self.x / self.step + 0.5).floor() } else { self.x };
        let noise = self.noise * self.gaussian();
        Sample::new(reference as f32, x as f32, (self.a + noise) as f32)
    }

    /// What the LVDT says to a loop behind the device, m.
    pub(crate) fn lvdt(&self) -> f64 {
        self.heard.unwrap_or(self.x)
    }

    /// One tick under `output`, m.
    pub(crate) fn advance(&mut self, output: f64) {
        let (a1, b0, b1) = (57.65, 138.0 * self.gain, 0.69 * self.gain);
        let h = self.dt / STEPS as f64;
        let phi = (-a1 * h).exp();
        let v_before = self.before;
        let mut middle = self.v;
        for i in 0..STEPS {
            let u = self.stuck.unwrap_or(if self.hardwired { output - self.lvdt() } else { output });
            self.z = phi * self.z + (1.0 - phi) / a1 * (b0 - b1 * a1) * u;
            let flow = (self.z + b1 * u).clamp(-self.limits.1, self.limits.0);
            self.v = if self.oil { flow } else { 0.0 };
            self.x += h * self.v;
            if i == STEPS / 2 {
                middle = self.v;
            }
        }
        self.a = (middle - v_before) / self.dt;
        self.before = middle;
    }

    fn gaussian(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    fn uniform(&mut self) -> f64 {
        self.seed = self.seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.seed >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Any 32 bits as a number: subnormals, infinities and NaNs of every kind among them.
pub(crate) fn any_bits() -> impl proptest::strategy::Strategy<Value = f32> {
    use proptest::prelude::*;
    prop_oneof![
        4 => any::<u32>().prop_map(f32::from_bits),
        4 => -0.3..0.3f32,
        1 => Just(f32::NAN),
        1 => Just(f32::INFINITY),
        1 => Just(-0.0f32),
    ]
}

pub(crate) fn any_sample() -> impl proptest::strategy::Strategy<Value = Sample> {
    use proptest::prelude::*;
    proptest::array::uniform8(any_bits()).prop_map(|[reference, displacement, acceleration, external, v, p, rv, ra]| {
        Sample {
            reference,
            displacement,
            acceleration,
            external,
            velocity: v,
            pressure_difference: p,
            reference_velocity: rv,
            reference_acceleration: ra,
            ..Sample::default()
        }
    })
}
