//! The listed effects as the truth has them: each at a strength between nothing and more than any laboratory would bear.

mod forms;

use crate::plant::Physics;
use crate::rng::Stream;

/// An effect with an identifier that the diagnosis knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the variants are the identifiers of the file formats")]
pub enum Effect {
    NullBias,
    CommandDelay,
    ValveDeadband,
    ValveLag,
    ValveRateLimit,
    FlowSoftening,
    AsymmetricLimit,
    SupplyDroop,
    LoadDependentFlow,
    OilCompliance,
    Leakage,
    ViscousFriction,
    CoulombFriction,
    StribeckFriction,
    Backlash,
    EndStop,
    BaseCompliance,
    PayloadResonance,
    DisplacementLag,
    DisplacementNonlinearity,
    AccelerationLag,
    AccelerationGain,
    AccelerationBias,
    TiltCoupling,
    MainsHum,
    GainDrift,
}

use Effect as E;

/// What the strengths are measured by: sizes of an unflawed experiment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Largest command.
    pub command: f64,
    /// Largest change of the command per second.
    pub command_rate: f64,
    /// Largest displacement from the origin in the run held out (m).
    pub stroke: f64,
    /// Acceleration exceeded by one sample in a hundred (m/s2).
    pub acceleration: f64,
    /// Length of a run (s).
    pub duration: f64,
    /// Loop gain: crossover (rad/s).
    pub crossover: f64,
}

/// What is drawn once for a case and stays while its strength is sought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draw {
    /// Plus or minus one.
    pub sign: f64,
    /// Uniform in [0, 1).
    pub u: [f64; 4],
}

impl Draw {
    /// Draws.
    pub fn new(rng: &mut Stream) -> Self {
        Self { sign: rng.sign(), u: std::array::from_fn(|_| rng.unit()) }
    }

    /// The `i`th number between two bounds.
    pub fn between(&self, i: usize, low: f64, high: f64) -> f64 {
        low + self.u[i] * (high - low)
    }

    /// The same in the logarithm.
    pub fn log_between(&self, i: usize, low: f64, high: f64) -> f64 {
        self.between(i, low.ln(), high.ln()).exp()
    }
}

/// Parameters in the keys and units of the file formats.
pub type Parameters = Vec<(&'static str, f64)>;

impl Effect {
    /// All of them, in the order of the formats.
    pub const ALL: [Self; 26] = [
        E::NullBias,
        E::CommandDelay,
        E::ValveDeadband,
        E::ValveLag,
        E::ValveRateLimit,
        E::FlowSoftening,
        E::AsymmetricLimit,
        E::SupplyDroop,
        E::LoadDependentFlow,
        E::OilCompliance,
        E::Leakage,
        E::ViscousFriction,
        E::CoulombFriction,
        E::StribeckFriction,
        E::Backlash,
        E::EndStop,
        E::BaseCompliance,
        E::PayloadResonance,
        E::DisplacementLag,
        E::DisplacementNonlinearity,
        E::AccelerationLag,
        E::AccelerationGain,
        E::AccelerationBias,
        E::TiltCoupling,
        E::MainsHum,
        E::GainDrift,
    ];

    /// Its identifier.
    pub fn id(self) -> &'static str {
        match self {
            E::NullBias => "null_bias",
            E::CommandDelay => "command_delay",
            E::ValveDeadband => "valve_deadband",
            E::ValveLag => "valve_lag",
            E::ValveRateLimit => "valve_rate_limit",
            E::FlowSoftening => "flow_softening",
            E::AsymmetricLimit => "asymmetric_limit",
            E::SupplyDroop => "supply_droop",
            E::LoadDependentFlow => "load_dependent_flow",
            E::OilCompliance => "oil_compliance",
            E::Leakage => "leakage",
            E::ViscousFriction => "viscous_friction",
            E::CoulombFriction => "coulomb_friction",
            E::StribeckFriction => "stribeck_friction",
            E::Backlash => "backlash",
            E::EndStop => "end_stop",
            E::BaseCompliance => "base_compliance",
            E::PayloadResonance => "payload_resonance",
            E::DisplacementLag => "displacement_lag",
            E::DisplacementNonlinearity => "displacement_nonlinearity",
            E::AccelerationLag => "acceleration_lag",
            E::AccelerationGain => "acceleration_gain",
            E::AccelerationBias => "acceleration_bias",
            E::TiltCoupling => "tilt_coupling",
            E::MainsHum => "mains_hum",
            E::GainDrift => "gain_drift",
        }
    }

    /// Needs runs at the velocity limit to be seen.
    pub fn needs_saturation(self) -> bool {
        matches!(self, E::FlowSoftening | E::AsymmetricLimit | E::SupplyDroop)
    }

    /// Seen by the accelerometer only.
    pub fn needs_accelerometer(self) -> bool {
        matches!(
            self,
            E::Backlash
                | E::BaseCompliance
                | E::AccelerationLag
                | E::AccelerationGain
                | E::AccelerationBias
                | E::TiltCoupling
                | E::MainsHum
        )
    }

    /// Has a meaning for the rigid-mass model.
    pub fn suits_rigid(self) -> bool {
        !matches!(
            self,
            E::ValveRateLimit
                | E::FlowSoftening
                | E::AsymmetricLimit
                | E::SupplyDroop
                | E::LoadDependentFlow
                | E::OilCompliance
                | E::Leakage
                | E::BaseCompliance
                | E::GainDrift
        )
    }

    /// A force or an actuator that yields: two of these in one case would mean different things to different models.
    pub fn acts_at_actuator(self) -> bool {
        matches!(
            self,
            E::LoadDependentFlow
                | E::OilCompliance
                | E::Leakage
                | E::ViscousFriction
                | E::CoulombFriction
                | E::StribeckFriction
                | E::EndStop
                | E::PayloadResonance
                | E::Backlash
                | E::BaseCompliance
        )
    }

    /// Puts the effect into `physics` at `strength` in (0, 1]; gives its parameters as the library names them.
    pub fn apply(self, strength: f64, draw: &Draw, scales: &Scales, physics: &mut Physics) -> Parameters {
        match self {
            E::NullBias | E::CommandDelay | E::ValveDeadband | E::ValveLag | E::ValveRateLimit | E::GainDrift => {
                self.command_side(strength, draw, scales, physics)
            }
            E::FlowSoftening
            | E::AsymmetricLimit
            | E::SupplyDroop
            | E::LoadDependentFlow
            | E::OilCompliance
            | E::Leakage => self.hydraulic(strength, draw, scales, physics),
            E::ViscousFriction
            | E::CoulombFriction
            | E::StribeckFriction
            | E::Backlash
            | E::EndStop
            | E::BaseCompliance
            | E::PayloadResonance => self.mechanical(strength, draw, scales, physics),
            _ => self.sensor_side(strength, draw, scales, physics),
        }
    }
}
