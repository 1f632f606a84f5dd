//! Dry friction that is larger near standstill and falls as the bearings begin to slide.

use super::bristle::Bristles;
use super::coulomb_friction::{FORCE, PRESLIDING};
use super::{Dither, Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "stribeck_friction",
    equation: "f = (Fc + (Fs - Fc) exp(-(v/vs)^2)) z, dz/dt = (v - |v| z)/s",
    stage: Stage::Table,
    family: Family::Friction,
    parameters: &[
        Parameter { starts: &[0.02, 0.2], ..FORCE },
        Parameter {
            key: "static",
            unit: "m/s2",
            rigid_unit: "N",
            meaning: "friction at standstill per table mass",
            signal_scale: SignalScale::Force,
            low: 1e-4,
            high: 8.0,
            starts: &[0.04, 0.4],
            positive: true,
            simple: Ends::Low,
            role: Role::Shared,
        },
        Parameter {
            key: "velocity",
            unit: "m/s",
            rigid_unit: "m/s",
            meaning: "speed over which it falls",
            signal_scale: SignalScale::One,
            low: 1e-3,
            high: 0.5,
            starts: &[0.01],
            positive: true,
            simple: Ends::Both,
            role: Role::Shared,
        },
        PRESLIDING,
    ],
    kinds: &[Kind::Servo, Kind::RigidMass, Kind::ForceBalance],
    frees: &[],
    signature: "a step in effort at reversals with a peak on it",
    mistaken_for: &["coulomb_friction", "valve_deadband"],
    test: "slow ramps at several speeds",
    order: Order::Second,
    contains: &["coulomb_friction"],
    counter: Some(|parameters, countered| {
        if let &[force, standstill, velocity, ..] = parameters {
            (countered.coulomb, countered.peak) = (force, Some((standstill, velocity)));
        }
    }),
};

/// Speed over that of the peak's fall beyond which the peak is gone: `exp(-6.5^2)` is below 1e-18.
const PEAK: f64 = 6.5;

/// Dry friction with a standstill peak.
#[derive(Debug, Clone)]
pub(crate) struct StribeckFriction<S> {
    sliding: S,
    standstill: S,
    velocity: S,
    bristles: Bristles<S>,
}

impl<S: Scalar> StribeckFriction<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[sliding, standstill, velocity, presliding] = parameters else { return None };
        Some(Self { sliding, standstill, velocity, bristles: Bristles::new(presliding) })
    }
}

impl<S: Scalar> Effect<S> for StribeckFriction<S> {
    fn hooks(&self) -> Hooks {
        Hooks { force: true, after: true, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        self.bristles.rate(self.standstill.value().max(self.sliding.value()))
    }
    fn force(&self, at: &Instant<S>, _y: &[S], _dy: &mut [S]) -> S {
        let ratio = at.velocity / self.velocity;
        let mut size = self.sliding;
        // Faster than this nothing is left of the peak in the last digit.
        if ratio.value().abs() < PEAK {
            size += (self.standstill - self.sliding).max(S::from(0.0)) * (-(ratio * ratio)).exp();
        }
        size * self.bristles.share(at.displacement, at.time)
    }
    fn dither(&mut self, dither: Dither) {
        self.bristles.shake(dither.velocity);
    }
    fn after(&mut self, displacement: S, time: f64) {
        self.bristles.settle(displacement, time);
    }
}
