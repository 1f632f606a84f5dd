//! What a device that was never set up does: nothing that moves.
//!
//! The wiring is the one of the paper's table with the on-chip converters behind level shifters: 12 bits over +/-10 V,
//! 0.1524 m (6 in) of displacement and 2 g of acceleration over +/-10 V. The reference is streamed, so that nothing on
//! an input can drive the output of a device that is armed by mistake.

use shakedown_core::link::{Scale, Setup, Source, Wiring};
use shakedown_core::settings::{Detection, GuardSettings, Ranges};
use shakedown_core::{Modification, Settings};

use crate::limits::Limits;

/// The STM32F407 with the converters on the chip. At 5 kHz a tick has 33,600 cycles of 168 MHz: 5.6 for each of the 6,000
/// instructions that a tick takes at most (`tests/replay/tests/cost.rs`), where five wait states at every fetch of a line make 6
/// for one that needs a line of its own.
pub const LIMITS: Limits = Limits { full_scale: 4095, highest_rate: 5000 };

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
    full_scale: LIMITS.full_scale,
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
