//! What is set of the tracking law, as C sees it.

/// Noise of the sensors at each tick, standard deviations: what weighs them against each other.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Noise {
    /// LVDT, m; a step's is the step over the root of 12.
    pub displacement: f32,
    /// Accelerometer, m/s2; without one, the accelerations to expect.
    pub acceleration: f32,
}

/// What is known of the flow beyond gain and limit. Zeros switch off.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Flow {
    /// Velocity limit toward negative displacement over the one toward positive, 1.
    pub asymmetry: f32,
    /// Sharpness n of a soft limit, 1; 0 for a hard one.
    pub sharpness: f32,
    /// Force per table mass at which the flow stalls, m/s2; 0 for a flow that no load slows.
    pub stall: f32,
    /// Relative supply pressure lost under sustained motion at the velocity limit, 1.
    pub droop: f32,
    /// Time constant with which the supply recovers, s.
    pub recovery: f32,
    /// How far beyond the limit the valve may be opened, as a multiple of it, 1.
    pub overdrive: f32,
}

/// What is known of friction and overlap. Zeros switch off.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Friction {
    /// Coulomb friction per table mass, m/s2.
    pub coulomb: f32,
    /// Viscous friction per table mass, 1/s.
    pub viscous: f32,
    /// Velocity at which the Coulomb friction is whole, m/s.
    pub velocity: f32,
    /// Command on either side of zero that opens nothing, m.
    pub deadband: f32,
}

/// The table's mode on its oil column.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Oil {
    /// Natural frequency, Hz.
    pub frequency: f32,
    /// Damping ratio, 1.
    pub damping: f32,
}

/// What is known of the sensor and wanted of the damping.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Pressure {
    /// Piston area over moving mass, m2/kg.
    pub area_per_mass: f32,
    /// Velocity taken off per acceleration of the load, s.
    pub gain: f32,
    /// Corner below which a load is left alone, Hz.
    pub corner: f32,
}

/// A notch in the feedback, for a mode that it must leave alone.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Notch {
    /// Hz.
    pub frequency: f32,
    /// Half its width over its frequency, 1.
    pub damping: f32,
}

/// Everything that is set of the tracking law beside the valve's gain, lag and null.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Tracking {
    /// Bandwidth of the feedback, Hz.
    pub bandwidth: f32,
    /// Below this what the model lacks is corrected, Hz.
    pub disturbance: f32,
    /// From command to flow beyond the valve's lag, s.
    pub delay: f32,
    /// Lead of the valve, s: b1 / b0 of Eq. 7.
    pub lead: f32,
    /// Between the points of the reference that its rates are taken from, s.
    pub spacing: f32,
    /// Noise of the sensors.
    pub noise: Noise,
    /// Flow map.
    pub flow: Flow,
    /// Friction and overlap.
    pub friction: Friction,
    /// Mode of the oil column; none where it is too stiff to matter.
    pub oil: Oil,
    /// Whether there is `oil`; 0 is no.
    pub has_oil: u8,
    /// Damping by the pressure difference; none without a sensor.
    pub pressure: Pressure,
    /// Whether there is `pressure`; 0 is no.
    pub has_pressure: u8,
    /// Notch in the feedback.
    pub notch: Notch,
    /// Whether there is `notch`; 0 is no.
    pub has_notch: u8,
}
