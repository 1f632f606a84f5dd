//! The check of [`Settings`] as a whole.

use super::{Gains, Mode, ReferenceRates, Settings, SettingsError};
use crate::block::require;
use crate::controller::Config;

impl Settings {
    /// Checks every field, and that they go together. The whole configuration is worked out on the way, so that what
    /// passes here cannot fail later.
    pub fn validate(&self) -> Result<(), SettingsError> {
        Config::new(self).map(|_| ())
    }

    /// Checks the fields that no block checks by itself.
    pub(crate) fn check_fields(&self) -> Result<(), SettingsError> {
        require("rate", self.rate, 50.0, 20_000.0)?;
        gains(["displacement.proportional", "displacement.integral"], self.displacement)?;
        gains(["velocity.proportional", "velocity.integral"], self.velocity)?;
        gains(["acceleration.proportional", "acceleration.integral"], self.acceleration)?;
        require("velocity_limit", self.velocity_limit, 1e-3, 5.0)?;
        require("stroke", self.stroke, 1e-3, 10.0)?;
        require("blend", self.blend, 0.0, 10.0)?;
        require("valve.gain", self.valve.gain, 1e-3, 1e4)?;
        require("valve.lag", self.valve.lag, 0.0, 10.0)?;
        require("valve.null_bias", self.valve.null_bias, -1.0, 1.0)?;
        require("valve.command_limit", self.valve.command_limit, 1e-4, 100.0)?;
        require("ranges.reference", self.ranges.reference, self.stroke, 100.0)?;
        require("ranges.displacement", self.ranges.displacement, self.stroke, 100.0)?;
        require("ranges.velocity", self.ranges.velocity, self.velocity_limit, 1000.0)?;
        require("ranges.acceleration", self.ranges.acceleration, 0.1, 1e5)?;
        require("ranges.external", self.ranges.external, 1e-4, 1e4)?;
        require("ranges.pressure_difference", self.ranges.pressure_difference, 1e3, 1e9)?;
        if let ReferenceRates::Derived { frequency } = self.reference_rates {
            require("reference_rates.frequency", frequency, 0.1, 1e6)?;
        }
        self.check_together()
    }

    /// Checks that the fields go together.
    fn check_together(&self) -> Result<(), SettingsError> {
        if self.acceleration.act() && !self.observer.accelerometer && self.mode == Mode::Controller {
            return Err(SettingsError::Contradiction { field: "acceleration", with: "observer.accelerometer = false" });
        }
        Ok(())
    }
}

fn gains(fields: [&'static str; 2], gains: Gains) -> Result<(), SettingsError> {
    let [proportional, integral] = fields;
    require(proportional, gains.proportional, -1e4, 1e4)?;
    require(integral, gains.integral, -1e4, 1e4)?;
    Ok(())
}
