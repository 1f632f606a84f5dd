//! What a device that was never set up does: nothing that moves.
//!
//! The wiring is the one of the paper's table with the on-chip converters behind level shifters: 12 bits over +/-10 V,
//! 0.1524 m (6 in) of displacement and 2 g of acceleration over +/-10 V. The reference is streamed, so that nothing on
//! an input can drive the output of a device that is armed by mistake.

use shakedown_core::guard::GuardSettings;
use shakedown_core::link::{Scale, Setup, Source, Wiring};
use shakedown_core::saturation::Detection;
use shakedown_core::settings::Ranges;
use shakedown_core::{Modification, Settings};

const MIDDLE: f32 = 2048.0;
const DISPLACEMENT: Scale = Scale { zero: MIDDLE, per_code: 0.1524 / MIDDLE };

/// The wiring.
pub const WIRING: Wiring = Wiring {
    source: Source::Streamed,
    reference: DISPLACEMENT,
    displacement: DISPLACEMENT,
    acceleration: Scale { zero: MIDDLE, per_code: 2.0 * 9.806_65 / MIDDLE },
    external: DISPLACEMENT,
    output: DISPLACEMENT,
    full_scale: 4095,
    rails_are_faults: true,
};

/// The setup.
pub fn setup() -> Setup {
    Setup {
        telemetry_every: 1,
        wiring: WIRING,
        control: Settings {
            anti_windup: true,
            modification: Modification::Causal,
            ranges: Ranges {
                reference: 0.2,
                displacement: 0.16,
                acceleration: 30.0,
                external: 0.2,
                ..Ranges::default()
            },
            saturation: Some(Detection::default()),
            guard: Some(GuardSettings::default()),
            ..Settings::default()
        },
    }
}
