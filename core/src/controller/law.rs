//! The three-variable controller of Fig. 12: the loops that are in use, added up.

use super::config::{Config, Rates};
use crate::block::Block;
use crate::control::{AccelerationState, Blocked, DisplacementState, VelocityState};
use crate::filter::differentiator::DifferentiatorState;
use crate::sample::Sample;

/// What the loops remember.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Law {
    displacement: DisplacementState,
    velocity: VelocityState,
    acceleration: AccelerationState,
    first: DifferentiatorState,
    second: DifferentiatorState,
    reference_velocity: f32,
    reference_acceleration: f32,
}

impl Law {
    /// Velocity of the modified reference, m/s.
    #[inline]
    pub(super) fn reference_velocity(&self) -> f32 {
        self.reference_velocity
    }

    /// Works out the rates of the modified reference (m), which was `before` (m) a tick ago, as far as they are used.
    #[inline]
    pub(super) fn see_reference(&mut self, config: &Config, reference: f32, before: f32) {
        if config.velocity.is_none() && config.acceleration.is_none() {
            self.reference_velocity = (reference - before) * config.rate;
            return;
        }
        if let Rates::Differentiated(differentiator) = &config.rates {
            self.reference_velocity = differentiator.advance(&mut self.first, reference);
            self.reference_acceleration = differentiator.advance(&mut self.second, self.reference_velocity);
        }
    }

    /// One tick: modified reference (m), readings and measured velocity (m/s) in, command (m) out.
    #[inline]
    pub(super) fn step(
        &mut self,
        config: &Config,
        reference: f32,
        readings: &Sample,
        velocity: f32,
        blocked: Blocked,
    ) -> f32 {
        let (wanted_velocity, wanted_acceleration) = match config.rates {
            Rates::Differentiated(_) => (self.reference_velocity, self.reference_acceleration),
            Rates::Supplied => (readings.reference_velocity, readings.reference_acceleration),
            Rates::Zero => (0.0, 0.0),
        };
        let mut command =
            config.displacement.advance(&mut self.displacement, reference - readings.displacement, blocked);
        if let Some(law) = &config.velocity {
            command += law.advance(&mut self.velocity, wanted_velocity - velocity, blocked);
        }
        if let Some(law) = &config.acceleration {
            command += law.advance(&mut self.acceleration, wanted_acceleration - readings.acceleration, blocked);
        }
        command
    }
}
