//! What a device that was never set up does: nothing that moves.
//!
//! The setup is the one of the paper's table with the on-chip converters behind level shifters of 1/6 about mid-scale:
//! 12 bits over +/-10 V, 0.1524 m (6 in) of stroke over +/-10 V. With no wiring declared the role is the controller's with
//! a streamed reference, so that nothing on an input can drive the output.

use shakedown_core::Settings;
use shakedown_core::link::{Role, SafeOutput, Scale, Setup, Source, Wiring};

const MIDDLE: f32 = 2048.0;

/// The wiring.
pub const WIRING: Wiring = Wiring {
    role: Role::Controller,
    source: Source::Streamed,
    reference: Scale { zero: MIDDLE, per_code: 0.1524 / 2048.0 },
    displacement: Scale { zero: MIDDLE, per_code: 0.1524 / 2048.0 },
    acceleration: Scale { zero: MIDDLE, per_code: 2.0 * 9.806_65 / 2048.0 },
    command: Scale { zero: MIDDLE, per_code: 0.1524 / 2048.0 },
    output: Scale { zero: MIDDLE, per_code: 0.1524 / 2048.0 },
    full_scale: 4095,
    safe: SafeOutput::Zero,
    safe_ramp: 0.05,
    rail_is_fault: true,
};

/// The setup.
pub fn setup() -> Setup {
    Setup { control: settings(), wiring: WIRING, telemetry_every: 1 }
}

fn settings() -> Settings {
    use shakedown_core::settings::Gains;
    let off = Gains { proportional: 0.0, integral: 0.0 };
    Settings {
        rate: 1000.0,
        displacement: Gains { proportional: 3.702_05, integral: 0.617_01 },
        velocity: off,
        acceleration: off,
        velocity_limit: 0.242,
        stroke: 0.125,
    }
}
