//! What is set of the guard, as C sees it.

/// Largest force of the actuator and how it is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Force {
    /// Largest force, N.
    pub limit: f32,
    /// Area of the piston, m2.
    pub piston_area: f32,
}

/// Limits of the envelope. The stroke is the settings' own.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Envelope {
    /// Room kept free at each end of the stroke, m.
    pub margin: f32,
    /// From a trip to the table slowing down, s: the valve's lag and the safe ramp.
    pub stopping_latency: f32,
    /// Slowing down from then on, m/s2.
    pub stopping_deceleration: f32,
    /// Largest speed, m/s.
    pub velocity: f32,
    /// Largest acceleration, m/s2.
    pub acceleration: f32,
    /// Largest jerk, m/s3.
    pub jerk: f32,
    /// Largest force; none where no pressure is measured.
    pub force: Force,
    /// Whether there is `force`; 0 is no.
    pub has_force: u8,
    /// Largest distance between table and reference, m; not judged in guard mode.
    pub tracking: f32,
    /// How long acceleration, jerk, force and tracking may be beyond, s.
    pub persistence: f32,
}

/// When a sensor is not believed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Plausibility {
    /// How long a reading may be missing, s.
    pub lost: f32,
    /// How long a reading may stay the same to the last bit while the other sensor moves, s.
    pub stuck: f32,
    /// Largest mean magnitude of the observer's innovation, m.
    pub disagreement: f32,
    /// Largest offset that the accelerometer can have, m/s2.
    pub offset: f32,
    /// Largest mean change of acceleration from tick to tick that is noise and not motion, m/s2.
    pub acceleration_noise: f32,
}

/// Stated errors of LVDT and accelerometer, and the window over which they are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Witness {
    /// Below this the accelerometer is not believed, Hz.
    pub frequency: f32,
    /// Largest difference between the two sensors' scales, 1.
    pub scale: f32,
    /// Largest delay between the two sensors, s.
    pub delay: f32,
    /// Largest step of the accelerometer's zero during a test, m/s2.
    pub bias: f32,
    /// Standard deviation of the accelerometer's noise at each tick, m/s2.
    pub noise: f32,
}

/// When the valve is not believed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct ValveMonitor {
    /// Largest displacement that the command does not explain, m.
    pub mismatch: f32,
    /// Time over which it is forgotten, s.
    pub memory: f32,
}

/// Which of these inputs are fitted. None are where nothing is said.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Inputs {
    /// Largest difference between `second_displacement` and the LVDT, m; none without a second sensor.
    pub second_displacement: f32,
    /// Whether there is a `second_displacement`; 0 is no.
    pub has_second_displacement: u8,
    /// Whether `limit_switch` is read. 0 is no.
    pub limit_switches: u8,
    /// Longest time from a command of the relay to `relay_closed` following, s; none without read-back.
    pub relay_feedback: f32,
    /// Whether there is a `relay_feedback`; 0 is no.
    pub has_relay_feedback: u8,
}

/// How long things take.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Ramps {
    /// From a stand into the reference, and back, s.
    pub test: f32,
    /// From any command to the one at which no oil flows, at a trip, s.
    pub safe: f32,
}

/// Everything the guard needs to be told.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Guard {
    /// Where the table may be and how it may move.
    pub envelope: Envelope,
    /// When a sensor is not believed.
    pub plausibility: Plausibility,
    /// When LVDT and accelerometer contradict each other over a window.
    pub witness: Witness,
    /// When the valve is not believed.
    pub valve: ValveMonitor,
    /// Which inputs there are beside the sensors.
    pub inputs: Inputs,
    /// How the test starts, holds and ends.
    pub ramps: Ramps,
}
