//! The library of effects: physics a table model may be missing.
//!
//! An effect is one file below and one line in the registry at the end of this file. The file holds what the effect
//! *is* (an [`Entry`]: identifier, equation, stage, parameters, signature) and what it *does* (an implementation of
//! [`Effect`]: hooks into the plant's signal path). Simulation, fitting, diagnosis, reports and the docs' table read
//! nothing else.
//!
//! The signal path, and the hook that each arrow is:
//!
//! ```text
//! command --command--> spool --valve--> flow --flow--> q --actuator--> v, p <--force-- table, payload
//!                                                                       |
//!                    displacement <--displacement-- x   v --velocity--> d/dt --acceleration--> accelerometer
//! ```

mod bent_spring;
mod bristle;
pub(crate) mod clock_rate;
mod countered;
mod family;
pub(crate) mod own;
pub(crate) mod parts;
pub(crate) mod regional;
pub(crate) mod remainder;
mod shaken;
mod stiff_oil;
mod tangent;

pub(crate) use coulomb_friction::PRESLIDING;
pub(crate) use countered::{Counter, Countered};
pub(crate) use family::Family;
pub(crate) use oil_compliance::Chambers;

use super::model::Kind;
use crate::scalar::Scalar;
use std::fmt::Debug;

/// Continuous states provided for: four of the plant, the rest of its effects.
pub(super) const STATES: usize = 16;

/// Where in the signal path an effect sits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// Between controller and valve.
    Command,
    /// The valve's spool.
    Valve,
    /// Flow through the valve and its supply.
    Flow,
    /// Oil column and piston.
    Actuator,
    /// The table, its bearings and its base.
    Table,
    /// The structure on the table.
    Payload,
    /// A sensor or its line.
    Sensor,
}

impl Stage {
    /// The name used in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Command => "command",
            Self::Valve => "valve",
            Self::Flow => "flow",
            Self::Actuator => "actuator",
            Self::Table => "table",
            Self::Payload => "payload",
            Self::Sensor => "sensor",
        }
    }
}

/// What a parameter's starting values are multiples of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SignalScale {
    /// Nothing: the values are absolute.
    One,
    /// RMS of the command, in its unit.
    Command,
    /// Largest rate of change of the command, unit of u per second.
    CommandRate,
    /// Largest speed the runs reach, m/s.
    Speed,
    /// Largest displacement from the start, m.
    Displacement,
    /// Force per table mass, m/s2: 1, or the mass in kilograms for a rigid mass, whose forces are in newtons.
    Force,
    /// One over the square of the largest displacement from the start, 1/m2.
    Curvature,
    /// The longest run, s.
    Duration,
    /// The strongest line in the spectrum of what the accelerometer shows beyond the model, Hz.
    Line,
}

/// One parameter of an effect.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Key in files and results.
    pub key: &'static str,
    /// Unit for a servo model.
    pub unit: &'static str,
    /// Unit for a rigid mass, where it differs.
    pub rigid_unit: &'static str,
    /// Meaning.
    pub meaning: &'static str,
    /// What `low`, `high` and `starts` are multiples of.
    pub signal_scale: SignalScale,
    /// Smallest value that makes sense.
    pub low: f64,
    /// Largest value that makes sense.
    pub high: f64,
    /// Values a fit starts from, the one nearest to none of the effect first.
    pub starts: &'static [f64],
    /// Positive and fitted by its logarithm.
    pub positive: bool,
    /// Ends of its range that mean something: a fit that wants to go beyond another strains the equation.
    pub simple: Ends,
    /// Whether all runs share it.
    pub role: Role,
}

impl Parameter {
    /// What the library starts from first: none of a detail of form.
    pub(crate) fn first_start(&self) -> f64 {
        self.starts.first().copied().unwrap_or(0.0)
    }
}

/// Ends of a parameter's range at which its effect is none or a simpler one: little of it, a rigid contact, a hard corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// The smallest value.
    Low,
    /// The largest value.
    High,
    /// Both.
    Both,
    /// None: either end is as much of it as makes sense.
    Neither,
}

impl Ends {
    /// True where a value at its lower, or else upper, end strains the equation.
    pub fn strained(self, at_low: bool) -> bool {
        match self {
            Self::Low => !at_low,
            Self::High => at_low,
            Self::Both => false,
            Self::Neither => true,
        }
    }
}

/// Whether all runs share a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// One value for all runs, fitted and reported.
    Shared,
    /// A value for each run, fitted beside the initial states and not reported.
    PerRun,
    /// One value for all runs, fitted once an effect was accepted: a detail of its form that would lead a search astray.
    Refined,
    /// Not fitted: a size that follows from the runs.
    Given,
    /// Not fitted: reported as the root mean square over the runs of the per-run parameters' common size.
    Size,
}

/// Order at which the simulated displacement converges as integration steps are halved under commands that are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// The rule's own: within a tick the equations are smooth, and memory of the command advances exactly.
    Fourth,
    /// A corner lies somewhere within a step: the edge of a cushion, a limit, a reversal that friction or lost motion remember, a
    /// jump of a delayed command. The step that holds it is wrong by its length squared, by as much as where in it the corner is:
    /// one halving says little, several on average say two. Nothing jumps in force or place there, so that no event is located.
    Second,
}

/// What an effect is: everything a reader, a fit or a table of the docs needs to know.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Identifier in files and results.
    pub id: &'static str,
    /// The equation, as printed.
    pub equation: &'static str,
    /// Where it sits.
    pub stage: Stage,
    /// What it is counted with.
    pub family: Family,
    /// Its parameters, in the order its constructor takes them.
    pub parameters: &'static [Parameter],
    /// Models it makes sense for.
    pub kinds: &'static [Kind],
    /// The model's own parameters that mean something else with this effect and are fitted beside it.
    pub frees: &'static [&'static str],
    /// What it looks like in recordings.
    pub signature: &'static str,
    /// Effects it is mistaken for.
    pub mistaken_for: &'static [&'static str],
    /// The test that tells them apart.
    pub test: &'static str,
    /// How fast the simulated answer converges as integration steps are halved.
    pub order: Order,
    /// Effects whose equation is a case of its own: both together stand for something else.
    pub contains: &'static [&'static str],
    /// How a law counters it: notes its parameters, in the order of the entry, where the tracking law's settings have a place
    /// for them; none where they have not.
    pub counter: Option<Counter>,
}

/// What the plant looks like at one instant, as effects see it.
#[derive(Debug, Clone, Copy)]
pub struct Instant<S> {
    /// Time from the start of the run, s.
    pub time: f64,
    /// Displacement of the table relative to its base, m.
    pub displacement: S,
    /// Velocity, m/s.
    pub velocity: S,
    /// The velocity that sensors earlier in the signal path pass on, m/s.
    pub sensed_velocity: S,
    /// The velocity limit the model states, m/s.
    pub velocity_limit: S,
}

impl<S: Copy> Instant<S> {
    /// Takes over another's motion, field by field: what is written in parts is slow to copy as a whole.
    #[inline]
    pub(super) fn become_of(&mut self, other: &Self) {
        (self.time, self.displacement) = (other.time, other.displacement);
        (self.velocity, self.sensed_velocity) = (other.velocity, other.sensed_velocity);
    }
}

/// Flow through the valve, as velocity of the piston, while effects shape it.
#[derive(Debug, Clone, Copy)]
pub struct Flow<S> {
    /// Factor on the flow gain, 1.
    pub gain: S,
    /// Factor on both velocity limits, 1.
    pub limit: S,
    /// Velocity limit for positive motion, m/s.
    pub positive: S,
    /// Velocity limit for negative motion, m/s.
    pub negative: S,
    /// Sharpness of the limit; none is a hard limit.
    pub sharpness: Option<S>,
}

/// How the actuator yields to load.
#[derive(Debug, Clone, Copy)]
pub struct Compliance<S> {
    /// Square of the oil column's natural frequency, 1/s2, and its damping term, 1/s; none is stiff oil.
    pub oil: Option<(S, S)>,
    /// How both change along the stroke; none where they do not.
    pub(crate) chambers: Option<Chambers<S>>,
    /// Velocity lost per load acceleration, s.
    pub leakage: Option<S>,
    /// Power of the load with which it leaks, where that is not the first.
    pub leakage_exponent: Option<S>,
    /// Load acceleration at which the flow stalls, m/s2.
    pub stall_acceleration: Option<S>,
    /// Seconds that pass in a stated second, 1; none for a clock that is right.
    pub pace: Option<S>,
}

impl<S: Scalar> Compliance<S> {
    /// Stiff oil that leaks nowhere, and a clock that is right.
    pub(super) const STIFF: Self =
        Self { oil: None, chambers: None, leakage: None, leakage_exponent: None, stall_acceleration: None, pace: None };

    /// Whether the actuator yields in proportion to load.
    pub(super) fn is_linear(&self) -> bool {
        self.stall_acceleration.is_none() && self.leakage_exponent.is_none() && self.chambers.is_none()
    }

    /// The most that the stroke makes of the oil's stiffness, 1.
    pub(super) fn stiffened(&self) -> f64 {
        self.chambers.as_ref().map_or(1.0, Chambers::stiffest)
    }

    /// Velocity that leaks per load, under this load (m/s2), s.
    pub(super) fn leaks_under(&self, load: S) -> S {
        let leakage = self.leakage.unwrap_or(S::from(0.0));
        self.leakage_exponent.map_or(leakage, |n| leakage * (load.abs() + LEAST_LOAD).pow(n - 1.0))
    }

    /// The same under the load that lets this velocity leak (m/s).
    pub(super) fn leaks_to(&self, velocity: S) -> S {
        let leakage = self.leakage.unwrap_or(S::from(0.0));
        self.leakage_exponent.map_or(leakage, |n| leakage * (velocity.abs() / leakage + LEAST_LOAD).pow((n - 1.0) / n))
    }
}

/// Load below which the power of a leakage is not asked, m/s2.
const LEAST_LOAD: f64 = 1e-6;

/// Which hooks an effect uses, so that a simulation calls no other.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Hooks {
    /// [`Effect::command`].
    pub command: bool,
    /// [`Effect::valve`].
    pub valve: bool,
    /// [`Effect::flow`].
    pub flow: bool,
    /// [`Effect::force`].
    pub force: bool,
    /// [`Effect::follow`].
    pub follow: bool,
    /// [`Effect::after`].
    pub after: bool,
    /// [`Effect::sense_displacement`].
    pub displacement: bool,
    /// [`Effect::sense_velocity`].
    pub velocity: bool,
    /// [`Effect::sense_acceleration`].
    pub acceleration: bool,
    /// [`Effect::observe`].
    pub observes: bool,
    /// What it does within an integration step is linear in motion, states and command, with coefficients that stay the
    /// same through a run.
    pub linear: bool,
}

impl Hooks {
    /// Every hook that one of the two uses; linear where both are.
    pub fn or(self, other: Self) -> Self {
        Self {
            command: self.command || other.command,
            valve: self.valve || other.valve,
            flow: self.flow || other.flow,
            force: self.force || other.force,
            follow: self.follow || other.follow,
            after: self.after || other.after,
            displacement: self.displacement || other.displacement,
            velocity: self.velocity || other.velocity,
            acceleration: self.acceleration || other.acceleration,
            observes: self.observes || other.observes,
            linear: self.linear && other.linear,
        }
    }
}

/// How the noise of the displacement sensor, passed on by the controller, shakes what it reaches; standard deviations.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Dither {
    /// Of the command, unit of u.
    pub command: f64,
    /// Of the velocity, m/s.
    pub velocity: f64,
}

/// What an effect does. Every hook has a neutral default; an effect overrides those it names in [`Effect::hooks`].
///
/// Continuous states are handed in as a slice of [`Effect::states`] values, their derivatives as another; both are
/// exactly that long.
pub trait Effect<S: Scalar>: Debug + Send {
    /// The hooks this effect uses.
    fn hooks(&self) -> Hooks;
    /// How many continuous states it adds.
    fn states(&self) -> usize {
        0
    }
    /// The fastest rate of its equations, 1/s.
    fn fastest(&self) -> f64 {
        0.0
    }
    /// Its states with the table at rest at this displacement (m).
    fn rest(&self, _displacement: S, _y: &mut [S]) {}
    /// Told once, before a run, how the loop's noise shakes it.
    fn dither(&mut self, _dither: Dither) {}
    /// Told once, where a run begins in the middle of a motion, a command that was sent a while before it (unit of u): until then always.
    fn under_way(&mut self, _command: S) {}
    /// The motion at the start of an integration step, and the controller's command (unit of u) through it.
    fn observe(&mut self, _at: &Instant<S>, _command: S) {}
    /// Leakage that it makes in this step, where that changes from step to step, s.
    fn leakage(&self) -> Option<S> {
        None
    }
    /// The command's mean over one integration step of `h` seconds (unit of u).
    fn command(&mut self, u: S, _h: f64) -> S {
        u
    }
    /// The spool's position for a command (unit of u).
    fn valve(&self, u: S, _y: &[S], _dy: &mut [S]) -> S {
        u
    }
    /// Shapes gain and limits of the flow.
    fn flow(&self, _at: &Instant<S>, _y: &[S], _flow: &mut Flow<S>) {}
    /// Says how the actuator yields; read once, before a run.
    fn yields(&self, _compliance: &mut Compliance<S>) {}
    /// Force that opposes positive motion, per table mass, m/s2.
    fn force(&self, _at: &Instant<S>, _y: &[S], _dy: &mut [S]) -> S {
        S::from(0.0)
    }
    /// Derivatives of states that only follow the motion.
    fn follow(&self, _at: &Instant<S>, _y: &[S], _dy: &mut [S]) {}
    /// Called after each integration step with the displacement reached, m, and when, s.
    fn after(&mut self, _displacement: S, _time: f64) {}
    /// What the displacement sensor shows, m.
    fn sense_displacement(&self, displacement: S, _y: &[S]) -> S {
        displacement
    }
    /// The velocity whose rate of change the accelerometer feels, m/s.
    fn sense_velocity(&self, velocity: S, _y: &[S]) -> S {
        velocity
    }
    /// What the accelerometer shows, m/s2.
    fn sense_acceleration(&self, acceleration: S, _at: &Instant<S>) -> S {
        acceleration
    }
    /// Supply pressure relative to its start, where the effect governs it.
    fn supply_pressure(&self, _y: &[S]) -> Option<S> {
        None
    }
}

/// The effect with this identifier: of the library, a curve that stands for what it does not hold, or a user's own.
pub fn entry(id: &str) -> Option<&'static Entry> {
    let beside = remainder::entries().chain([&clock_rate::ENTRY]);
    let library = ENTRIES.iter().copied().chain(beside).find(|entry| entry.id == id);
    library.or_else(|| own::found(id).map(|(_, entry)| entry))
}

/// An effect's parameters, the details of its form that are left out being what the library starts from.
pub(super) fn with_details<S: Scalar>(entry: &Entry, stated: &[S]) -> Vec<S> {
    let left_out = entry.parameters.iter().skip(stated.len()).take_while(|p| p.role == Role::Refined);
    let details = left_out.map(|p| S::from(p.first_start()));
    stated.iter().copied().chain(details).collect()
}

/// Every identifier, in signal-path order.
pub fn identifiers() -> Vec<&'static str> {
    ENTRIES.iter().map(|entry| entry.id).collect()
}

macro_rules! registry {
    ($($module:ident :: $kind:ident),+ $(,)?) => {
        $(pub(crate) mod $module;)+

        /// Every effect, in signal-path order.
        pub const ENTRIES: &[&Entry] = &[$(&$module::ENTRY),+];

        /// An effect with its parameters, in the order of its entry, of which details of its form may be left out; none where the
        /// identifier is unknown.
        pub fn build<S: Scalar>(id: &str, parameters: &[S]) -> Option<Box<dyn Effect<S>>> {
            if let Some(effect) = regional::placed(id, parameters).or_else(|| parts::placed(id, parameters)) {
                return Some(effect);
            }
            match id {
                $(id if id == $module::ENTRY.id => {
                    Some(Box::new($module::$kind::<S>::new(&with_details(&$module::ENTRY, parameters))?))
                })+
                _ => remainder::build(id, parameters)
                    .or_else(|| clock_rate::build(id, parameters))
                    .or_else(|| own::build(id, parameters)),
            }
        }
    };
}

registry! {
    null_bias::NullBias,
    command_delay::CommandDelay,
    valve_rate_limit::ValveRateLimit,
    valve_lag::ValveLag,
    valve_deadband::ValveDeadband,
    asymmetric_gain::AsymmetricGain,
    flow_softening::FlowSoftening,
    asymmetric_limit::AsymmetricLimit,
    supply_droop::SupplyDroop,
    gain_drift::GainDrift,
    load_dependent_flow::LoadDependentFlow,
    oil_compliance::OilCompliance,
    leakage::Leakage,
    viscous_friction::ViscousFriction,
    coulomb_friction::CoulombFriction,
    stribeck_friction::StribeckFriction,
    spring::Spring,
    end_stop::EndStop,
    payload_resonance::PayloadResonance,
    backlash::Backlash,
    base_compliance::BaseCompliance,
    displacement_lag::DisplacementLag,
    displacement_nonlinearity::DisplacementNonlinearity,
    acceleration_lag::AccelerationLag,
    tilt_coupling::TiltCoupling,
    acceleration_gain::AccelerationGain,
    acceleration_bias::AccelerationBias,
    mains_hum::MainsHum,
}
