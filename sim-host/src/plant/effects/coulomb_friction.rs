//! Dry friction of the bearings: one size, against the motion, reached after the contact's bristles have bent.

use super::bristle::Bristles;
use super::{Dither, Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "coulomb_friction",
    equation: "f = Fc z, dz/dt = (v - |v| z)/s",
    stage: Stage::Table,
    family: Family::Friction,
    parameters: &[
        FORCE,
        PRESLIDING,
    ],
    kinds: &[Kind::Servo, Kind::RigidMass, Kind::ForceBalance],
    frees: &[],
    signature: "a step in effort at every reversal, the same size at all speeds",
    mistaken_for: &["valve_deadband", "stribeck_friction", "backlash"],
    test: "pressure difference; supply pressure or payload changed; amplitude ladder",
    order: Order::Second,
    contains: &[],
    counter: Some(|parameters, countered| {
        if let &[force, ..] = parameters {
            countered.coulomb = force;
        }
    }),
};

/// Friction of a contact that slides.
pub(super) const FORCE: Parameter = Parameter {
    key: "force",
    unit: "m/s2",
    rigid_unit: "N",
    meaning: "sliding friction per table mass",
    signal_scale: SignalScale::Force,
    low: 1e-4,
    high: 4.0,
    starts: &[0.005, 0.1, 0.6],
    positive: true,
    simple: Ends::Low,
    role: Role::Shared,
};

/// The travel over which a contact bends before it slides.
pub(crate) const PRESLIDING: Parameter = Parameter {
    key: "presliding",
    unit: "m",
    rigid_unit: "m",
    meaning: "travel over which the contact bends before it slides",
    signal_scale: SignalScale::One,
    low: 5e-7,
    high: 2e-3,
    starts: &[2e-5],
    positive: true,
    simple: Ends::Low,
    role: Role::Shared,
};

/// Dry friction.
#[derive(Debug, Clone)]
pub(crate) struct CoulombFriction<S> {
    force: S,
    bristles: Bristles<S>,
}

impl<S: Scalar> CoulombFriction<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[force, presliding] = parameters else { return None };
        Some(Self { force, bristles: Bristles::new(presliding) })
    }
}

impl<S: Scalar> Effect<S> for CoulombFriction<S> {
    fn hooks(&self) -> Hooks {
        Hooks { force: true, after: true, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        self.bristles.rate(self.force.value())
    }
    fn force(&self, at: &Instant<S>, _y: &[S], _dy: &mut [S]) -> S {
        self.force * self.bristles.share(at.displacement, at.time)
    }
    fn dither(&mut self, dither: Dither) {
        self.bristles.shake(dither.velocity);
    }
    fn after(&mut self, displacement: S, time: f64) {
        self.bristles.settle(displacement, time);
    }
}
