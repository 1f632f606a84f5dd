//! The oil column is a spring between piston flow and table mass.

use super::{Compliance, Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "oil_compliance",
    equation: "A p_L/m = p; p' = (w_h^2 (q/A - v) - 2 zeta_h w_h p)/(1 - s x - c x^2); v' = p - f",
    stage: Stage::Actuator,
    family: Family::OilColumn,
    parameters: &[
        Parameter {
            key: "frequency",
            unit: "Hz",
            rigid_unit: "Hz",
            meaning: "natural frequency of the table on the oil column",
            signal_scale: SignalScale::One,
            low: 3.0,
            high: 150.0,
            starts: &[8.0, 15.0, 28.0, 50.0, 90.0],
            positive: true,
            simple: Ends::High,
            role: Role::Shared,
        },
        Parameter {
            key: "damping",
            unit: "1",
            rigid_unit: "1",
            meaning: "damping ratio of that resonance",
            signal_scale: SignalScale::One,
            low: 0.005,
            high: 0.4,
            starts: &[0.2],
            positive: true,
            simple: Ends::Neither,
            role: Role::Shared,
        },
        Parameter {
            key: "stroke_slope",
            unit: "1/m",
            rigid_unit: "1/m",
            meaning: "what the stroke adds to the stiffness where the chambers are not alike: s",
            signal_scale: SignalScale::One,
            low: -20.0,
            high: 20.0,
            starts: &[0.0],
            positive: false,
            simple: Ends::Both,
            role: Role::Refined,
        },
        Parameter {
            key: "stroke_curvature",
            unit: "1/m2",
            rigid_unit: "1/m2",
            meaning: "what the stroke adds to the stiffness on either side, one over the square of half the cylinder's length: c",
            signal_scale: SignalScale::Curvature,
            low: 0.0,
            high: 0.7,
            starts: &[0.0],
            positive: false,
            simple: Ends::Low,
            role: Role::Refined,
        },
    ],
    kinds: &[Kind::Servo],
    frees: &[],
    signature: "a resonance between command and table, ringing after every sharp change",
    mistaken_for: &["payload_resonance", "base_compliance", "valve_lag", "command_delay"],
    test: "bare and loaded table, three stroke offsets; a floor accelerometer",
    order: Order::Fourth,
    contains: &[],
    counter: Some(|parameters, countered| {
        if let &[frequency, damping, ..] = parameters {
            countered.oil = Some((frequency, damping));
        }
    }),
};

/// A compressible oil column: two chambers that the piston makes shorter and longer, whose stiffness is least where they are alike.
///
/// Source: H. E. Merritt, "Hydraulic control systems", Wiley 1967, section 6-2: `4 beta_e/V_t` at mid-stroke, from the chambers' volumes
/// `V_1 = V_0 + A x` and `V_2 = V_0 - A x`.
#[derive(Debug, Clone)]
pub(crate) struct OilCompliance<S> {
    frequency: S,
    damping: S,
    chambers: Chambers<S>,
}

/// How the stroke changes the stiffness of the oil.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Chambers<S> {
    /// By which share it rises at first, 1/m.
    pub slope: S,
    /// The same per square, 1/m2.
    pub curvature: S,
}

/// Least share of a chamber's volume that is left: no piston goes nearer to its cylinder's end.
const LEFT: f64 = 0.2;

impl<S: Scalar> Chambers<S> {
    /// The stiffness at a displacement, m, over that at none.
    pub(crate) fn stiffened(&self, displacement: S) -> S {
        let left = S::from(1.0) - (self.slope + self.curvature * displacement) * displacement;
        S::from(1.0) / left.max(S::from(LEFT))
    }

    /// The most that it may be over that at none, wherever the piston goes.
    pub(crate) fn stiffest(&self) -> f64 {
        let even = self.slope.value() == 0.0 && self.curvature.value() == 0.0;
        if even { 1.0 } else { 1.0 / LEFT }
    }
}

impl<S: Scalar> OilCompliance<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[hertz, damping, slope, curvature] = parameters else { return None };
        Some(Self { frequency: hertz * std::f64::consts::TAU, damping, chambers: Chambers { slope, curvature } })
    }
}

impl<S: Scalar> Effect<S> for OilCompliance<S> {
    fn hooks(&self) -> Hooks {
        Hooks { linear: true, ..Hooks::default() }
    }
    fn yields(&self, compliance: &mut Compliance<S>) {
        compliance.oil = Some((self.frequency * self.frequency, self.frequency * self.damping * 2.0));
        let Chambers { slope, curvature } = &self.chambers;
        compliance.chambers = (!slope.is_nothing() || !curvature.is_nothing()).then_some(self.chambers);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A piston a half of the way to its end leaves chambers of half and three halves of the volume: `(1/0.5 + 1/1.5)/2 = 4/3`. Off the
    /// middle by a quarter the same law is steeper on one side.
    #[test]
    fn chambers_stiffen_as_their_volumes_say() {
        let half = 0.2_f64;
        let stiffness = |x: f64, middle: f64| 0.5 / (1.0 + (x - middle) / half) + 0.5 / (1.0 - (x - middle) / half);
        for middle in [0.0, 0.05] {
            let curvature = 1.0 / (half * half - middle * middle);
            let chambers = Chambers { slope: -2.0 * middle * curvature, curvature };
            for x in [-0.1, -0.03, 0.0, 0.06, 0.1] {
                let expected = stiffness(x, middle) / stiffness(0.0, middle);
                assert!((chambers.stiffened(x) - expected).abs() < 1e-12, "{x} from {middle}");
            }
        }
        assert!((Chambers { slope: 0.0, curvature: 25.0 }.stiffened(0.1) - 4.0 / 3.0).abs() < 1e-12);
    }
}
