//! The numbers that stand for names.

/// Behind an existing controller: passes its command on, detects saturation, enforces limits.
pub const SHAKEDOWN_MODE_GUARD: u8 = 0;
/// In front of an existing controller: reference in, reference that the table can follow out.
pub const SHAKEDOWN_MODE_MODIFIER: u8 = 1;
/// Instead of one: reference and sensors in, valve command out.
pub const SHAKEDOWN_MODE_CONTROLLER: u8 = 2;

/// Nothing stands between the output and the valve.
pub const SHAKEDOWN_INNER_LOOP_ABSENT: u8 = 0;
/// A controller with unity proportional gain that subtracts the LVDT from the output.
pub const SHAKEDOWN_INNER_LOOP_HARDWIRED: u8 = 1;

/// The reference is not modified.
pub const SHAKEDOWN_MODIFICATION_OFF: u8 = 0;
/// Velocity clipped, then integrated; drifts.
pub const SHAKEDOWN_MODIFICATION_CLIP: u8 = 1;
/// Inside velocity and stroke, without drift and without preview.
pub const SHAKEDOWN_MODIFICATION_CAUSAL: u8 = 2;
/// The same with preview: `preview_seconds`.
pub const SHAKEDOWN_MODIFICATION_PREVIEW: u8 = 3;

/// Backward differences of the modified reference.
pub const SHAKEDOWN_RATES_DIFFERENCES: u8 = 0;
/// Differentiated within a band: `rates_frequency`.
pub const SHAKEDOWN_RATES_DERIVED: u8 = 1;
/// With each sample.
pub const SHAKEDOWN_RATES_SUPPLIED: u8 = 2;
/// Zero: pure feedback.
pub const SHAKEDOWN_RATES_ZERO: u8 = 3;

/// The table's velocity is the observer's.
pub const SHAKEDOWN_VELOCITY_SOURCE_OBSERVER: u8 = 0;
/// The table's velocity is a sensor's.
pub const SHAKEDOWN_VELOCITY_SOURCE_SENSOR: u8 = 1;

/// Off to ready.
pub const SHAKEDOWN_REQUEST_ARM: u8 = 0;
/// Ready to running.
pub const SHAKEDOWN_REQUEST_START: u8 = 1;
/// Running to hold.
pub const SHAKEDOWN_REQUEST_HOLD: u8 = 2;
/// Hold to running.
pub const SHAKEDOWN_REQUEST_RESUME: u8 = 3;
/// Running or hold to ready, by way of a ramp.
pub const SHAKEDOWN_REQUEST_STOP: u8 = 4;
/// Ready to off.
pub const SHAKEDOWN_REQUEST_OFF: u8 = 5;
/// Tripped to off: the deliberate act without which a trip stands.
pub const SHAKEDOWN_REQUEST_RESET: u8 = 6;
/// Anything to tripped, for what only the board can see.
pub const SHAKEDOWN_REQUEST_TRIP: u8 = 7;

/// Relay open, no flow asked for.
pub const SHAKEDOWN_STATE_OFF: u8 = 0;
/// Relay closed, the table held where it stood.
pub const SHAKEDOWN_STATE_READY: u8 = 1;
/// The test runs.
pub const SHAKEDOWN_STATE_RUNNING: u8 = 2;
/// The test is faded out and the table held.
pub const SHAKEDOWN_STATE_HOLD: u8 = 3;
/// On the way to a stand, then ready.
pub const SHAKEDOWN_STATE_RAMP_DOWN: u8 = 4;
/// No flow asked for; relay open.
pub const SHAKEDOWN_STATE_TRIPPED: u8 = 5;

/// It was done.
pub const SHAKEDOWN_OK: i32 = 0;
/// A setting is not a number, or outside its range.
pub const SHAKEDOWN_OUT_OF_RANGE: i32 = 1;
/// Two settings contradict each other.
pub const SHAKEDOWN_CONTRADICTION: i32 = 2;
/// A setting is within its own range, but not with the others.
pub const SHAKEDOWN_CONFLICT: i32 = 3;
/// The request does not apply in this state.
pub const SHAKEDOWN_REFUSED_STATE: i32 = 4;
/// The safe ramp after the trip has not ended.
pub const SHAKEDOWN_REFUSED_MOVING: i32 = 5;
/// The guard sees a reason to trip already.
pub const SHAKEDOWN_REFUSED_CAUSE: i32 = 6;
/// There is no guard, and so nothing to ask.
pub const SHAKEDOWN_REFUSED_NO_GUARD: i32 = 7;
/// There is no setting of this name.
pub const SHAKEDOWN_UNKNOWN_NAME: i32 = 8;
/// The value is not of the setting's kind, or no number of the enum's.
pub const SHAKEDOWN_WRONG_VALUE: i32 = 9;
/// There is no request of this number.
pub const SHAKEDOWN_UNKNOWN_REQUEST: i32 = 10;
/// A pointer is null.
pub const SHAKEDOWN_NULL: i32 = 11;
/// A pointer is not aligned for its type.
pub const SHAKEDOWN_MISALIGNED: i32 = 12;
/// The storage is too small.
pub const SHAKEDOWN_TOO_SMALL: i32 = 13;
/// The storage holds no controller: `shakedown_init` was not called, or refused.
pub const SHAKEDOWN_UNINITIALISED: i32 = 14;
/// A text is not UTF-8.
pub const SHAKEDOWN_NO_TEXT: i32 = 15;
