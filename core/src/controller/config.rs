//! Settings worked out into coefficients: everything a tick needs and nothing it has to divide by.

use super::law::{ThreeVariable, tracking};
use super::monitors::TURNS;
use crate::block::{BlockError, require, whole_ticks};
use crate::control::Tracking;
use crate::filter::{Lag, MotionObserver};
use crate::guard::supervisor::Ramps;
use crate::guard::{
    DisplacementWitness, Envelope, GuardSettings, InputGate, InputMonitor, NoiseMonitor, Plausibility, StillMonitor,
    ValveMonitor,
};
use crate::math::Magnitude;
use crate::modifier::Modifier;
use crate::saturation::Detector;
use crate::scalar::Scalar;
use crate::settings::{Mode, Settings, SettingsError, VelocitySource};

/// A mode with the parts that it has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ModeConfig {
    /// Passes an existing controller's command on.
    Guard,
    /// Modifies the reference of an existing controller.
    Modifier(Modifier),
    /// Commands the valve.
    Controller(Modifier, Law),
}

impl ModeConfig {
    /// The record modifier, in the modes that have a reference.
    pub(super) fn modifier(&self) -> Option<&Modifier> {
        match self {
            Self::Guard => None,
            Self::Modifier(modifier) | Self::Controller(modifier, _) => Some(modifier),
        }
    }

    /// Whether it is the same mode as another, of whatever parts.
    pub(super) fn is_of_kind(&self, other: &Self) -> bool {
        core::mem::discriminant(self) == core::mem::discriminant(other)
    }

    /// The three-variable law, where it commands the valve.
    pub(super) fn three_variable(&self) -> Option<&ThreeVariable> {
        match self {
            Self::Controller(_, Law::ThreeVariable(law)) => Some(law),
            _ => None,
        }
    }

    /// The tracking law, where it commands the valve.
    pub(super) fn tracking(&self) -> Option<&Tracking> {
        match self {
            Self::Controller(_, Law::Tracking(law)) => Some(law),
            _ => None,
        }
    }
}

/// The law of controller mode.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "one of them, in place; there is no allocation")]
pub(crate) enum Law {
    ThreeVariable(ThreeVariable),
    Tracking(Tracking),
}

/// The motion observer, and the low-pass on the acceleration that detection and guard look at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ObserverConfig {
    pub(super) motion: MotionObserver,
    pub(super) smoothing: Lag,
}

/// The guard's monitors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GuardConfig {
    pub(super) envelope: Envelope,
    pub(super) noise: NoiseMonitor,
    pub(super) inputs: InputMonitor,
    /// With an accelerometer.
    pub(super) plausibility: Option<Plausibility>,
    /// With an accelerometer.
    pub(super) witness: Option<DisplacementWitness>,
    /// Where the valve is the device's own or its command passes through.
    pub(super) valve: Option<ValveMonitor>,
    /// Where an existing controller's command is not ours to see.
    pub(super) still: Option<StillMonitor>,
    /// Ticks that a reading may be missing.
    pub(super) lost: u32,
}

/// Observer and monitors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MonitorConfig {
    pub(super) mode: Mode,
    pub(super) observer: Option<ObserverConfig>,
    /// Whether the velocity is that of a sensor, rather than the observer's.
    pub(super) velocity_sensor: bool,
    pub(super) detector: Option<Detector>,
    pub(super) guard: Option<GuardConfig>,
    pub(super) valve_gain: f32,
    pub(super) velocity_limit: f32,
}

/// The whole configuration of a [`crate::Controller`], exchanged as one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Config {
    pub(super) gate: InputGate,
    pub(super) monitors: MonitorConfig,
    pub(super) mode: ModeConfig,
    /// How a guarded test starts, holds and ends; none without a guard.
    pub(super) ramps: Option<Ramps>,
    /// Output at which no oil flows: this share of the LVDT's reading, and the null bias, m.
    pub(super) cancellation: f32,
    pub(super) null_bias: f32,
    pub(super) command_limit: f32,
    pub(super) within: Magnitude,
    /// Command beyond which the table moves no faster, m.
    pub(super) wide_open: f32,
    pub(super) anti_windup: bool,
    pub(super) blend_step: f32,
}

impl Config {
    /// No settings yet: nothing is read, nothing judged, nothing asked for.
    pub(super) fn idle() -> Self {
        Self {
            gate: InputGate::shut(),
            monitors: MonitorConfig {
                mode: Mode::Guard,
                observer: None,
                velocity_sensor: false,
                detector: None,
                guard: None,
                valve_gain: 0.0,
                velocity_limit: 0.0,
            },
            mode: ModeConfig::Guard,
            ramps: None,
            cancellation: 0.0,
            null_bias: 0.0,
            command_limit: 0.0,
            within: Magnitude::ZERO,
            wide_open: 0.0,
            anti_windup: false,
            blend_step: 1.0,
        }
    }

    /// Works out `settings`, or says which field does not hold.
    pub(crate) fn new(s: &Settings) -> Result<Self, SettingsError> {
        s.check_fields()?;
        let dt = 1.0 / s.rate;
        // Every part is worked out whatever the mode, so that a change of mode finds no field that does not hold.
        let three_variable = ThreeVariable::new(s)?;
        let law = tracking(s)?.map_or(Law::ThreeVariable(three_variable), Law::Tracking);
        let modifier = Modifier::new(s)?;
        Ok(Self {
            gate: InputGate::new(s),
            monitors: MonitorConfig::new(s, dt)?,
            mode: match s.mode {
                Mode::Guard => ModeConfig::Guard,
                Mode::Modifier => ModeConfig::Modifier(modifier),
                Mode::Controller => ModeConfig::Controller(modifier, law),
            },
            ramps: s.guard.map(|guard| Ramps::new(&guard.ramps, dt)).transpose()?,
            cancellation: s.cancellation(),
            null_bias: s.zero_flow(0.0),
            command_limit: s.command_limit(),
            within: Magnitude::new(s.command_limit()),
            wide_open: s.velocity_limit / s.valve.gain,
            anti_windup: s.anti_windup,
            blend_step: dt / s.blend.max(dt),
        })
    }
}

impl MonitorConfig {
    /// The step (m) after `step` of a reference that nothing more comes of, at ticks of `dt` (s).
    pub(super) fn coast(&self, step: f32, dt: f32) -> f32 {
        let kept = step.bounded(self.velocity_limit * dt);
        match &self.guard {
            Some(guard) => kept - kept.bounded(guard.envelope.stopping_deceleration() * dt * dt),
            None => 0.0,
        }
    }

    fn new(s: &Settings, dt: f32) -> Result<Self, SettingsError> {
        let turn = f32::from(TURNS) * dt;
        let observer = ObserverConfig {
            motion: MotionObserver::crossover(s.observer.frequency, dt)
                .map_err(|error| error.named("observer.frequency"))?,
            smoothing: Lag::new(s.observer.smoothing, dt).map_err(|error| error.named("observer.smoothing"))?,
        };
        let watched = s.guard.is_some() || s.saturation.is_some();
        let tracked = s.velocity.act() && s.velocity_source == VelocitySource::Observer;
        let detector = |detection| Detector::new(detection, s.velocity_limit, s.valve.lag, turn);
        Ok(Self {
            mode: s.mode,
            observer: (watched || tracked).then_some(observer),
            velocity_sensor: s.velocity_source == VelocitySource::Sensor,
            detector: s.saturation.as_ref().map(detector).transpose()?,
            guard: s.guard.as_ref().map(|guard| GuardConfig::new(guard, s, dt, turn)).transpose()?,
            valve_gain: s.valve.gain,
            velocity_limit: s.velocity_limit,
        })
    }
}

impl GuardConfig {
    /// Monitors that run at ticks of `dt` (s), and those that take turns at every `turn` (s).
    fn new(guard: &GuardSettings, s: &Settings, dt: f32, turn: f32) -> Result<Self, BlockError> {
        let accelerometer = s.observer.accelerometer;
        let plausibility = Plausibility::new(&guard.plausibility, turn)?;
        let envelope = Envelope::new(&guard.envelope, s.stroke, turn)?;
        let witness = DisplacementWitness::new(&guard.witness, s.velocity_limit, dt)?;
        let valve = ValveMonitor::new(&guard.valve, s.valve.lag, s.velocity_limit, turn)?;
        Ok(Self {
            // An existing controller's reference is not ours to know.
            envelope: if s.mode == Mode::Guard { envelope.without_tracking() } else { envelope },
            noise: NoiseMonitor::new(&guard.plausibility, &guard.envelope, accelerometer, dt)?,
            inputs: InputMonitor::new(&guard.inputs, guard.plausibility.lost, dt)?,
            plausibility: accelerometer.then_some(plausibility),
            witness: accelerometer.then_some(witness),
            valve: (s.mode != Mode::Modifier).then_some(valve),
            still: (s.mode == Mode::Modifier)
                .then(|| StillMonitor::new(guard.valve.mismatch, guard.valve.memory, turn)),
            lost: whole_ticks(require("guard.plausibility.lost", guard.plausibility.lost, 0.0, 1.0)?, dt),
        })
    }
}
