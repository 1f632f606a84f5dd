//! Values that no table has.

use super::StatedEffect;
use crate::plant::effects;
use crate::recording::error::{Problem, RecordingError};

/// By how much a stated parameter may pass the library's range, which fits keep to.
const FAR: f64 = 100.0;

impl StatedEffect {
    /// Refuses a negative value of what is a size, a time or a rate, a frequency of zero, and what lies a thousandfold beyond
    /// the library's range.
    pub(super) fn check_signs(&self, parameters: &[effects::Parameter]) -> Result<(), RecordingError> {
        for parameter in parameters {
            let Some(&value) = self.parameters.get(parameter.key) else { continue };
            let refuse = |expected| {
                let place = self.place.clone().column(&format!("effects.{}.{}", self.id, parameter.key));
                Err(place.refuse(Problem::OutOfRange { value, expected }))
            };
            let absolute = parameter.signal_scale == effects::SignalScale::One;
            if parameter.positive && value < 0.0 {
                return refuse("it cannot be negative");
            }
            if parameter.positive && value == 0.0 && parameter.key == "frequency" {
                return refuse("it must be above zero");
            }
            if value.abs() > 1e9 || absolute && value.abs() > FAR * parameter.high.abs().max(parameter.low.abs()) {
                return refuse("it is far beyond what a table has; see `shakedown effects` for its unit");
            }
        }
        Ok(())
    }
}
