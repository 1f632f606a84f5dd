//! Overlap of the spool's lands: commands smaller than it pass no flow.
//!
//! The noise of the displacement sensor reaches the spool through the controller and shakes it over the edges, as a
//! dither does; what passes on average is the deadband's mean over that noise, which is normal. Lands have clearance and
//! worn edges, which let a little through before they part and less than all of it after: that rounds the corner as noise
//! of a share `r` of the half width does. Within the overlap the clearance may leave a share `l` of the gain.

use super::shaken::positive_part;
use super::{Dither, Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "valve_deadband",
    equation: "dz(u, d) + l clamp(u, -d, d), dz = u - clamp(u, -d, d), corners rounded over r d",
    stage: Stage::Valve,
    family: Family::Valve,
    parameters: &[Parameter {
        key: "half_width",
        unit: "unit of u",
        rigid_unit: "unit of u",
        meaning: "half width of the overlap",
        signal_scale: SignalScale::Command,
        low: 1e-3,
        high: 5.0,
        starts: &[0.01, 0.2, 1.0],
        positive: true,
        simple: Ends::Low,
        role: Role::Shared,
    },
    Parameter {
        key: "rounding",
        unit: "1",
        rigid_unit: "1",
        meaning: "share of the half width over which its edges are rounded: r",
        signal_scale: SignalScale::One,
        low: 5e-3,
        high: 0.6,
        starts: &[0.04],
        positive: true,
        simple: Ends::Low,
        role: Role::Shared,
    },
    Parameter {
        key: "leak",
        unit: "1",
        rigid_unit: "1",
        meaning: "share of the gain that the clearance leaves within the overlap: l",
        signal_scale: SignalScale::One,
        low: 0.0,
        high: 0.95,
        starts: &[0.0],
        positive: false,
        simple: Ends::Low,
        role: Role::Refined,
    }],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "small commands do nothing: flats at each reversal, growing with smaller motion",
    mistaken_for: &["coulomb_friction", "backlash"],
    test: "pressure difference; supply pressure or payload changed; amplitude ladder",
    order: Order::Fourth,
    contains: &[],
    counter: Some(|parameters, countered| {
        if let &[half_width, ..] = parameters {
            countered.deadband = half_width;
        }
    }),
};

/// Overlap of the spool's lands.
#[derive(Debug, Clone)]
pub(crate) struct ValveDeadband<S> {
    half_width: S,
    rounding: S,
    leak: S,
    /// Standard deviation of the noise that rounds a corner, unit of u.
    blur: S,
}

/// Standard deviation of the edge's rounding and of the noise together.
fn blur<S: Scalar>(edge: S, noise: f64) -> S {
    (edge * edge + noise * noise).sqrt().max(S::from(f64::MIN_POSITIVE))
}

impl<S: Scalar> ValveDeadband<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[half_width, rounding, leak] = parameters else { return None };
        Some(Self { half_width, rounding, leak, blur: blur(rounding * half_width, 0.0) })
    }

    /// What of `above`, the command beyond an edge, passes on average.
    fn passed(&self, above: S) -> S {
        positive_part(above, self.blur)
    }
}

impl<S: Scalar> Effect<S> for ValveDeadband<S> {
    fn hooks(&self) -> Hooks {
        Hooks { valve: true, ..Hooks::default() }
    }
    fn dither(&mut self, dither: Dither) {
        self.blur = blur(self.rounding * self.half_width, dither.command);
    }
    fn valve(&self, u: S, _y: &[S], _dy: &mut [S]) -> S {
        let beyond = self.passed(u - self.half_width) - self.passed(-u - self.half_width);
        beyond + self.leak * (u - beyond)
    }
}
