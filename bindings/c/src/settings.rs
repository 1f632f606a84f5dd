//! Everything that may be set, as C sees it: the same fields and units as in the core, enums as numbers, and a flag where a
//! part may be left out.

use crate::guard::Guard;
use crate::tracking::Tracking;

/// Proportional and integral gain of one feedback loop of Fig. 12.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Gains {
    /// Proportional gain, 1.
    pub proportional: f32,
    /// Integral gain, 1/s.
    pub integral: f32,
}

/// The observer of the table's velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Observer {
    /// Below this the LVDT is believed, above it the accelerometer, Hz.
    pub frequency: f32,
    /// Whether an accelerometer is fitted; without one `acceleration` is not read. 0 is no.
    pub accelerometer: u8,
    /// Time constant of the low-pass on the acceleration that saturation detection and guard look at, s.
    pub smoothing: f32,
}

/// What is known of the servovalve and its actuator, for what must know how the table will answer.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Valve {
    /// Velocity per command at rest, 1/s: b0 / a1 of Eq. 7.
    pub gain: f32,
    /// Time constant of the velocity, s: 1 / a1 of Eq. 7.
    pub lag: f32,
    /// Command at which no oil flows, m, beside what the inner loop asks for.
    pub null_bias: f32,
    /// Largest command either way, beyond the one at which no oil flows, m.
    pub command_limit: f32,
}

/// Largest readings that can be true, either way from zero. A reading beyond is not used: the last good output is held.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Ranges {
    /// Reference displacement, m.
    pub reference: f32,
    /// LVDT, m.
    pub displacement: f32,
    /// Velocity sensor and supplied reference velocity, m/s.
    pub velocity: f32,
    /// Accelerometer and supplied reference acceleration, m/s2.
    pub acceleration: f32,
    /// Existing controller's command, m.
    pub external: f32,
    /// Pressure difference, Pa.
    pub pressure_difference: f32,
}

/// How saturation is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Saturation {
    /// Acceleration below which a table is held to move at constant speed, m/s2; a few times the sensor's noise.
    pub plateau: f32,
    /// Error below which nothing is asked for, m.
    pub error: f32,
    /// By how much the speed asked for must exceed the speed had, 1.
    pub shortfall: f32,
    /// Smallest limit that is thought possible, as a share of the set one, 1.
    pub floor: f32,
    /// How long the evidence must last, s.
    pub hold: f32,
    /// Time constant with which the estimate goes to a speed seen in saturation, s.
    pub follow: f32,
    /// Time constant with which the estimate recovers to the set limit, s.
    pub recovery: f32,
}

/// Everything a user may set. What is left out of a file has the default's value: the paper's current controller,
/// bare, at 1 kHz.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Settings {
    /// Control rate, Hz, 50 to 20,000.
    pub rate: f32,
    /// Place in the valve command path.
    /// One of `SHAKEDOWN_MODE_...`.
    pub mode: u8,
    /// Gains on the displacement error.
    pub displacement: Gains,
    /// Gains on the velocity error, whose sum is integrated once.
    pub velocity: Gains,
    /// Gains on the acceleration error, whose sum is integrated twice.
    pub acceleration: Gains,
    /// Largest speed of the table, m/s.
    pub velocity_limit: f32,
    /// Largest displacement from centre, m.
    pub stroke: f32,
    /// What the output drives: the valve, or a hard-wired loop that has to be cancelled.
    /// One of `SHAKEDOWN_INNER_LOOP_...`.
    pub inner_loop: u8,
    /// Whether integrators stop while the valve or the command is at its limit. 0 is no.
    pub anti_windup: u8,
    /// How the reference is modified.
    /// One of `SHAKEDOWN_MODIFICATION_...`.
    pub modification: u8,
    /// How far ahead a preview looks, s.
    pub preview_seconds: f32,
    /// Velocity and acceleration of the reference.
    /// One of `SHAKEDOWN_RATES_...`.
    pub reference_rates: u8,
    /// Band of the differentiators of derived rates, Hz.
    pub rates_frequency: f32,
    /// Velocity of the table.
    /// One of `SHAKEDOWN_VELOCITY_SOURCE_...`.
    pub velocity_source: u8,
    /// Corner of the acceleration loop's washout, Hz.
    pub washout_frequency: f32,
    /// The observer.
    pub observer: Observer,
    /// The valve.
    pub valve: Valve,
    /// What readings can be true.
    pub ranges: Ranges,
    /// Time over which a change of settings or of mode is blended in, s.
    pub blend: f32,
    /// The tracking law, in controller mode in place of the three loops; none leaves them.
    pub tracking: Tracking,
    /// Whether there is `tracking`; 0 is no.
    pub has_tracking: u8,
    /// Detection of velocity saturation; none does not look for it.
    pub saturation: Saturation,
    /// Whether there is `saturation`; 0 is no.
    pub has_saturation: u8,
    /// The guard; none leaves the law bare, running from the first tick, for simulation and for fitting.
    pub guard: Guard,
    /// Whether there is `guard`; 0 is no.
    pub has_guard: u8,
}
