//! Overlap of the spool's lands: commands smaller than it pass no flow.
//!
//! The noise of the displacement sensor reaches the spool through the controller and shakes it over the edges, as a
//! dither does; what passes on average is the deadband's mean over that noise. The noise is taken as logistic, whose mean
//! has a closed form: `s ln(1 + exp((u - d)/s)) - s ln(1 + exp((-u - d)/s))`, with `s` the noise times sqrt(3)/pi.

use super::{Dither, Effect, Ends, Entry, Hooks, Parameter, Role, Stage, Yardstick};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub const ENTRY: Entry = Entry {
    id: "valve_deadband",
    equation: "dz(u, d) = u - clamp(u, -d, d)",
    stage: Stage::Valve,
    parameters: &[Parameter {
        key: "half_width",
        unit: "unit of u",
        rigid_unit: "unit of u",
        meaning: "half width of the overlap",
        yardstick: Yardstick::Command,
        low: 1e-3,
        high: 5.0,
        starts: &[0.01, 0.2, 1.0],
        positive: true,
        simple: Ends::Low,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "small commands do nothing: flats at each reversal, growing with smaller motion",
    mistaken_for: &["coulomb_friction", "backlash"],
    test: "pressure difference; supply pressure or payload changed; amplitude ladder",
};

/// Overlap of the spool's lands.
#[derive(Debug, Clone)]
pub struct ValveDeadband<S> {
    half_width: S,
    /// Scale of the command's noise, unit of u.
    dither: f64,
}

impl<S: Scalar> ValveDeadband<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub fn new(parameters: &[S]) -> Option<Self> {
        let &[half_width] = parameters else { return None };
        Some(Self { half_width, dither: 0.0 })
    }

    /// What of `above`, the command beyond an edge, passes on average over the noise.
    fn passed(&self, above: S) -> S {
        let ratio = above / self.dither.max(f64::MIN_POSITIVE);
        if ratio.value() > 30.0 {
            above
        } else if ratio.value() < -30.0 {
            S::from(0.0)
        } else {
            (ratio.exp() + 1.0).ln() * self.dither
        }
    }
}

impl<S: Scalar> Effect<S> for ValveDeadband<S> {
    fn hooks(&self) -> Hooks {
        Hooks { valve: true, ..Hooks::default() }
    }
    fn dither(&mut self, dither: Dither) {
        self.dither = dither.command * 3.0_f64.sqrt() / std::f64::consts::PI;
    }
    fn valve(&self, u: S, _y: &[S], _dy: &mut [S]) -> S {
        self.passed(u - self.half_width) - self.passed(-u - self.half_width)
    }
}
