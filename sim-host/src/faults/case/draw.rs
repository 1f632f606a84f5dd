//! What a run is dealt: table, mode, gains, settings, record.

use super::{Fault, MODEL_GAIN, POINTS};
use crate::faults::dice::FaultRng;
use crate::faults::machine::{Oil, PlantFault, Table};
use crate::faults::motions::{Motions, RATE};
use shakedown_core::settings::{
    Detection, EnvelopeSettings, Gains, GuardSettings, RampSettings, Ranges, TrackingSettings,
};
use shakedown_core::{Mode, Modification, Settings};

/// A table within a tenth of the one in the settings, or within three tenths; on oil where asked for, and a third of the time.
pub(in crate::faults) fn table(dice: &mut FaultRng, oil: bool) -> Table {
    let (gain, pole) = if dice.chance(0.85) { (0.1, 0.15) } else { (0.3, 0.3) };
    let gain = 1.0 + gain * dice.uniform(-1.0, 1.0);
    let a1 = 57.65 * (1.0 + pole * dice.uniform(-1.0, 1.0));
    let oil = (oil || dice.chance(0.33))
        .then(|| Oil { omega: std::f64::consts::TAU * dice.scale(10.0, 60.0), damping: dice.uniform(0.1, 0.3) });
    Table {
        b1: 0.69 * gain,
        b0: MODEL_GAIN * a1 * gain,
        a1,
        limit: 0.242 * dice.uniform(0.95, 1.0),
        null: 0.001 * dice.uniform(-1.0, 1.0),
        oil,
    }
}

/// Streams and settings are the controller's business; the rest is dealt to guard and controller, and some to modifier.
pub(super) fn mode(dice: &mut FaultRng, fault: Fault, second: Option<Fault>) -> Mode {
    let obeys = |fault: Fault| {
        !matches!(
            fault,
            Fault::Table(PlantFault::Stuck(_) | PlantFault::Frozen | PlantFault::Supply(_) | PlantFault::Bit(..))
        )
    };
    match fault {
        Fault::Behind(_) => Mode::Modifier,
        Fault::Shared(_) if dice.chance(0.5) => Mode::Modifier,
        Fault::Shared(_) => Mode::Controller,
        _ if matches!(second, Some(Fault::Behind(_))) => Mode::Modifier,
        _ if !(obeys(fault) && second.is_none_or(obeys)) => [Mode::Guard, Mode::Controller][dice.below(2)],
        Fault::LinkCut | Fault::LinkGarbled(_) | Fault::SettingsWrong(_) | Fault::SettingsNonsense => Mode::Controller,
        _ => [Mode::Guard, Mode::Controller, Mode::Guard, Mode::Controller, Mode::Modifier][dice.below(5)],
    }
}

/// Control rate, 1/s: 1 kHz as a rule, else from 200 Hz to 5 kHz.
pub(super) fn rate(dice: &mut FaultRng, settings: &mut Settings) -> f64 {
    let rate = if dice.chance(0.75) { RATE } else { [200.0, 500.0, 2000.0, 5000.0][dice.below(4)] };
    settings.rate = rate as f32;
    if let Some(tracking) = &mut settings.tracking {
        // Its points stand from one tick to eight apart, and it corrects no faster than ticks allow.
        tracking.spacing = tracking.spacing.clamp(1.0 / settings.rate, 8.0 / settings.rate);
        tracking.bandwidth = tracking.bandwidth.min(0.15 * settings.rate);
        tracking.disturbance = tracking.disturbance.min(0.15 * settings.rate);
    }
    rate
}

/// A proportional gain that the table takes with 6 dB to spare.
pub(in crate::faults) fn gain(dice: &mut FaultRng, table: &Table) -> f64 {
    let kp = dice.uniform(3.0, 10.0);
    table.oil.map_or(kp, |oil| kp.min(0.4 * oil.damping * oil.omega * 57.65 / 138.0))
}

/// Another modifier than the causal one, in one run of five.
pub(super) fn modification(dice: &mut FaultRng, settings: &mut Settings) {
    if settings.mode == Mode::Guard || !dice.chance(0.2) {
        return;
    }
    // As much as the window holds at the highest rates.
    let seconds = (dice.uniform(0.05, 0.4) as f32).min(500.0 / settings.rate);
    let kinds = [Modification::Preview { seconds }, Modification::Clip, Modification::Off];
    // The tracking law runs the model backwards: what asks for more than the table's speed is for the modifier to prevent.
    let count = if settings.tracking.is_some() { 1 } else { kinds.len() };
    settings.modification = kinds[dice.below(count)];
}

pub(in crate::faults) fn settings(dice: &mut FaultRng, mode: Mode, kp: f64, table: &Table) -> Settings {
    let tracks = mode == Mode::Controller && table.oil.is_none() && dice.chance(0.3);
    let modification = if mode == Mode::Guard { Modification::Off } else { Modification::Causal };
    Settings {
        rate: RATE as f32,
        mode,
        displacement: Gains::new(kp as f32, dice.uniform(0.0, 1.0) as f32),
        modification,
        anti_windup: true,
        ranges: Ranges {
            reference: 0.2,
            displacement: 0.16,
            // An accelerometer that covers what a stiff table under the tracking law does: 4 g at the foot of a fade.
            acceleration: 60.0,
            // Wide open three times over at the gain of the existing controller.
            external: 3.0,
            ..Ranges::default()
        },
        tracking: tracks.then(TrackingSettings::default),
        saturation: Some(Detection::default()),
        guard: Some(GuardSettings {
            // A table that is followed through a valve of this gain lags by half of 60 mm at its full speed.
            // A millimetre more room than the watcher asks for: an unknown null goes on through ramp and block.
            envelope: EnvelopeSettings { margin: 0.006, tracking: 0.06, ..EnvelopeSettings::default() },
            ramps: RampSettings { test: 0.5, safe: 0.05 },
            ..GuardSettings::default()
        }),
        ..Settings::default()
    }
}

/// A stretch of a record, scaled so that it stays 35 mm inside the stroke, in one run of seven up to 6 mm short of the limit switches,
/// and asks for no more than half as much again as the table's speed.
pub(in crate::faults) fn slice(dice: &mut FaultRng, motions: &Motions) -> (usize, Vec<f64>) {
    let motion = dice.below(motions.all.len());
    let all = &motions.all[motion].displacement;
    let room = all.len().saturating_sub(POINTS);
    let from = dice.below(room.max(1));
    let part = &all[from..all.len().min(from + POINTS)];
    let peak = part.iter().fold(1e-6_f64, |m, x| m.max(x.abs()));
    let speed = part.windows(2).fold(1e-6_f64, |m, w| m.max((w[1] - w[0]).abs() * RATE));
    let most = if dice.chance(0.85) { dice.uniform(0.02, 0.08) } else { dice.uniform(0.08, 0.09) };
    let scale = (most / peak).min(dice.uniform(0.05, 0.36) / speed);
    let last = part.last().copied().unwrap_or(0.0) * scale;
    let mut reference: Vec<f64> = part.iter().map(|x| x * scale).collect();
    reference.resize(POINTS, last);
    (motion, reference)
}
