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
    /// At rest, with the reference at `displacement` (m).
    pub(super) fn at(displacement: f32) -> Self {
        Self { first: DifferentiatorState::at(displacement), ..Self::default() }
    }

    /// Works out the rates of the modified `reference` (m).
    #[inline]
    pub(super) fn see_reference(&mut self, config: &Config, reference: f32, readings: &Sample) {
        (self.reference_velocity, self.reference_acceleration) = match &config.rates {
            Rates::Differentiated(differentiator) => {
                let velocity = differentiator.advance(&mut self.first, reference);
                (velocity, differentiator.advance(&mut self.second, velocity))
            }
            Rates::Supplied => (readings.reference_velocity, readings.reference_acceleration),
            Rates::Zero => (0.0, 0.0),
        };
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
        let error = reference - readings.displacement;
        let mut command = config.displacement.advance(&mut self.displacement, error, blocked);
        if let Some(law) = &config.velocity {
            command += law.advance(&mut self.velocity, self.reference_velocity - velocity, blocked);
        }
        if let Some(law) = &config.acceleration {
            let error = self.reference_acceleration - readings.acceleration;
            command += law.advance(&mut self.acceleration, error, blocked);
        }
        command
    }
}
