//! One run as its number deals it: table, controller, record, fault and when.

use super::class::{CLASSES, Class, Fault};
use super::dice::Dice;
use super::limit_switches::limit_switches;
use super::machine::{Break, Oil, Table};
use super::motions::{Motions, RATE};
use shakedown_core::settings::{
    Detection, EnvelopeSettings, Gains, GuardSettings, InnerLoop, RampSettings, Ranges, TrackingSettings,
};
use shakedown_core::{Mode, Modification, Settings};

/// Length of a run at most, ticks.
pub const TICKS: usize = 9000;
/// At rest before the test is armed, ticks.
pub const REST: usize = 60;
/// Share of runs without a fault.
const CONTROLS: f64 = 0.03;

/// A run.
#[derive(Debug, Clone)]
pub struct Case {
    /// Its number.
    pub number: u64,
    /// The class of its fault.
    pub class: &'static Class,
    /// The fault.
    pub fault: Fault,
    /// First tick with it.
    pub onset: usize,
    /// What the core is set to.
    pub settings: Settings,
    /// The existing controller's proportional gain, 1; also behind a modifier.
    pub existing: f64,
    /// What it feeds forward of the reference's velocity in front of a guard, s.
    pub feed_forward: f64,
    /// The table, which is not quite the one in the settings.
    pub table: Table,
    /// Where in [`Motions::all`] the record is.
    pub motion: usize,
    /// What is played of it, m.
    pub reference: Vec<f64>,
    /// Whether the reference is streamed through the link.
    pub streamed: bool,
    /// Seed of the sensors' noise.
    pub noise: u64,
    /// Where a limit switch opens the emergency-stop circuit, m from the middle, either side; none where there is none.
    pub limit_switches: Option<f64>,
    /// What is random about the fault itself.
    pub dice: Dice,
}

impl Case {
    /// The run `number` of `seed`; `only` takes every fault from one class.
    pub fn deal(seed: u64, number: u64, only: Option<&'static Class>, motions: &Motions) -> Self {
        Self::deal_with(Dice::new(seed, number), number, only, motions)
    }

    /// The run that `dice` deal, of this number.
    pub fn deal_with(mut dice: Dice, number: u64, only: Option<&'static Class>, motions: &Motions) -> Self {
        let class = only.unwrap_or_else(|| draw(&mut dice));
        let fault = (class.deal)(&mut dice);
        let table = table(&mut dice, matches!(fault, Fault::Table(Break::Payload { .. })));
        let mode = mode(&mut dice, fault);
        let kp = gain(&mut dice, &table);
        let (motion, reference) = slice(&mut dice, motions);
        let onset = 1500 + dice.below(4500);
        let mut settings = settings(&mut dice, mode, kp, &table);
        if matches!(fault, Fault::Shared(_)) && mode == Mode::Controller {
            settings.inner_loop = InnerLoop::Hardwired;
        }
        Self {
            number,
            class,
            fault,
            onset,
            limit_switches: limit_switches(&settings),
            settings,
            existing: kp,
            feed_forward: 0.0,
            table,
            motion,
            reference,
            streamed: matches!(fault, Fault::LinkCut | Fault::LinkGarbled(_)),
            noise: dice.bits(),
            dice,
        }
    }

    /// The same without what commissioning asks for beside the guard.
    #[must_use]
    pub fn guard_alone(self) -> Self {
        Self { limit_switches: None, ..self }
    }

    /// Mode in words.
    pub fn mode(&self) -> &'static str {
        match self.settings.mode {
            Mode::Guard => "guard",
            Mode::Modifier => "modifier",
            Mode::Controller if self.settings.inner_loop == InnerLoop::Hardwired => "hard-wired",
            Mode::Controller if self.settings.tracking.is_some() => "tracking",
            Mode::Controller => "controller",
        }
    }
}

fn draw(dice: &mut Dice) -> &'static Class {
    if dice.chance(CONTROLS) { &CLASSES[0] } else { &CLASSES[1 + dice.below(CLASSES.len() - 1)] }
}

/// A table within a tenth of the one in the settings; on oil where asked for, and a third of the time.
pub(super) fn table(dice: &mut Dice, oil: bool) -> Table {
    let gain = dice.uniform(0.9, 1.1);
    let a1 = 57.65 * dice.uniform(0.85, 1.15);
    let oil = (oil || dice.chance(0.33))
        .then(|| Oil { omega: std::f64::consts::TAU * dice.uniform(20.0, 40.0), damping: dice.uniform(0.1, 0.3) });
    Table {
        b1: 0.69 * gain,
        b0: 138.0 / 57.65 * a1 * gain,
        a1,
        limit: 0.242 * dice.uniform(0.95, 1.0),
        null: 0.001 * dice.uniform(-1.0, 1.0),
        oil,
    }
}

/// Streams and settings are the controller's business; the rest is dealt to guard and controller, and some to modifier.
fn mode(dice: &mut Dice, fault: Fault) -> Mode {
    match fault {
        Fault::Behind(_) => Mode::Modifier,
        Fault::Shared(_) if dice.chance(0.5) => Mode::Modifier,
        Fault::Shared(_) => Mode::Controller,
        Fault::Table(Break::Stuck(_) | Break::Frozen | Break::Supply(_)) if dice.chance(0.5) => Mode::Guard,
        Fault::Table(Break::Stuck(_) | Break::Frozen | Break::Supply(_)) => Mode::Controller,
        Fault::LinkCut | Fault::LinkGarbled(_) | Fault::SettingsWrong(_) | Fault::SettingsNonsense => Mode::Controller,
        _ => [Mode::Guard, Mode::Controller, Mode::Guard, Mode::Controller, Mode::Modifier][dice.below(5)],
    }
}

/// A proportional gain that the table takes with 6 dB to spare.
pub(super) fn gain(dice: &mut Dice, table: &Table) -> f64 {
    let kp = dice.uniform(3.0, 10.0);
    table.oil.map_or(kp, |oil| kp.min(0.4 * oil.damping * oil.omega * 57.65 / 138.0))
}

pub(super) fn settings(dice: &mut Dice, mode: Mode, kp: f64, table: &Table) -> Settings {
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

/// A stretch of a record, scaled so that it stays 35 mm inside the stroke and asks for no more than half as much again as the
/// table's speed.
pub(super) fn slice(dice: &mut Dice, motions: &Motions) -> (usize, Vec<f64>) {
    let motion = dice.below(motions.all.len());
    let all = &motions.all[motion].displacement;
    let room = all.len().saturating_sub(TICKS);
    let from = dice.below(room.max(1));
    let part = &all[from..all.len().min(from + TICKS)];
    let peak = part.iter().fold(1e-6_f64, |m, x| m.max(x.abs()));
    let speed = part.windows(2).fold(1e-6_f64, |m, w| m.max((w[1] - w[0]).abs() * RATE));
    let scale = (dice.uniform(0.02, 0.08) / peak).min(dice.uniform(0.05, 0.36) / speed);
    let last = part.last().copied().unwrap_or(0.0) * scale;
    let mut reference: Vec<f64> = part.iter().map(|x| x * scale).collect();
    reference.resize(TICKS, last);
    (motion, reference)
}
