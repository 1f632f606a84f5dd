//! What is computed on host and target alike: a controller with every part of the tracking law along a motion made of
//! additions and multiplications, and a hash over the bits of every command.

use shakedown_core::settings::{
    FlowSettings, FrictionSettings, NotchSettings, OilSettings, PressureSettings, TrackingSettings,
};
use shakedown_core::{Controller, Sample, Settings};

/// Every part in use.
pub(crate) fn full() -> TrackingSettings {
    TrackingSettings {
        delay: 0.003,
        flow: FlowSettings { sharpness: 3.0, droop: 0.3, recovery: 2.0, stall: 30.0, ..FlowSettings::default() },
        friction: FrictionSettings { coulomb: 0.05, viscous: 0.1, deadband: 1e-4, ..FrictionSettings::default() },
        oil: Some(OilSettings { frequency: 12.0, damping: 0.05 }),
        pressure: Some(PressureSettings { area_per_mass: 5e-6, gain: 0.005, corner: 0.5 }),
        notch: Some(NotchSettings { frequency: 30.0, damping: 0.2 }),
        ..TrackingSettings::default()
    }
}

/// FNV-1a over the bits of the commands of twenty seconds; the table is an integrator of what it is told.
#[inline(never)]
pub(crate) fn hash(tracking: TrackingSettings) -> u32 {
    let settings = Settings { tracking: Some(tracking), ..Settings::default() };
    let Ok(mut controller) = Controller::new(&settings) else { return 0 };
    let (mut x, mut v, mut a) = (0.0_f32, 0.0_f32, 0.0_f32);
    // A sine by its recurrence, and one of five times the frequency.
    let (mut slow, mut fast) = ([0.03_f32, 0.0], [0.003_f32, 0.0]);
    let mut hash = 0x811c_9dc5_u32;
    for _ in 0..20_000 {
        for (sine, turn) in [(&mut slow, 0.005_f32), (&mut fast, 0.025)] {
            sine[1] += turn * sine[0];
            sine[0] -= turn * sine[1];
        }
        let sample = Sample { pressure_difference: 2e5 * a, ..Sample::new(slow[1] + fast[1], x, a) };
        let command = controller.step(&sample).valve;
        for byte in command.to_bits().to_le_bytes() {
            hash = (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        }
        let before = v;
        v += 0.06 * (2.3 * command - v);
        x += 1e-3 * v;
        a = (v - before) * 1e3;
    }
    hash
}
