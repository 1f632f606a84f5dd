//! The table as a design takes it: an identified model in the core's own terms.

use super::corner::Corner;
use crate::plant::effects::{Countered, Effect, Entry, Parameter, Role, SignalScale, regional};
use crate::plant::effects::{
    asymmetric_limit, command_delay, coulomb_friction, flow_softening, load_dependent_flow, null_bias, oil_compliance,
    stribeck_friction, supply_droop, valve_deadband, viscous_friction,
};
use crate::plant::model::Baseline;
use crate::plant::simulate::{EffectParameters, SimulateError};
use crate::plant::stepped::Stepped;
use crate::recording::model::{self, Model, StatedEffect};
use shakedown_core::Settings;
use shakedown_core::settings::{FlowSettings, FrictionSettings, Gains, OilSettings, TrackingSettings, ValveSettings};

/// A servo table: Eq. 7 with what diagnosis has named beside it. SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Table {
    /// Direct term, 1/s.
    pub b1: f64,
    /// Gain, 1/s2.
    pub b0: f64,
    /// Pole, 1/s.
    pub a1: f64,
    /// Largest speed toward positive displacement, m/s.
    pub velocity_limit: f64,
    /// Largest speed the other way over that one, 1.
    pub asymmetry: f64,
    /// Null bias, m.
    pub null_bias: f64,
    /// Delay of the command, s.
    pub delay: f64,
    /// Frequency (Hz) and damping (1) of the oil column; none where it is stiff.
    pub oil: Option<(f64, f64)>,
    /// Sharpness of a soft limit, 1; 0 for a hard one.
    pub sharpness: f64,
    /// Acceleration at which the flow stalls, m/s2; 0 where no load slows it.
    pub stall: f64,
    /// Depth (1) and recovery (s) of the supply's droop.
    pub droop: (f64, f64),
    /// Coulomb (m/s2) and viscous (1/s) friction per table mass.
    pub friction: (f64, f64),
    /// Friction at standstill per table mass (m/s2) and the speed over which it falls to sliding friction (m/s); none where
    /// it does not rise. The law counters sliding friction alone; the plant has it all.
    pub peak: Option<(f64, f64)>,
    /// Half width of the spool's overlap, m.
    pub deadband: f64,
}

impl Default for Table {
    /// The paper's.
    fn default() -> Self {
        Self {
            b1: 0.69,
            b0: 138.0,
            a1: 57.65,
            velocity_limit: 0.242,
            asymmetry: 1.0,
            null_bias: 0.0,
            delay: 0.0,
            oil: None,
            sharpness: 0.0,
            stall: 0.0,
            droop: (0.0, 1.0),
            friction: (0.0, 0.0),
            peak: None,
            deadband: 0.0,
        }
    }
}

/// Why a model cannot be designed for.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TableError {
    /// The law is for servo tables.
    #[error("kind `{0}`: the tracking law needs kind `servo`")]
    Kind(&'static str),
    /// No speed limit is stated.
    #[error("`velocity_limit` is missing: state it in m/s")]
    NoLimit,
    /// A parameter that an effect needs is not stated.
    #[error("effect `{effect}`: `{key}` is missing; state it, as `diagnose --model` does")]
    Missing {
        /// The effect.
        effect: &'static str,
        /// Its parameter.
        key: &'static str,
    },
    /// The plant could not be built.
    #[error(transparent)]
    Plant(#[from] SimulateError),
}

impl Table {
    /// Reads what the law can use out of an identified model. Effects and details of their forms that it cannot use are given back by
    /// name: an effect that acts in a region among them, which the law would counter where it is not.
    pub fn from_model(model: &Model) -> Result<(Self, Vec<String>), TableError> {
        let model::Baseline::Servo(servo) = &model.baseline else {
            return Err(TableError::Kind(model.baseline.kind()));
        };
        let limit = servo.velocity_limit.ok_or(TableError::NoLimit)?;
        let mut placed = Vec::new();
        let mut unused = Vec::new();
        for effect in &model.effects {
            let keys = effect.parameters.keys().map(String::as_str);
            match regional::stated(&effect.id, keys).filter(|entry| entry.counter.is_some()) {
                Some(entry) => {
                    let known = stated(effect, entry)?;
                    unused.extend(passed_over(&known, entry));
                    placed.push(known);
                }
                None => unused.push(effect.id.clone()),
            }
        }
        let found = Countered::of(placed.iter().map(|placed| (placed.id, &placed.parameters[..])));
        let (positive, negative) = found.limits.unwrap_or((limit, limit));
        let table = Self {
            b1: servo.b1,
            b0: servo.b0,
            a1: servo.a1,
            velocity_limit: positive,
            asymmetry: negative / positive,
            null_bias: found.null_bias,
            delay: found.delay,
            oil: found.oil,
            sharpness: found.sharpness,
            stall: found.stall,
            droop: found.droop,
            friction: (found.coulomb, found.viscous),
            peak: found.peak,
            deadband: found.deadband,
        };
        Ok((table, unused))
    }

    /// The largest speed it reaches both ways, m/s.
    pub fn slower_limit(&self) -> f64 {
        self.velocity_limit * self.asymmetry.min(1.0)
    }

    /// The core's settings with the tracking law, its two frequencies at their defaults.
    pub fn settings(&self, rate: f64) -> Settings {
        let flow = FlowSettings {
            asymmetry: self.asymmetry as f32,
            sharpness: self.sharpness as f32,
            stall: self.stall as f32,
            droop: self.droop.0 as f32,
            recovery: self.droop.1 as f32,
            ..FlowSettings::default()
        };
        let friction = FrictionSettings {
            coulomb: self.friction.0 as f32,
            viscous: self.friction.1 as f32,
            deadband: self.deadband as f32,
            ..FrictionSettings::default()
        };
        let oil =
            self.oil.map(|(frequency, damping)| OilSettings { frequency: frequency as f32, damping: damping as f32 });
        // Points of the reference no closer than its own samples need: 2 ms, or two ticks.
        let spacing = (2e-3_f64).max(2.0 / rate) as f32;
        let (lead, delay) = ((self.b1 / self.b0).max(0.0) as f32, self.delay as f32);
        let tracking = TrackingSettings { lead, delay, spacing, flow, friction, oil, ..TrackingSettings::default() };
        let valve = ValveSettings {
            gain: (self.b0 / self.a1) as f32,
            lag: (1.0 / self.a1) as f32,
            // What cancels it.
            null_bias: (0.0 - self.null_bias) as f32,
            ..ValveSettings::default()
        };
        Settings {
            rate: rate as f32,
            displacement: Gains::new(0.0, 0.0),
            velocity_limit: self.velocity_limit as f32,
            valve,
            tracking: Some(tracking),
            ..Settings::default()
        }
    }

    /// The table at a corner, everything it has at work.
    pub fn plant(&self, corner: &Corner, dt: f64) -> Result<Stepped, TableError> {
        self.plant_with(corner, Vec::new(), Vec::new(), dt)
    }

    /// The same with more effects than the table knows of, `others` being outside the library.
    pub fn plant_with(
        &self,
        corner: &Corner,
        more: Vec<EffectParameters<f64>>,
        others: Vec<Box<dyn Effect<f64>>>,
        dt: f64,
    ) -> Result<Stepped, TableError> {
        let mut effects = self.linear_effects(corner);
        let mut place = |here: bool, entry: &Entry, parameters: &[f64]| {
            // What a table does not state of friction's or an orifice's form is what the library starts from.
            let form = entry.parameters.iter().skip(parameters.len()).map(Parameter::first_start);
            let parameters = parameters.iter().copied().chain(form).collect();
            effects.extend(here.then_some(EffectParameters { id: entry.id, parameters }));
        };
        let root = corner.supply.sqrt();
        let (positive, (depth, recovery)) = (self.velocity_limit * root, self.droop);
        let (sliding, viscous) = self.friction;
        place(self.null_bias != 0.0, &null_bias::ENTRY, &[self.null_bias]);
        place(self.deadband > 0.0, &valve_deadband::ENTRY, &[self.deadband]);
        place(self.sharpness > 0.0, &flow_softening::ENTRY, &[self.sharpness]);
        place(self.asymmetry != 1.0, &asymmetric_limit::ENTRY, &[positive, positive * self.asymmetry]);
        place(depth > 0.0, &supply_droop::ENTRY, &[depth, recovery]);
        place(self.stall > 0.0, &load_dependent_flow::ENTRY, &[self.stall]);
        match self.peak {
            None => place(sliding > 0.0, &coulomb_friction::ENTRY, &[sliding]),
            Some((standstill, speed)) => place(true, &stribeck_friction::ENTRY, &[sliding, standstill, speed]),
        }
        place(viscous > 0.0, &viscous_friction::ENTRY, &[viscous]);
        effects.extend(more);
        Ok(Stepped::with(&self.baseline(corner, positive), &effects, others, dt, 0.0)?)
    }

    /// The table at a corner near rest: no limits, no friction, no overlap.
    pub fn linear(&self, corner: &Corner, dt: f64) -> Result<Stepped, TableError> {
        Ok(Stepped::new(&self.baseline(corner, 1e6), &self.linear_effects(corner), dt, 0.0)?)
    }

    fn baseline(&self, corner: &Corner, velocity_limit: f64) -> Baseline<f64> {
        let gain = corner.gain * corner.supply.sqrt();
        Baseline::Servo { b1: self.b1 * gain, b0: self.b0 * gain, a1: self.a1 * corner.pole, velocity_limit }
    }

    fn linear_effects(&self, corner: &Corner) -> Vec<EffectParameters<f64>> {
        let mut effects = Vec::new();
        if self.delay > 0.0 {
            effects.push(EffectParameters { id: command_delay::ENTRY.id, parameters: vec![self.delay] });
        }
        if let Some((frequency, damping)) = self.oil {
            // The leakage fixes twice damping times frequency, whatever the mass.
            let root = corner.mass.sqrt();
            let parameters = vec![frequency / root, damping * root, 0.0, 0.0];
            effects.push(EffectParameters { id: oil_compliance::ENTRY.id, parameters });
        }
        effects
    }
}

/// A stated effect with its parameters in the order of its entry, details of its form that are not stated being what the
/// library starts from.
fn stated(effect: &StatedEffect, entry: &'static Entry) -> Result<EffectParameters<f64>, TableError> {
    let value = |parameter: &Parameter| match (effect.parameters.get(parameter.key), parameter.signal_scale) {
        (Some(&value), _) => Ok(value),
        (None, SignalScale::One) if parameter.low > 0.0 || parameter.role != Role::Shared => {
            Ok(parameter.first_start())
        }
        (None, _) if parameter.role == Role::Refined && parameter.first_start() == 0.0 => Ok(0.0),
        (None, _) => Err(TableError::Missing { effect: entry.id, key: parameter.key }),
    };
    Ok(EffectParameters { id: entry.id, parameters: entry.parameters.iter().map(value).collect::<Result<_, _>>()? })
}

/// Details of a form that the law counters nothing of, though they are not what the library starts from.
fn passed_over(placed: &EffectParameters<f64>, entry: &'static Entry) -> Vec<String> {
    let countered = |parameters: &[f64]| Countered::of([(entry.id, parameters)]);
    let details = (0..).zip(entry.parameters).filter(|(_, parameter)| parameter.role == Role::Refined);
    let passed_over = details.filter(|&(i, parameter)| {
        let mut simple = placed.parameters.clone();
        let given = std::mem::replace(&mut simple[i], parameter.first_start());
        given != parameter.first_start() && countered(&simple) == countered(&placed.parameters)
    });
    passed_over.map(|(_, parameter)| format!("{}.{}", entry.id, parameter.key)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::Plant;

    #[test]
    fn a_model_is_read_and_what_the_law_cannot_use_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.toml");
        let text = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n\
                    effects = [\"oil_compliance\", \"mains_hum\"]\n[effects.oil_compliance]\nfrequency = 11.0\n\
                    damping = 0.07\n";
        std::fs::write(&path, text).unwrap();
        let (table, unused) = Table::from_model(&Model::load(&path).unwrap()).unwrap();
        assert_eq!(table, Table { oil: Some((11.0, 0.07)), ..Table::default() });
        assert_eq!(unused, ["mains_hum"]);
        std::fs::write(&path, format!("{text}stroke_curvature = 4.0\n")).unwrap();
        let (same, unused) = Table::from_model(&Model::load(&path).unwrap()).unwrap();
        assert_eq!((same, unused), (table, vec!["oil_compliance.stroke_curvature".into(), "mains_hum".into()]));
        assert_eq!(table.settings(1000.0).validate(), Ok(()));
    }

    /// A law that countered it everywhere would push the table where nothing holds it.
    #[test]
    fn what_acts_in_a_region_is_not_countered_everywhere() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.toml");
        let text = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n\
                    effects = [\"coulomb_friction\"]\n[effects.coulomb_friction]\nforce = 0.2\n\
                    from_velocity = 0.02\nto_velocity = 9.0\nscale = 1e-4\nregion = 2\n";
        std::fs::write(&path, text).unwrap();
        let (table, unused) = Table::from_model(&Model::load(&path).unwrap()).unwrap();
        assert_eq!((table, unused), (Table::default(), vec!["coulomb_friction".to_owned()]));
        let region = [0.2, 1e-5, 2.0, 1e-4, 0.02, 9.0];
        assert_eq!(Countered::of([("coulomb_friction", &region[..])]), Countered::default());
        assert_eq!(Countered::of([("coulomb_friction", &region[..2])]).coulomb, 0.2);
    }

    #[test]
    fn a_table_with_every_loss_makes_a_plant() {
        let table = Table {
            friction: (0.2, 1.0),
            deadband: 1e-3,
            stall: 20.0,
            droop: (0.05, 1.0),
            sharpness: 8.0,
            ..Table::default()
        };
        table.plant(&Corner::default(), 5e-4).unwrap();
    }

    /// What a diagnosis found of friction's peak and of the slower direction is in the plant, and the law keeps to both.
    #[test]
    fn nothing_that_is_stated_of_friction_and_limits_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.toml");
        let text = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n\
                    effects = [\"asymmetric_limit\", \"stribeck_friction\"]\n[effects.asymmetric_limit]\n\
                    positive = 0.24\nnegative = 0.18\n[effects.stribeck_friction]\nforce = 0.1\nstatic = 0.3\n\
                    velocity = 0.02\n";
        std::fs::write(&path, text).unwrap();
        let (table, unused) = Table::from_model(&Model::load(&path).unwrap()).unwrap();
        assert!(unused.is_empty());
        assert_eq!((table.friction.0, table.peak), (0.1, Some((0.3, 0.02))));
        assert_eq!((table.velocity_limit, table.slower_limit()), (0.24, 0.18));
        let mut plant = table.plant(&Corner::default(), 5e-4).unwrap();
        plant.advance(-0.5, 2000);
        assert!((plant.velocity(-0.5) + 0.18).abs() < 1e-3, "{}", plant.velocity(-0.5));
        let sliding = Table { peak: None, ..table };
        let [full, sliding] = [table, sliding].map(|table| {
            let mut plant = table.plant(&Corner::default(), 5e-4).unwrap();
            plant.advance(0.003, 400);
            plant.displacement()
        });
        assert!(full < 0.9 * sliding, "the peak holds the table: {full} {sliding}");
        let bare = text.replace("force = 0.1\n", "");
        std::fs::write(&path, bare).unwrap();
        let missing = Table::from_model(&Model::load(&path).unwrap()).unwrap_err();
        assert_eq!(missing, TableError::Missing { effect: "stribeck_friction", key: "force" });
    }
}
