//! Settings worked out into coefficients: everything a tick needs and nothing it has to divide by.

use super::watch::TURNS;
use crate::block::{BlockError, require};
use crate::control::{AccelerationLoop, DisplacementLoop, LoopGains, VelocityLoop};
use crate::filter::{Differentiator, Fusion, Lag};
use crate::guard::supervisor::Ramps;
use crate::guard::{
    DisplacementWitness, Envelope, GuardSettings, InputMonitor, NoiseMonitor, Plausibility, ValveMonitor, Walls,
};
use crate::math::Magnitude;
use crate::modifier::Modifier;
use crate::saturation::Detector;
use crate::settings::{Gains, Mode, ReferenceRates, Settings, SettingsError, VelocitySource};

/// Where velocity and acceleration of the reference come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Rates {
    Differentiated(Differentiator),
    Supplied,
    Zero,
}

/// Which of the parts are in use that a configuration may do without. They lie in it all the same, so that a tick with all
/// of them asks once and not for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Parts {
    pub(crate) observer: bool,
    pub(crate) velocity_sensor: bool,
    pub(crate) detector: bool,
    pub(crate) guard: bool,
    pub(crate) plausibility: bool,
}

impl Parts {
    /// Everything that looks on, and the velocity is the observer's.
    const ALL: Self = Self { observer: true, velocity_sensor: false, detector: true, guard: true, plausibility: true };
    const NONE: Self =
        Self { observer: false, velocity_sensor: false, detector: false, guard: false, plausibility: false };

    /// Those that `settings` name.
    fn of(s: &Settings) -> Self {
        let watched = s.guard.is_some() || s.saturation.is_some();
        let tracked = s.velocity.act() && s.velocity_source == VelocitySource::Observer;
        Self {
            observer: watched || tracked,
            velocity_sensor: s.velocity_source == VelocitySource::Sensor,
            detector: s.saturation.is_some(),
            guard: s.guard.is_some(),
            plausibility: s.guard.is_some() && s.observer.accelerometer,
        }
    }
}

/// The guard's configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Guard {
    pub(crate) envelope: Envelope,
    pub(crate) plausibility: Plausibility,
    pub(crate) noise: NoiseMonitor,
    pub(crate) witness: DisplacementWitness,
    pub(crate) inputs: InputMonitor,
    pub(crate) valve: ValveMonitor,
    pub(crate) ramps: Ramps,
    pub(crate) lost: u32,
}

/// The whole configuration of a [`crate::Controller`], exchanged as one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Config {
    pub(crate) mode: Mode,
    pub(crate) walls: Walls,
    pub(crate) parts: Parts,
    pub(crate) observer: Fusion,
    pub(crate) smoothing: Lag,
    pub(crate) detector: Detector,
    pub(crate) modifier: Modifier,
    pub(crate) displacement: DisplacementLoop,
    pub(crate) velocity: Option<VelocityLoop>,
    pub(crate) acceleration: Option<AccelerationLoop>,
    pub(crate) rates: Rates,
    /// Whether anything looks at the reference's rates.
    pub(crate) uses_rates: bool,
    /// Output at which no oil flows: this share of the LVDT's reading, and the null bias, m.
    pub(crate) cancellation: f32,
    pub(crate) null_bias: f32,
    pub(crate) valve_gain: f32,
    pub(crate) command_limit: f32,
    pub(crate) within: Magnitude,
    /// Command beyond which the table moves no faster, m.
    pub(crate) wide_open: f32,
    pub(crate) anti_windup: bool,
    pub(crate) velocity_limit: f32,
    pub(crate) blend_step: f32,
    pub(crate) guard: Guard,
}

impl Config {
    /// No settings yet: nothing is read, nothing watched, nothing asked for.
    pub(crate) fn none() -> Self {
        Self {
            mode: Mode::Controller,
            walls: Walls::shut(),
            parts: Parts::NONE,
            observer: Fusion::none(),
            smoothing: Lag::none(),
            detector: Detector::none(),
            modifier: Modifier::Off,
            displacement: DisplacementLoop::new(LoopGains { proportional: 0.0, integral: 0.0 }, 0.0, 0.0),
            velocity: None,
            acceleration: None,
            rates: Rates::Zero,
            uses_rates: false,
            cancellation: 0.0,
            null_bias: 0.0,
            valve_gain: 0.0,
            command_limit: 0.0,
            within: Magnitude::ZERO,
            wide_open: 0.0,
            anti_windup: false,
            velocity_limit: 0.0,
            blend_step: 1.0,
            guard: Guard::none(),
        }
    }

    /// Whether every part that looks on is in use.
    pub(crate) fn complete(&self) -> bool {
        self.parts == Parts::ALL
    }

    /// Whether it is complete, guards an existing controller, and reads no channel that few tables have.
    pub(crate) fn guards(&self) -> bool {
        self.complete() && self.mode == Mode::Guard && self.walls.three()
    }

    /// Works out `settings`, or says which field does not hold.
    pub(crate) fn new(settings: &Settings) -> Result<Self, SettingsError> {
        settings.check_fields()?;
        let s = settings;
        let dt = 1.0 / s.rate;
        let limit = s.valve.command_limit;
        let acceleration =
            AccelerationLoop::new(loop_gains(s.acceleration), dt, s.washout_frequency, limit).map(Some)?;
        Ok(Self {
            mode: s.mode,
            walls: Walls::new(s),
            parts: Parts::of(s),
            observer: Fusion::new(s.observer.frequency, dt).map_err(|error| error.named("observer.frequency"))?,
            smoothing: Lag::new(s.observer.smoothing, dt).map_err(|error| error.named("observer.smoothing"))?,
            detector: match &s.saturation {
                Some(detection) => Detector::new(detection, s.velocity_limit, s.valve.lag, f32::from(TURNS) * dt)?,
                None => Detector::none(),
            },
            modifier: Modifier::new(s)?,
            displacement: DisplacementLoop::new(loop_gains(s.displacement), dt, limit),
            velocity: s.velocity.act().then(|| VelocityLoop::new(loop_gains(s.velocity), dt, limit)),
            acceleration: if s.acceleration.act() { acceleration } else { None },
            uses_rates: s.velocity.act() || s.acceleration.act(),
            rates: rates(s.reference_rates, s.rate, dt)?,
            // An existing position controller subtracts the LVDT, and its own null bias is not ours to know.
            cancellation: if s.mode == Mode::Modifier { 1.0 } else { s.inner_loop.cancellation(1.0) },
            null_bias: if s.mode == Mode::Modifier { 0.0 } else { s.valve.null_bias },
            valve_gain: s.valve.gain,
            command_limit: limit,
            within: Magnitude::new(limit),
            wide_open: s.velocity_limit / s.valve.gain,
            anti_windup: s.anti_windup,
            velocity_limit: s.velocity_limit,
            blend_step: dt / s.blend.max(dt),
            guard: match &s.guard {
                Some(guard) => Guard::new(guard, s, dt)?,
                None => Guard::none(),
            },
        })
    }
}

impl Guard {
    fn none() -> Self {
        Self {
            envelope: Envelope::none(),
            plausibility: Plausibility::none(),
            noise: NoiseMonitor::none(),
            witness: DisplacementWitness::none(),
            inputs: InputMonitor::none(),
            valve: ValveMonitor::none(),
            ramps: Ramps::none(),
            lost: 0,
        }
    }

    fn new(guard: &GuardSettings, s: &Settings, dt: f32) -> Result<Self, BlockError> {
        let turn = f32::from(TURNS) * dt;
        let plausibility = Plausibility::new(&guard.plausibility, turn)?;
        let envelope = Envelope::new(&guard.envelope, s.stroke, turn)?;
        Ok(Self {
            // An existing controller's reference is not ours to know.
            envelope: if s.mode == Mode::Guard { envelope.without_tracking() } else { envelope },
            plausibility,
            noise: NoiseMonitor::new(&guard.plausibility, &guard.envelope, s.observer.accelerometer, dt)?,
            inputs: InputMonitor::new(&guard.inputs, guard.plausibility.lost, dt)?,
            witness: DisplacementWitness::new(&guard.witness, s.velocity_limit, dt)?,
            valve: ValveMonitor::new(&guard.valve, s.valve.lag, turn)?,
            ramps: Ramps::new(&guard.ramps, dt)?,
            lost: (require("guard.plausibility.lost", guard.plausibility.lost, 0.0, 1.0)? / dt) as u32,
        })
    }
}

fn loop_gains(gains: Gains) -> LoopGains {
    LoopGains { proportional: gains.proportional, integral: gains.integral }
}

fn rates(rates: ReferenceRates, rate: f32, dt: f32) -> Result<Rates, BlockError> {
    Ok(match rates {
        ReferenceRates::Derived { frequency } => Rates::Differentiated(Differentiator::new(frequency, dt)?),
        ReferenceRates::Differences => Rates::Differentiated(Differentiator::new(rate, dt)?),
        ReferenceRates::Supplied => Rates::Supplied,
        ReferenceRates::Zero => Rates::Zero,
    })
}
