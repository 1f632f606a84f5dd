//! Physics that no library holds. A diagnosis should say so rather than lend them a listed name.

use crate::effect::{Draw, Scales};
use crate::plant::{Friction, Hysteresis, Payload, Physics, Underlap};
use std::f64::consts::TAU;

/// A flaw without an identifier.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unlisted {
    /// The torque motor's iron withholds part of the command, by the way it came.
    TorqueMotorHysteresis,
    /// A rough patch of the guide: friction in one place of the stroke only.
    RoughPatch,
    /// A specimen that pounds against a stop.
    PoundingPayload,
    /// A force that repeats with the distance travelled: balls in the guide, teeth of a rack.
    RipplePerDistance,
    /// Drag with the square of velocity.
    QuadraticDrag,
    /// Unequal piston areas: the flow gain differs with direction, below the limit too.
    AreaAsymmetry,
    /// The velocity limit sinks as the oil heats.
    LimitFade,
    /// Underlapped lands: more gain near the middle.
    Underlap,
    /// The accelerometer's bracket rings.
    RingingBracket,
    /// The hose bundle pulls the table back.
    HoseStiffness,
    /// The pump's ripple reaches the flow.
    PumpPulsation,
    /// A break-away level that chance redraws at each reversal.
    RandomBreakaway,
    /// A loose connection of the accelerometer.
    LooseConnection,
}

use Unlisted as U;

impl Unlisted {
    /// All of them.
    pub const ALL: [Self; 13] = [
        U::TorqueMotorHysteresis,
        U::RoughPatch,
        U::PoundingPayload,
        U::RipplePerDistance,
        U::QuadraticDrag,
        U::AreaAsymmetry,
        U::LimitFade,
        U::Underlap,
        U::RingingBracket,
        U::HoseStiffness,
        U::PumpPulsation,
        U::RandomBreakaway,
        U::LooseConnection,
    ];

    /// A name for tables.
    pub fn name(self) -> &'static str {
        match self {
            U::TorqueMotorHysteresis => "torque-motor hysteresis",
            U::RoughPatch => "rough patch of the guide",
            U::PoundingPayload => "pounding payload",
            U::RipplePerDistance => "ripple per distance",
            U::QuadraticDrag => "quadratic drag",
            U::AreaAsymmetry => "unequal piston areas",
            U::LimitFade => "sinking velocity limit",
            U::Underlap => "underlapped valve",
            U::RingingBracket => "ringing accelerometer bracket",
            U::HoseStiffness => "hose stiffness",
            U::PumpPulsation => "pump pulsation",
            U::RandomBreakaway => "random break-away",
            U::LooseConnection => "loose connection",
        }
    }

    /// Listed effects whose physics is truly present in it: naming them is no wrong name.
    pub fn tolerated(self) -> &'static [&'static str] {
        match self {
            U::PoundingPayload => &["payload_resonance"],
            U::RandomBreakaway => &["coulomb_friction", "stribeck_friction"],
            _ => &[],
        }
    }

    /// Whether calling the data bad is as right as calling the physics unlisted.
    pub fn may_be_bad_data(self) -> bool {
        self == U::LooseConnection
    }

    /// Needs runs at the velocity limit to be seen.
    pub fn needs_saturation(self) -> bool {
        self == U::LimitFade
    }

    /// Seen by the accelerometer only.
    pub fn needs_accelerometer(self) -> bool {
        matches!(self, U::RingingBracket | U::LooseConnection)
    }

    /// Puts it into `physics` at `strength` in (0, 1].
    pub fn apply(self, s: f64, draw: &Draw, scales: &Scales, physics: &mut Physics) {
        match self {
            U::TorqueMotorHysteresis => {
                let width = 0.12 * s * scales.command;
                physics.command.hysteresis =
                    Some(Hysteresis { widths: [width, 2.0 * width, 4.0 * width], shares: [0.1, 0.1, 0.1] });
            }
            U::RoughPatch | U::RandomBreakaway => self.friction(s, draw, scales, physics),
            U::PoundingPayload => {
                let frequency = draw.log_between(0, 1.5, 5.0);
                let free = 0.4 * scales.acceleration / (TAU * frequency).powi(2);
                physics.payload = Some(Payload {
                    mass_ratio: 1.2 * s,
                    frequency,
                    damping: 0.03,
                    cubic: 0.0,
                    second: None,
                    pounding: Some((free, draw.between(1, 15.0, 40.0))),
                });
            }
            U::RipplePerDistance => {
                let phase = draw.between(1, 0.0, TAU);
                physics.table.ripple = Some((4.0 * s, draw.log_between(0, 0.01, 0.04), phase));
            }
            U::QuadraticDrag => physics.table.quadratic = 200.0 * s,
            U::AreaAsymmetry => physics.flow.area_asymmetry = draw.sign * 0.4 * s,
            U::LimitFade => physics.flow.limit_fade = 0.5 * s / scales.duration,
            U::Underlap => {
                let half_width = draw.between(0, 0.02, 0.08) * scales.command;
                physics.valve.underlap = Some(Underlap { half_width, gain: 2.0 * s });
            }
            U::RingingBracket => physics.sensors.bracket = Some((6.0 / s, draw.between(0, 0.02, 0.08))),
            U::HoseStiffness => physics.table.hose = 200.0 * s,
            U::PumpPulsation => physics.flow.pulsation = Some((0.5 * s, draw.between(0, 4.0, 15.0))),
            U::LooseConnection => physics.sensors.loose = s,
        }
    }

    fn friction(self, s: f64, draw: &Draw, scales: &Scales, physics: &mut Physics) {
        let presliding = draw.log_between(0, 1.5e-5, 4e-5);
        let patch = (self == U::RoughPatch)
            .then(|| (draw.between(1, -0.4, 0.4) * scales.stroke, draw.between(2, 0.15, 0.3) * scales.stroke));
        let sliding = 4.0 * s;
        physics.table.friction = Some(Friction { sliding, breakaway: sliding, stribeck: 0.02, presliding, patch });
        if self == U::RandomBreakaway {
            physics.table.breakaway_spread = Some(3.0);
        }
    }
}
