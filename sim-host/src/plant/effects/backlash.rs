//! Lost motion between the actuator, where the LVDT sits, and the table, where the accelerometer sits: the table stays
//! until the gap is crossed.

use super::{Effect, Entry, Hooks, Parameter, Role, Stage, Yardstick};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub const ENTRY: Entry = Entry {
    id: "backlash",
    equation: "x_t = play(x, gap)",
    stage: Stage::Table,
    parameters: &[
        Parameter {
            key: "gap",
            unit: "m",
            rigid_unit: "m",
            meaning: "full width of the lost motion",
            yardstick: Yardstick::One,
            low: 1e-6,
            high: 0.01,
            starts: &[4e-5, 1e-4, 2e-4, 5e-4],
            positive: true,
            role: Role::Shared,
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "the accelerometer goes quiet after each reversal, then spikes; the LVDT shows nothing",
    mistaken_for: &["valve_deadband", "coulomb_friction"],
    test: "accelerometer against the second difference of the LVDT at reversals",
};

/// The moment of contact is found to within a step: as short as this rate asks for, 1/s.
const CONTACT: f64 = 3600.0;

/// Lost motion between actuator and table.
#[derive(Debug, Clone)]
pub struct Backlash<S> {
    half: S,
    table: Option<S>,
    before: S,
    share: S,
}

impl<S: Scalar> Backlash<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub fn new(parameters: &[S]) -> Option<Self> {
        let &[gap] = parameters else { return None };
        Some(Self { half: gap * 0.5, table: None, before: S::from(0.0), share: S::from(1.0) })
    }
}

impl<S: Scalar> Effect<S> for Backlash<S> {
    fn hooks(&self) -> Hooks {
        Hooks { after: true, velocity: true, linear: true, ..Hooks::default() }
    }
    fn sharpest(&self) -> f64 {
        CONTACT
    }
    fn after(&mut self, displacement: S) {
        let table = self.table.unwrap_or(displacement);
        let moved = displacement - (displacement - table).clamp(-self.half, self.half);
        let travel = displacement - self.before;
        // The share of this step's travel that the table took part in: 0 inside the gap, 1 in contact.
        self.share = if travel.value().abs() > 1e-12 {
            ((moved - table) / travel).clamp(S::from(0.0), S::from(1.0))
        } else {
            S::from(0.0)
        };
        self.table = Some(moved);
        self.before = displacement;
    }
    fn sense_velocity(&self, velocity: S, _y: &[S]) -> S {
        velocity * self.share
    }
}
