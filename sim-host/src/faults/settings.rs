//! Settings as they should not be: wrong for this table, nonsense, or spoilt on their way.

use super::dice::FaultRng;
use shakedown_core::Settings;
use shakedown_core::link::{Assembler, HostRequest as Frame, MAX_FRAME, Scale, Setup, Source, Wiring, encode};

/// What a device takes of a frame of wrong settings with so many of its `bits` flipped; none as a rule.
pub(super) fn garbled(settings: &Settings, bits: u32, dice: &mut FaultRng) -> Option<Settings> {
    let mut wire = [0; MAX_FRAME];
    let length = encode(&Frame::WriteSetup(setup(&wrong(settings, 30.0, dice))), &mut wire).unwrap_or(0);
    for _ in 0..bits {
        let at = dice.below(length.max(1));
        wire[at] ^= 1 << dice.below(8);
    }
    let mut assembler = Assembler::new();
    wire[..length].iter().find_map(|&byte| match assembler.push::<Frame>(byte) {
        Some(Ok(Frame::WriteSetup(setup))) => Some(setup.control),
        _ => None,
    })
}

/// Settings that hold and are not this table's: gains off by factors up to `factor`, the null by a twentieth of wide open.
pub(super) fn wrong(settings: &Settings, factor: f64, dice: &mut FaultRng) -> Settings {
    let mut wrong = *settings;
    let mut off =
        |value: &mut f32| *value *= (if dice.chance(0.5) { dice.scale(1.0, factor) } else { 1.0 / factor }) as f32;
    off(&mut wrong.displacement.proportional);
    off(&mut wrong.displacement.integral);
    if let Some(tracking) = &mut wrong.tracking {
        off(&mut tracking.bandwidth);
    }
    wrong.valve.null_bias = (0.005 * dice.uniform(-1.0, 1.0)) as f32;
    wrong
}

/// The settings with one number replaced by one that no table has; none where they cannot be written down.
pub(super) fn nonsense(settings: &Settings, dice: &mut FaultRng) -> Option<Settings> {
    let mut value = toml::Value::try_from(settings).ok()?;
    let mut numbers = Vec::new();
    collect(&mut value, &mut numbers);
    let at = dice.below(numbers.len().max(1));
    let number = numbers.into_iter().nth(at)?;
    let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e30, -1e30, -*number];
    *number = odd[dice.below(odd.len())];
    value.try_into().ok()
}

/// Every number in `value`.
fn collect<'v>(value: &'v mut toml::Value, numbers: &mut Vec<&'v mut f64>) {
    match value {
        toml::Value::Float(number) => numbers.push(number),
        toml::Value::Table(table) => table.iter_mut().for_each(|(_, value)| collect(value, numbers)),
        _ => {}
    }
}

/// `settings` as a device's setup.
fn setup(control: &Settings) -> Setup {
    let scale = Scale { zero: 2048.0, per_code: 0.1524 / 2048.0 };
    Setup {
        telemetry_every: 1,
        lease_ms: 0,
        wiring: Wiring {
            source: Source::Streamed,
            reference: scale,
            displacement: scale,
            acceleration: Scale { zero: 2048.0, per_code: 0.01 },
            external: scale,
            output: scale,
            full_scale: 4095,
            rails_are_faults: true,
        },
        control: *control,
    }
}
