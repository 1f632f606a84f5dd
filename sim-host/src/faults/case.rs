//! One run as its number deals it: table, controller, record, fault and when.

pub(super) mod draw;
mod orders;

use super::class::{CLASSES, Class, Fault};
use super::dice::FaultRng;
use super::limit_switches::limit_switches;
use super::machine::{BLOCK, PlantFault, Table};
use super::motions::{Motions, RATE};
use crate::motion::resample::linear;
use orders::orders;
use shakedown_core::settings::{GuardSettings, InnerLoop, InputSettings};
use shakedown_core::{Mode, OperatorRequest, Settings};

/// Length of a run at most, s.
pub const LENGTH: f64 = 9.0;
/// The same in points of a record.
pub const POINTS: usize = 9000;
/// At rest before the test is armed, s.
pub const REST: f64 = 0.06;
/// Share of runs without a fault.
const CONTROLS: f64 = 0.03;
/// How long a test that is held and resumed takes to fade, s.
const RESUMED: f32 = 1.5;
/// Most by which a second displacement sensor and the LVDT may differ, m.
const SECOND: f32 = 0.005;

/// The aid beside guard, LVDT and accelerometer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Beside {
    /// The limit switches that docs/commissioning.md asks for.
    LimitSwitches,
    /// A second displacement sensor that the device reads, and no limit switches.
    SecondSensor,
    /// Nothing: the guard is alone.
    Nothing,
}

/// Velocity that the settings' model makes of a steady command, 1/s: `b0 / a1` of the paper.
pub const MODEL_GAIN: f64 = 138.0 / 57.65;

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
    /// A second fault and its first tick.
    pub second: Option<(Fault, usize)>,
    /// What the core is set to.
    pub settings: Settings,
    /// What the operator asks for, and at which tick.
    pub orders: Vec<(usize, OperatorRequest)>,
    /// The existing controller's proportional gain, 1; also behind a modifier.
    pub existing: f64,
    /// What it feeds forward of the reference's velocity in front of a guard, s.
    pub feed_forward: f64,
    /// The table, which is not quite the one in the settings.
    pub table: Table,
    /// How long its hydraulic block takes to shut, s: at most as declared.
    pub block: f64,
    /// Whether sensors, command and output go through the converters of a board.
    pub converters: bool,
    /// Where in [`Motions::all`] the record is.
    pub motion: usize,
    /// What is played of it, m, by tick.
    pub reference: Vec<f64>,
    /// Whether the reference is streamed through the link.
    pub streamed: bool,
    /// Seed of the sensors' noise.
    pub noise: u64,
    /// Where a limit switch opens the emergency-stop circuit, m from the middle, either side; none where there is none.
    pub limit_switches: Option<f64>,
    /// What is random about the fault itself.
    pub dice: FaultRng,
}

impl Case {
    /// The run `number` of `seed`; `only` takes every fault from one class.
    pub fn deal(seed: u64, number: u64, only: Option<&'static Class>, motions: &Motions) -> Self {
        Self::deal_with(FaultRng::new(seed, number), number, only, motions)
    }

    /// The run that `dice` deal, of this number.
    pub fn deal_with(mut dice: FaultRng, number: u64, only: Option<&'static Class>, motions: &Motions) -> Self {
        let class = only.unwrap_or_else(|| draw(&mut dice));
        let fault = (class.deal)(&mut dice);
        let second = class.second.map(|deal| deal(&mut dice));
        let table = draw::table(&mut dice, matches!(fault, Fault::Table(PlantFault::Payload { .. })));
        let mode = draw::mode(&mut dice, fault, second);
        let kp = draw::gain(&mut dice, &table);
        let (motion, record) = draw::slice(&mut dice, motions);
        let began = 1.5 + 4.5 * dice.unit();
        let mut settings = draw::settings(&mut dice, mode, kp, &table);
        if shares(fault, second) && mode == Mode::Controller {
            settings.inner_loop = InnerLoop::Hardwired;
        }
        if matches!(fault, Fault::Signal(super::class::Channel::Second, _)) {
            fit_second(&mut settings);
        }
        let streamed = matches!(fault, Fault::LinkCut | Fault::LinkGarbled(_));
        let rate = if streamed { RATE } else { draw::rate(&mut dice, &mut settings) };
        draw::modification(&mut dice, &mut settings);
        let (orders, onset) = orders(&mut dice, fault, began, rate);
        if let (Some(guard), true) = (&mut settings.guard, orders.len() > 2) {
            // A test that is held and resumed goes back to where its reference has gone meanwhile.
            guard.ramps.test = RESUMED;
        }
        let later = (2.0 * dice.unit() * rate) as usize;
        Self {
            number,
            class,
            fault,
            onset,
            second: second.map(|fault| (fault, onset + later)),
            limit_switches: limit_switches(&settings),
            settings,
            orders,
            existing: kp,
            feed_forward: 0.0,
            block: if dice.chance(0.5) { BLOCK } else { BLOCK * dice.uniform(0.1, 1.0) },
            converters: dice.chance(0.2),
            table,
            motion,
            reference: at_rate(&record, rate),
            streamed,
            noise: dice.bits(),
            dice,
        }
    }

    /// The same with only this beside the guard.
    #[must_use]
    pub fn beside(mut self, what: Beside) -> Self {
        if what != Beside::LimitSwitches {
            self.limit_switches = None;
        }
        if what == Beside::SecondSensor {
            fit_second(&mut self.settings);
        }
        self
    }

    /// The same without what commissioning asks for beside the guard.
    #[must_use]
    pub fn guard_alone(self) -> Self {
        self.beside(Beside::Nothing)
    }

    /// Whether the device reads a second displacement sensor.
    pub fn second_sensor(&self) -> bool {
        self.settings.guard.is_some_and(|guard| guard.inputs.second_displacement.is_some())
    }

    /// Whether there is something that contradicts the LVDT however slowly it goes wrong.
    pub fn aided(&self) -> bool {
        self.limit_switches.is_some() || self.second_sensor()
    }

    /// Whether a fault sits on an LVDT that a loop behind the device shares.
    pub fn shares(&self) -> bool {
        shares(self.fault, self.second.map(|(fault, _)| fault))
    }

    /// Ticks a second, 1/s.
    pub fn rate(&self) -> f64 {
        f64::from(self.settings.rate)
    }

    /// Length of the run at most, ticks.
    pub fn ticks(&self) -> usize {
        (LENGTH * self.rate()) as usize
    }

    /// Farthest from the middle that the reference is, m.
    pub fn peak(&self) -> f64 {
        self.reference.iter().fold(0.0, |most, x| most.max(x.abs()))
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

fn draw(dice: &mut FaultRng) -> &'static Class {
    if dice.chance(CONTROLS) { &CLASSES[0] } else { &CLASSES[1 + dice.below(CLASSES.len() - 1)] }
}

fn shares(fault: Fault, second: Option<Fault>) -> bool {
    [Some(fault), second].iter().flatten().any(|fault| matches!(fault, Fault::Shared(_)))
}

fn fit_second(settings: &mut Settings) {
    if let Some(guard) = &mut settings.guard {
        *guard =
            GuardSettings { inputs: InputSettings { second_displacement: Some(SECOND), ..guard.inputs }, ..*guard };
    }
}

/// The `record` (m, at 1 kHz) by ticks of `rate` (1/s), m.
fn at_rate(record: &[f64], rate: f64) -> Vec<f64> {
    if rate == RATE {
        return record.to_vec();
    }
    (0..(LENGTH * rate) as usize).map(|k| linear(record, k as f64 / rate * RATE)).collect()
}
