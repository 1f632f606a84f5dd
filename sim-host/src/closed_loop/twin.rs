//! A table as its model file describes it: Eq. 7 and the limiter, and beside them what a diagnosis added.

use super::{Clock, ClosedLoopError, ControlLaw, Trace, run};
use crate::plant::Plant;
use crate::plant::effects::{Countered, regional};
use crate::plant::model::Baseline;
use crate::plant::paper::{FixedStep, Paper};
use crate::plant::sensors::Sensors;
use crate::plant::simulate::{EffectParameters, SimulateError};
use crate::plant::stepped::Stepped;
use crate::recording::{self, Model, RecordingError};
use std::path::Path;

/// A table to run tests on.
#[derive(Debug, Clone, Default)]
pub struct Twin {
    /// Eq. 7 and the limiter.
    pub plant: Paper,
    /// What else the table has, in the order of the file.
    pub effects: Vec<EffectParameters<f64>>,
}

/// Why a model file is no table to run tests on.
#[derive(Debug, thiserror::Error)]
pub enum TwinError {
    /// The file cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// Tests run on servo tables.
    #[error("kind `{0}`: a closed-loop test needs kind `servo`")]
    Kind(&'static str),
    /// A parameter that an effect needs is not stated.
    #[error("effect `{effect}`: `{key}` is missing; state it, as `diagnose --model` does")]
    Missing {
        /// The effect.
        effect: String,
        /// Its parameter.
        key: &'static str,
    },
    /// The effects do not make a plant.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
}

impl From<Paper> for Twin {
    fn from(plant: Paper) -> Self {
        Self { plant, effects: Vec::new() }
    }
}

impl Twin {
    /// Reads a `table.toml`.
    pub fn load(path: &Path) -> Result<Self, TwinError> {
        Self::of(&Model::load(path)?)
    }

    /// The table that a model states.
    pub fn of(model: &Model) -> Result<Self, TwinError> {
        let recording::Baseline::Servo(_) = &model.baseline else { return Err(TwinError::Kind(model.baseline.kind())) };
        let mut plant = Paper { velocity_limit: f64::INFINITY, ..Paper::default() };
        for (name, value) in model.baseline.parameters() {
            match name {
                "b1" => plant.b1 = value,
                "b0" => plant.b0 = value,
                "a1" => plant.a1 = value,
                "velocity_limit" => plant.velocity_limit = value,
                _ => {}
            }
        }
        let effects = model.effects.iter().map(placed).collect::<Result<Vec<_>, _>>()?;
        let twin = Self { plant, effects };
        twin.moved(1e-3, 0.0)?;
        Ok(twin)
    }

    /// What a law counters of its effects.
    fn countered(&self) -> Countered {
        Countered::of(self.effects.iter().map(|placed| (placed.id, &placed.parameters[..])))
    }

    /// The largest speed it reaches both ways, m/s.
    pub fn velocity_limit(&self) -> f64 {
        // Stated for each direction they take the place of the model's one.
        self.countered().limits.map_or(self.plant.velocity_limit, |(up, down)| up.min(down))
    }

    /// The steady command that takes it to its largest speed, m: the valve fully open, as far as the model knows.
    pub fn full_opening(&self) -> f64 {
        self.velocity_limit() * self.plant.a1 / self.plant.b0
    }

    /// Load at which its flow stalls, as table acceleration, m/s2; none where no load slows it.
    pub fn stall(&self) -> Option<f64> {
        Some(self.countered().stall).filter(|&stall| stall > 0.0)
    }

    /// The table at rest at `start` (m), to be moved on in steps of `dt` (s) by whoever holds the clock.
    pub fn plant(&self, dt: f64, start: f64) -> Result<Box<dyn Plant>, ClosedLoopError> {
        Ok(if self.effects.is_empty() {
            Box::new(FixedStep::new(self.plant, dt, start)?)
        } else {
            Box::new(self.moved(dt, start)?)
        })
    }

    /// Runs a law along a reference (m), from rest at `start` (m).
    pub(super) fn run(
        &self,
        law: &mut impl ControlLaw,
        sensors: &mut Sensors,
        reference: &[f64],
        start: f64,
        clock: Clock,
    ) -> Result<Trace, ClosedLoopError> {
        if self.effects.is_empty() {
            let mut plant = FixedStep::new(self.plant, clock.plant_step(), start)?;
            return Ok(run(&mut plant, law, sensors, reference, clock));
        }
        let mut plant = self.moved(clock.plant_step(), start)?;
        Ok(run(&mut plant, law, sensors, reference, clock))
    }

    fn moved(&self, dt: f64, start: f64) -> Result<Stepped, SimulateError> {
        let Paper { b1, b0, a1, velocity_limit } = self.plant;
        Stepped::new(&Baseline::Servo { b1, b0, a1, velocity_limit }, &self.effects, dt, start)
    }
}

/// A stated effect with its parameters in the library's order; a run's own (phases) are zero, and so is what sums them up.
fn placed(stated: &recording::StatedEffect) -> Result<EffectParameters<f64>, TwinError> {
    use crate::plant::effects::{Role, SignalScale};
    let unknown = || SimulateError::UnknownEffect { id: stated.id.clone(), count: stated.parameters.len() };
    let entry = regional::stated(&stated.id, stated.parameters.keys().map(String::as_str)).ok_or_else(unknown)?;
    let value = |parameter: &crate::plant::effects::Parameter| match stated.parameters.get(parameter.key) {
        Some(&value) => Ok(value),
        None if matches!(parameter.role, Role::PerRun | Role::Size) => Ok(0.0),
        // A detail of a form that is not stated is its plainest.
        None if parameter.role == Role::Refined
            && (parameter.signal_scale == SignalScale::One || parameter.starts.first() == Some(&0.0)) =>
        {
            Ok(parameter.starts.first().copied().unwrap_or(0.0))
        }
        None => Err(TwinError::Missing { effect: stated.id.clone(), key: parameter.key }),
    };
    let parameters = entry.parameters.iter().map(value).collect::<Result<_, _>>()?;
    Ok(EffectParameters { id: entry.id, parameters })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_loop::published::Named;
    use crate::closed_loop::trial::{ScoredSignal, Setup};
    use crate::motion::condition::Recipe;
    use crate::motion::generate;

    fn twin(text: &str) -> Result<Twin, TwinError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.toml");
        std::fs::write(&path, text).unwrap();
        Twin::load(&path)
    }

    const SERVO: &str = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n";

    #[test]
    fn a_table_without_effects_is_the_exact_plant_and_an_effect_shows() {
        let plain = twin(SERVO).unwrap();
        assert_eq!(plain.plant, Paper::default());
        let lagging =
            twin(&format!("{SERVO}effects = [\"command_delay\"]\n[effects.command_delay]\ntime = 0.02\n")).unwrap();
        let motion = Recipe::table1(1000.0).apply(&generate::FAR_FIELD.generate(1).unwrap()).unwrap();
        let e_a = |table: Twin| {
            let setup = Setup { table, ..Setup::paper(Named::Strong) };
            setup.play(&motion).unwrap().scores(ScoredSignal::Truly, None).unwrap().against_wanted.e_a.ratio
        };
        let [exact, plain, lagging] = [Twin::default(), plain, lagging].map(e_a);
        assert_eq!(exact, plain);
        assert!(lagging > 1.05 * exact, "{lagging} {exact}");
    }

    /// `identify` states of a hum its frequency alone: phases and their size are each run's own.
    #[test]
    fn a_size_that_sums_up_runs_need_not_be_stated() {
        let hum = format!("{SERVO}effects = [\"mains_hum\"]\n[effects.mains_hum]\nfrequency = 50.0\n");
        assert_eq!(twin(&hum).unwrap().effects[0].parameters, [50.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn what_is_no_table_is_refused_by_name() {
        let missing = twin(&format!("{SERVO}effects = [\"leakage\"]\n")).unwrap_err();
        assert!(matches!(missing, TwinError::Missing { key: "coefficient", .. }), "{missing}");
        let negative = twin(&format!("{SERVO}effects = [\"command_delay\"]\n[effects.command_delay]\ntime = -0.02\n"));
        let message = negative.unwrap_err().to_string();
        assert!(message.contains("line 8, `effects.command_delay.time`: is -0.02; it cannot be negative"), "{message}");
        let rigid = twin("[model]\nkind = \"rigid-mass\"\nmass = 1.0\nviscous = 1.0\n").unwrap_err();
        assert!(matches!(rigid, TwinError::Kind("rigid-mass")), "{rigid}");
    }
}
