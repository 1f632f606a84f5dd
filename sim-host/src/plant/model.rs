//! The model a user believes in: its kind and its own parameters, before any effect is added.

pub(crate) use crate::scalar::GRAVITY;
use crate::scalar::Scalar;

/// Which equations a model starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Eq. 7 with the velocity limiter of Fig. 7: `z' = -a1 z + (b0 - b1 a1) u - f`, `v = limit(z + b1 u)`.
    Servo,
    /// Eq. 1: `m x'' + c x' = gain u`.
    RigidMass,
    /// `pressure_difference(t) = scale (x'' + c x' + f)(t + lead)`, driven by the measured motion.
    ForceBalance,
}

/// One of a model's own parameters.
#[derive(Debug, Clone, Copy)]
pub struct Own {
    /// Key in `[model]`.
    pub key: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Positive, and fitted by its logarithm.
    pub positive: bool,
}

const fn positive(key: &'static str, unit: &'static str) -> Own {
    Own { key, unit, positive: true }
}

const fn signed(key: &'static str, unit: &'static str) -> Own {
    Own { key, unit, positive: false }
}

impl Kind {
    /// The model's own parameters, in the order that [`Baseline::new`] takes them.
    pub fn parameters(self) -> &'static [Own] {
        const SERVO: &[Own] =
            &[signed("b1", "1/s"), positive("b0", "1/s2"), positive("a1", "1/s"), positive("velocity_limit", "m/s")];
        const RIGID_MASS: &[Own] =
            &[positive("mass", "kg"), signed("viscous", "N s/m"), positive("gain", "N per unit of u")];
        const FORCE_BALANCE: &[Own] =
            &[signed("scale", "unit of p per m/s2"), signed("viscous", "1/s"), signed("lead", "s")];
        match self {
            Self::Servo => SERVO,
            Self::RigidMass => RIGID_MASS,
            Self::ForceBalance => FORCE_BALANCE,
        }
    }
}

/// A model's own parameters with their values.
#[derive(Debug, Clone, Copy)]
pub enum Baseline<S> {
    /// [`Kind::Servo`].
    Servo {
        /// Direct term, 1/s.
        b1: S,
        /// Gain, 1/s2.
        b0: S,
        /// Pole, 1/s.
        a1: S,
        /// Velocity limit, m/s.
        velocity_limit: S,
    },
    /// [`Kind::RigidMass`].
    RigidMass {
        /// Moving mass, kg.
        mass: S,
        /// Viscous friction, N s/m.
        viscous: S,
        /// Force per unit of command, N.
        gain: S,
    },
    /// [`Kind::ForceBalance`].
    ForceBalance {
        /// Pressure per acceleration.
        scale: S,
        /// Viscous friction per table mass, 1/s.
        viscous: S,
        /// By how much the pressure was recorded before the motion it belongs to, s.
        lead: S,
    },
}

impl<S: Scalar> Baseline<S> {
    /// Takes the values in the order of [`Kind::parameters`]; none where their number is wrong.
    pub fn new(kind: Kind, values: &[S]) -> Option<Self> {
        match (kind, values) {
            (Kind::Servo, &[b1, b0, a1, velocity_limit]) => Some(Self::Servo { b1, b0, a1, velocity_limit }),
            (Kind::RigidMass, &[mass, viscous, gain]) => Some(Self::RigidMass { mass, viscous, gain }),
            (Kind::ForceBalance, &[scale, viscous, lead]) => Some(Self::ForceBalance { scale, viscous, lead }),
            _ => None,
        }
    }
}
