//! What a device that was never set up does: nothing that moves.
//!
//! The wiring is the one of the paper's table with the on-chip converters behind level shifters: +/-10 V,
//! 0.1524 m (6 in) of displacement and 2 g of acceleration over +/-10 V. The reference is streamed, so that nothing on
//! an input can drive the output of a device that is armed by mistake.

use shakedown_core::link::{Scale, Setup, Source, Wiring};
use shakedown_core::settings::{Detection, GuardSettings, Ranges};
use shakedown_core::{Modification, Settings};

use crate::converters::SCANS;
use crate::limits::Limits;

/// A processor of 168 MHz with the converters on the chip, which sum up 16 scans of 12 bits. At 5 kHz a tick has 33,600 cycles: 5.6 for each of
/// the 6,000 instructions that one with the relay closed takes at most, where five wait states at every fetch of a line make 6 for one that
/// needs a line of its own; and at least 3.5 for each of those of a tick that empties a preview's memory, which with
/// the relay open takes more where the compiler makes a loop of it (`tests/replay/tests/cost.rs` has both).
pub const LIMITS: Limits = Limits { full_scale: 4095 * SCANS as u16, highest_rate: 5000 };

/// The wiring.
pub const WIRING: Wiring = wiring(LIMITS.full_scale);

/// The wiring of a board whose converters' largest code is `full_scale`.
pub const fn wiring(full_scale: u16) -> Wiring {
    // Half of the power of two that the codes are counted from: the sum of 16 scans ends 16 below it.
    let middle = ((full_scale as u32 + 1).next_power_of_two() / 2) as f32;
    let displacement = Scale { zero: middle, per_code: 0.1524 / middle };
    Wiring {
        source: Source::Streamed,
        reference: displacement,
        displacement,
        acceleration: Scale { zero: middle, per_code: 2.0 * 9.806_65 / middle },
        external: displacement,
        output: displacement,
        full_scale,
        rails_are_faults: true,
    }
}

/// The setup.
pub fn setup() -> Setup {
    setup_of(LIMITS)
}

/// The setup of a board of these limits.
pub fn setup_of(limits: Limits) -> Setup {
    Setup {
        telemetry_every: 1,
        lease_ms: 0,
        wiring: wiring(limits.full_scale),
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
