//! The laws of controller mode: the three-variable law of Fig. 12, or the tracking law in its place.

use crate::block::{Block, BlockError};
use crate::control::tracking::{Surroundings, TrackingInput};
use crate::control::{
    AccelerationLoop, AccelerationState, Blocked, DisplacementLoop, DisplacementState, LoopGains, Tracking,
    TrackingState, VelocityLoop, VelocityState,
};
use crate::filter::Differentiator;
use crate::filter::differentiator::DifferentiatorState;
use crate::sample::Sample;
use crate::settings::{Gains, ReferenceRates, Settings, SettingsError};

/// Where velocity and acceleration of the reference come from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rates {
    Differentiated(Differentiator),
    Supplied,
    Zero,
}

/// The three-variable law: the loops that are in use, added up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ThreeVariable {
    displacement: DisplacementLoop,
    velocity: Option<VelocityLoop>,
    acceleration: Option<AccelerationLoop>,
    rates: Rates,
}

/// What the loops remember.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct ThreeVariableState {
    displacement: DisplacementState,
    velocity: VelocityState,
    acceleration: AccelerationState,
    first: DifferentiatorState,
    second: DifferentiatorState,
    /// Whether the differentiators begin anew where the reference is.
    rates_begin: bool,
}

impl ThreeVariableState {
    /// At rest, with the reference at `displacement` (m).
    pub(super) fn at(displacement: f32) -> Self {
        Self { first: DifferentiatorState::at(displacement), ..Self::default() }
    }

    /// The law takes over from `before`: differentiators that did not run there begin where the reference is, so that it makes
    /// no velocity.
    pub(super) fn take_over(&mut self, before: Option<&ThreeVariable>) {
        self.rates_begin |= !before.is_some_and(ThreeVariable::tracks_rates);
    }
}

impl ThreeVariable {
    /// The law of `settings`, or the field that does not hold.
    pub(super) fn new(s: &Settings) -> Result<Self, SettingsError> {
        let (dt, limit) = (1.0 / s.rate, s.command_limit());
        let acceleration = AccelerationLoop::new(loop_gains(s.acceleration), dt, s.washout_frequency, limit)?;
        Ok(Self {
            displacement: DisplacementLoop::new(loop_gains(s.displacement), dt, limit),
            velocity: s.velocity.act().then(|| VelocityLoop::new(loop_gains(s.velocity), dt, limit)),
            acceleration: s.acceleration.act().then_some(acceleration),
            rates: rates(s.reference_rates, s.rate, dt)?,
        })
    }

    /// Whether any loop follows the reference's velocity or acceleration.
    fn tracks_rates(&self) -> bool {
        self.velocity.is_some() || self.acceleration.is_some()
    }

    /// Velocity (m/s) and acceleration (m/s2) of the modified `reference` (m).
    fn rates(&self, state: &mut ThreeVariableState, reference: f32, readings: &Sample) -> (f32, f32) {
        match &self.rates {
            Rates::Differentiated(differentiator) => {
                if state.rates_begin {
                    state.first = DifferentiatorState::at(reference);
                    (state.second, state.rates_begin) = (DifferentiatorState::default(), false);
                }
                let velocity = differentiator.advance(&mut state.first, reference);
                (velocity, differentiator.advance(&mut state.second, velocity))
            }
            Rates::Supplied => (readings.reference_velocity, readings.reference_acceleration),
            Rates::Zero => (0.0, 0.0),
        }
    }

    /// One tick: modified reference (m), readings and measured velocity (m/s) in, flow command (m) out.
    pub(super) fn step(
        &self,
        state: &mut ThreeVariableState,
        reference: f32,
        readings: &Sample,
        velocity: f32,
        blocked: Blocked,
    ) -> f32 {
        let mut command =
            self.displacement.advance(&mut state.displacement, reference - readings.displacement, blocked);
        if !self.tracks_rates() {
            return command;
        }
        let (reference_velocity, reference_acceleration) = self.rates(state, reference, readings);
        if let Some(law) = &self.velocity {
            command += law.advance(&mut state.velocity, reference_velocity - velocity, blocked);
        }
        if let Some(law) = &self.acceleration {
            let error = reference_acceleration - readings.acceleration;
            command += law.advance(&mut state.acceleration, error, blocked);
        }
        command
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

/// Works the tracking law out of `settings`, where they have one, or says which field does not hold.
#[inline(never)]
pub(super) fn tracking(settings: &Settings) -> Result<Option<Tracking>, SettingsError> {
    let s = settings;
    let around = Surroundings {
        dt: 1.0 / s.rate,
        valve: [s.valve.gain, s.valve.lag],
        command_limit: s.command_limit(),
        velocity_limit: s.velocity_limit,
    };
    s.tracking.as_ref().map(|tracking| tracking.law(&around)).transpose().map_err(SettingsError::from)
}

/// One tick of the tracking `law`: modified reference (m) and readings in, flow command (m) out.
pub(super) fn track(law: &Tracking, state: &mut TrackingState, reference: f32, readings: &Sample) -> f32 {
    let seen = TrackingInput {
        reference,
        displacement: readings.displacement,
        acceleration: readings.acceleration,
        pressure_difference: readings.pressure_difference,
    };
    law.advance(state, &seen)
}
