//! Effects that look alike in a test that shows little, as laboratories meet them. Whether they do in the test that was drawn
//! is measured; the table only says where it is worth trying.

use crate::lab::scene::test::{Motion, Test};
use crate::refit::Parameter as P;

/// Effects that one test may fail to tell apart.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// The effects, any of which may be the true one.
    pub effects: &'static [&'static str],
    /// The test.
    pub test: Test,
}

const fn row(effects: &'static [&'static str], motion: Motion, accelerometer: bool, free: &'static [P]) -> Row {
    Row { effects, test: Test { motion, accelerometer, free } }
}

/// All that makes a displacement late.
const LATE: &[&str] = &["command_delay", "valve_lag", "displacement_lag", "leakage", "valve_rate_limit"];
/// All that makes a table late.
const LATE_TABLE: &[&str] = &["command_delay", "valve_lag", "leakage", "valve_rate_limit"];

/// All rows.
pub const ROWS: [Row; 6] = [
    // Slow motion is only late, whatever makes it so. A free pole would take the lateness up.
    row(LATE, Motion::Slow, false, &[P::B0]),
    // Where the table hardly moves a slope is an offset.
    row(&["acceleration_bias", "tilt_coupling"], Motion::OffMiddle, true, &[P::B0]),
    row(LATE_TABLE, Motion::Slow, true, &[P::B0]),
    // At a steady speed friction and lap each take a constant share of the command.
    row(&["coulomb_friction", "stribeck_friction", "valve_deadband"], Motion::Strokes, false, &[P::B0]),
    row(LATE, Motion::Slow, false, &[]),
    // About a place off the middle the slope of a bent displacement sensor is a scale.
    row(&["displacement_nonlinearity", "acceleration_gain"], Motion::OffMiddle, true, &[P::B0]),
];
