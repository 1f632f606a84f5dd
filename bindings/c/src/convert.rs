//! From C's settings to the core's and back. Numbers that stand for no name are refused; the core judges the rest.

use shakedown_core::settings::{
    self as core_settings, Detection, EnvelopeSettings, FlowSettings, ForceSettings, FrictionSettings, GuardSettings,
    InnerLoop, InputSettings, NoiseSettings, NotchSettings, ObserverSettings, OilSettings, PlausibilitySettings,
    PressureSettings, RampSettings, ReferenceRates, TrackingSettings, ValveMonitorSettings, ValveSettings,
    VelocitySource, WitnessSettings,
};
use shakedown_core::{Mode, Modification};

use crate::guard::{Envelope, Force, Guard, Inputs, Plausibility, Ramps, ValveMonitor, Witness};
use crate::numbers::SHAKEDOWN_WRONG_VALUE;
use crate::settings::{Gains, Observer, Ranges, Saturation, Settings, Valve};
use crate::tracking::{Flow, Friction, Noise, Notch, Oil, Pressure, Tracking};

const MODES: [Mode; 3] = [Mode::Guard, Mode::Modifier, Mode::Controller];
const INNER_LOOPS: [InnerLoop; 2] = [InnerLoop::Absent, InnerLoop::Hardwired];
const VELOCITY_SOURCES: [VelocitySource; 2] = [VelocitySource::Observer, VelocitySource::Sensor];

fn named<T: Copy>(names: &[T], number: u8) -> Result<T, i32> {
    names.get(usize::from(number)).copied().ok_or(SHAKEDOWN_WRONG_VALUE)
}

fn number<T: PartialEq>(names: &[T], name: &T) -> u8 {
    names.iter().position(|known| known == name).unwrap_or_default() as u8
}

/// A part that may be left out.
fn part<C: Copy, T: From<C>>(has: u8, part: C) -> Option<T> {
    (has != 0).then(|| part.into())
}

/// Both ways, for a part whose fields are all numbers.
macro_rules! copies {
    ($ours:ident, $core:ty: $($field:ident),+) => {
        impl From<$ours> for $core {
            fn from(c: $ours) -> Self {
                Self { $($field: c.$field),+ }
            }
        }
        impl From<$core> for $ours {
            fn from(c: $core) -> Self {
                Self { $($field: c.$field),+ }
            }
        }
    };
}

copies!(Gains, core_settings::Gains: proportional, integral);
copies!(Valve, ValveSettings: gain, lag, null_bias, command_limit);
copies!(Ranges, core_settings::Ranges: reference, displacement, velocity, acceleration, external, pressure_difference);
copies!(Saturation, Detection: plateau, error, shortfall, floor, hold, follow, recovery);
copies!(Noise, NoiseSettings: displacement, acceleration);
copies!(Flow, FlowSettings: asymmetry, sharpness, stall, droop, recovery, overdrive);
copies!(Friction, FrictionSettings: coulomb, viscous, velocity, deadband);
copies!(Oil, OilSettings: frequency, damping);
copies!(Pressure, PressureSettings: area_per_mass, gain, corner);
copies!(Notch, NotchSettings: frequency, damping);
copies!(Force, ForceSettings: limit, piston_area);
copies!(Plausibility, PlausibilitySettings: lost, stuck, disagreement, offset, acceleration_noise);
copies!(Witness, WitnessSettings: frequency, scale, delay, bias, noise);
copies!(ValveMonitor, ValveMonitorSettings: mismatch, memory);
copies!(Ramps, RampSettings: test, safe);

impl From<Observer> for ObserverSettings {
    fn from(c: Observer) -> Self {
        Self { frequency: c.frequency, accelerometer: c.accelerometer != 0, smoothing: c.smoothing }
    }
}

impl From<ObserverSettings> for Observer {
    fn from(c: ObserverSettings) -> Self {
        Self { frequency: c.frequency, accelerometer: u8::from(c.accelerometer), smoothing: c.smoothing }
    }
}

impl From<Tracking> for TrackingSettings {
    fn from(c: Tracking) -> Self {
        Self {
            bandwidth: c.bandwidth,
            disturbance: c.disturbance,
            delay: c.delay,
            lead: c.lead,
            spacing: c.spacing,
            noise: c.noise.into(),
            flow: c.flow.into(),
            friction: c.friction.into(),
            oil: part(c.has_oil, c.oil),
            pressure: part(c.has_pressure, c.pressure),
            notch: part(c.has_notch, c.notch),
        }
    }
}

impl From<TrackingSettings> for Tracking {
    fn from(c: TrackingSettings) -> Self {
        Self {
            bandwidth: c.bandwidth,
            disturbance: c.disturbance,
            delay: c.delay,
            lead: c.lead,
            spacing: c.spacing,
            noise: c.noise.into(),
            flow: c.flow.into(),
            friction: c.friction.into(),
            oil: c.oil.map_or(Oil { frequency: 0.0, damping: 0.0 }, Into::into),
            has_oil: u8::from(c.oil.is_some()),
            pressure: c.pressure.map_or(Pressure { area_per_mass: 0.0, gain: 0.0, corner: 0.0 }, Into::into),
            has_pressure: u8::from(c.pressure.is_some()),
            notch: c.notch.map_or(Notch { frequency: 0.0, damping: 0.0 }, Into::into),
            has_notch: u8::from(c.notch.is_some()),
        }
    }
}

impl From<Envelope> for EnvelopeSettings {
    fn from(c: Envelope) -> Self {
        Self {
            margin: c.margin,
            stopping_latency: c.stopping_latency,
            stopping_deceleration: c.stopping_deceleration,
            velocity: c.velocity,
            acceleration: c.acceleration,
            jerk: c.jerk,
            force: part(c.has_force, c.force),
            tracking: c.tracking,
            persistence: c.persistence,
        }
    }
}

impl From<EnvelopeSettings> for Envelope {
    fn from(c: EnvelopeSettings) -> Self {
        Self {
            margin: c.margin,
            stopping_latency: c.stopping_latency,
            stopping_deceleration: c.stopping_deceleration,
            velocity: c.velocity,
            acceleration: c.acceleration,
            jerk: c.jerk,
            force: c.force.map_or(Force { limit: 0.0, piston_area: 0.0 }, Into::into),
            has_force: u8::from(c.force.is_some()),
            tracking: c.tracking,
            persistence: c.persistence,
        }
    }
}

impl From<Inputs> for InputSettings {
    fn from(c: Inputs) -> Self {
        Self {
            second_displacement: part(c.has_second_displacement, c.second_displacement),
            limit_switches: c.limit_switches != 0,
            relay_feedback: part(c.has_relay_feedback, c.relay_feedback),
        }
    }
}

impl From<InputSettings> for Inputs {
    fn from(c: InputSettings) -> Self {
        Self {
            second_displacement: c.second_displacement.unwrap_or_default(),
            has_second_displacement: u8::from(c.second_displacement.is_some()),
            limit_switches: u8::from(c.limit_switches),
            relay_feedback: c.relay_feedback.unwrap_or_default(),
            has_relay_feedback: u8::from(c.relay_feedback.is_some()),
        }
    }
}

impl From<Guard> for GuardSettings {
    fn from(c: Guard) -> Self {
        Self {
            envelope: c.envelope.into(),
            plausibility: c.plausibility.into(),
            witness: c.witness.into(),
            valve: c.valve.into(),
            inputs: c.inputs.into(),
            ramps: c.ramps.into(),
        }
    }
}

impl From<GuardSettings> for Guard {
    fn from(c: GuardSettings) -> Self {
        Self {
            envelope: c.envelope.into(),
            plausibility: c.plausibility.into(),
            witness: c.witness.into(),
            valve: c.valve.into(),
            inputs: c.inputs.into(),
            ramps: c.ramps.into(),
        }
    }
}

impl TryFrom<&Settings> for core_settings::Settings {
    type Error = i32;

    fn try_from(c: &Settings) -> Result<Self, i32> {
        let modifications = [
            Modification::Off,
            Modification::Clip,
            Modification::Causal,
            Modification::Preview { seconds: c.preview_seconds },
        ];
        let rates = [
            ReferenceRates::Differences,
            ReferenceRates::Derived { frequency: c.rates_frequency },
            ReferenceRates::Supplied,
            ReferenceRates::Zero,
        ];
        Ok(Self {
            rate: c.rate,
            mode: named(&MODES, c.mode)?,
            displacement: c.displacement.into(),
            velocity: c.velocity.into(),
            acceleration: c.acceleration.into(),
            velocity_limit: c.velocity_limit,
            stroke: c.stroke,
            inner_loop: named(&INNER_LOOPS, c.inner_loop)?,
            anti_windup: c.anti_windup != 0,
            modification: named(&modifications, c.modification)?,
            reference_rates: named(&rates, c.reference_rates)?,
            velocity_source: named(&VELOCITY_SOURCES, c.velocity_source)?,
            washout_frequency: c.washout_frequency,
            observer: c.observer.into(),
            valve: c.valve.into(),
            ranges: c.ranges.into(),
            blend: c.blend,
            tracking: part(c.has_tracking, c.tracking),
            saturation: part(c.has_saturation, c.saturation),
            guard: part(c.has_guard, c.guard),
        })
    }
}

/// The number of a modification, and its preview.
fn modification(modification: Modification) -> (u8, f32) {
    match modification {
        Modification::Clip => (1, 0.0),
        Modification::Causal => (2, 0.0),
        Modification::Preview { seconds } => (3, seconds),
        _ => (0, 0.0),
    }
}

/// The number of a source of rates, and its band.
fn rates(rates: ReferenceRates) -> (u8, f32) {
    match rates {
        ReferenceRates::Differences => (0, 0.0),
        ReferenceRates::Derived { frequency } => (1, frequency),
        ReferenceRates::Supplied => (2, 0.0),
        ReferenceRates::Zero => (3, 0.0),
    }
}

impl From<&core_settings::Settings> for Settings {
    fn from(c: &core_settings::Settings) -> Self {
        let (modification, preview_seconds) = modification(c.modification);
        let (reference_rates, rates_frequency) = rates(c.reference_rates);
        Self {
            rate: c.rate,
            mode: number(&MODES, &c.mode),
            displacement: c.displacement.into(),
            velocity: c.velocity.into(),
            acceleration: c.acceleration.into(),
            velocity_limit: c.velocity_limit,
            stroke: c.stroke,
            inner_loop: number(&INNER_LOOPS, &c.inner_loop),
            anti_windup: u8::from(c.anti_windup),
            modification,
            preview_seconds,
            reference_rates,
            rates_frequency,
            velocity_source: number(&VELOCITY_SOURCES, &c.velocity_source),
            washout_frequency: c.washout_frequency,
            observer: c.observer.into(),
            valve: c.valve.into(),
            ranges: c.ranges.into(),
            blend: c.blend,
            tracking: c.tracking.unwrap_or_default().into(),
            has_tracking: u8::from(c.tracking.is_some()),
            saturation: c.saturation.unwrap_or_default().into(),
            has_saturation: u8::from(c.saturation.is_some()),
            guard: c.guard.unwrap_or_default().into(),
            has_guard: u8::from(c.guard.is_some()),
        }
    }
}
