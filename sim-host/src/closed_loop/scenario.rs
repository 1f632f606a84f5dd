//! A closed-loop test as a file: `shakedown run SCENARIO.toml`.
//!
//! ```toml
//! name = "Kobe at the strong gains"
//! controller = "strong"           # a name of Table 1, or "tracking"; or settings = "core.toml", the control core's own settings
//! conditioning = "specimen"       # or "table1", "plain", "fitting", or a list of steps: [{ do = "scale", factor = 0.5 }]
//! scale_to = "0.74g"              # peak acceleration, after conditioning; or scale = 0.5, a factor
//! fit = "convex"                  # beforehand: "clip", "taut", "convex", "spectrum", "causal" or "preview", or Fig. 13:
//!                                 # "peak-kept", "peak-scaled", "record-scaled" or "time-compressed"; or "nearest", which leaves the loop room
//! modification = "causal"         # online, in the core: "off", "clip" (Eq. 10), "causal" or { preview = { seconds = 0.5 } }
//! rate_hz = 1000.0                # control rate
//! steps = 10                      # plant steps in a tick
//!
//! [record]                        # left out: a generated near-field motion
//! file = "kobe.AT2"               # relative to the scenario
//! # dt = 0.01   unit = "g"   channel = "1"
//!
//! [plant]                         # Eq. 7 and the limiter; or, above [record], table = "table.toml", with what a diagnosis found
//! velocity_limit = 0.242
//!
//! [sensors]                       # left out: the paper's laboratory
//! displacement_step = 4e-5
//! # velocity_noise = 1e-3         # a velocity transducer, m/s; without it LVDT and accelerometer tell the velocity
//! # area_per_mass = 4.8e-6        # a sensor of the pressure difference: piston area over moving mass, m2/kg
//! seed = 1
//! ```

mod error;

pub use error::ScenarioError;

use super::named;
use super::trial::Setup;
use super::twin::Twin;
use crate::files::{bounded, wording};
use crate::motion::condition::Recipe;
use crate::motion::fit::named::RecordFit;
use crate::plant::paper::Paper;
use crate::plant::sensors::SensorModel;
use serde::Deserialize;
use shakedown_core::{Modification, Settings};
use std::path::{Path, PathBuf};

/// A closed-loop test.
#[derive(Debug, Clone, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scenario {
    /// What the test is called.
    pub name: String,
    /// A controller of Table 1.
    pub controller: Option<String>,
    /// A file of the control core's settings, relative to the scenario; excludes `controller`.
    pub settings: Option<PathBuf>,
    /// What the record is made into.
    pub conditioning: Conditioning,
    /// Peak acceleration with its unit, after conditioning.
    pub scale_to: Option<String>,
    /// Factor on the motion, after conditioning and before `scale_to`.
    pub scale: Option<f64>,
    /// How the motion is brought within the table's limits beforehand.
    pub fit: Option<RecordFit>,
    /// How the core modifies the reference; without it, as the controller says.
    pub modification: Option<Modification>,
    /// Control rate, Hz; without it 1 kHz, or the settings' rate.
    pub rate_hz: Option<f64>,
    /// Plant steps in a tick.
    pub steps: usize,
    /// The record.
    pub record: RecordSource,
    /// The plant.
    pub plant: Paper,
    /// A model file instead of `plant`, as `identify` and `diagnose --model` write them, relative to the scenario.
    pub table: Option<PathBuf>,
    /// The sensors.
    pub sensors: SensorModel,
    /// Where it was read, with its text for line numbers; none for one made by options.
    #[serde(skip)]
    pub source: Option<(PathBuf, String)>,
}

impl Default for Scenario {
    fn default() -> Self {
        Self {
            name: String::new(),
            controller: None,
            settings: None,
            conditioning: Conditioning::default(),
            scale_to: None,
            scale: None,
            fit: None,
            modification: None,
            rate_hz: None,
            steps: 10,
            record: RecordSource::default(),
            plant: Paper::default(),
            table: None,
            sensors: SensorModel::laboratory(1),
            source: None,
        }
    }
}

/// Where the ground motion comes from.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RecordSource {
    /// The file; none generates a near-field motion.
    pub file: Option<PathBuf>,
    /// Sampling interval, s, where the file does not say it.
    pub dt: Option<f64>,
    /// Unit of the acceleration, where the file does not say it.
    pub unit: Option<String>,
    /// Component, where the file has several.
    pub channel: Option<String>,
    /// Seed of the generated motion.
    pub seed: Option<u64>,
}

/// How a record is made into a motion.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(
    untagged,
    expecting = "expected specimen, table1, plain or fitting, or a list of steps, each with `do` and what it takes (baseline, filter, resample, scale, ...)"
)]
pub enum Conditioning {
    /// By a named recipe.
    Named(NamedRecipe),
    /// By steps.
    Steps(Recipe),
    /// Not stated: [`Recipe::specimen`].
    #[default]
    #[serde(skip)]
    Unstated,
}

/// Recipes with names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NamedRecipe {
    /// [`Recipe::specimen`], as `modify` does.
    Specimen,
    /// [`Recipe::table1`].
    Table1,
    /// [`Recipe::table1`] without its low-pass: all that the record holds.
    Plain,
    /// [`Recipe::fitting`]: as fits are measured.
    Fitting,
}

/// Reads a TOML file into what is asked for; a key that nobody knows is refused with its line.
fn read_toml<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, ScenarioError> {
    parse_toml(path, &text_of(path)?)
}

fn text_of(path: &Path) -> Result<String, ScenarioError> {
    bounded::text(path, bounded::BY_HAND)
        .map_err(|e| ScenarioError::of(path, String::new(), format!("{e}: expected a readable TOML file")))
}

fn parse_toml<T: serde::de::DeserializeOwned>(path: &Path, text: &str) -> Result<T, ScenarioError> {
    toml::from_str(text).map_err(|e| {
        let line = e.span().map(|span| text[..span.start.min(text.len())].matches('\n').count() + 1);
        ScenarioError::of(
            path,
            line.map_or(String::new(), |line| format!(", line {line}")),
            wording::plain(e.message()),
        )
    })
}

impl Scenario {
    /// Reads a scenario; its paths become relative to the working folder.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let text = text_of(path)?;
        Self::from_text(path, &text)
    }

    /// The same from text at hand; `path` is what messages call it and what its own paths are relative to.
    pub fn from_text(path: &Path, text: &str) -> Result<Self, ScenarioError> {
        let mut scenario: Self = parse_toml(path, text)?;
        scenario.source = Some((path.to_path_buf(), text.to_owned()));
        scenario.placed(path)
    }

    /// The line of a key of a section (the top one is empty), as `, line 4`; nothing where it is not stated.
    pub fn line(&self, section: &str, key: &str) -> String {
        let Some((_, text)) = &self.source else { return String::new() };
        let mut within = section.is_empty();
        for (number, line) in text.lines().enumerate().map(|(i, line)| (i + 1, line.trim())) {
            if line.starts_with('[') {
                let name = line.trim_matches(['[', ']']);
                within = name == section || !section.is_empty() && name.starts_with(&format!("{section}."));
            } else if within && line.split('=').next().is_some_and(|k| k.trim() == key) {
                return format!(", line {number}");
            }
        }
        String::new()
    }

    /// With what follows from where it was read.
    fn placed(mut self, path: &Path) -> Result<Self, ScenarioError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        for file in [&mut self.record.file, &mut self.settings, &mut self.table].into_iter().flatten() {
            *file = folder.join(&*file);
        }
        if self.controller.is_some() && self.settings.is_some() {
            let problem = "controller and settings exclude each other: leave one out";
            return Err(ScenarioError::of(path, String::new(), problem.into()));
        }
        if self.name.is_empty() {
            self.name = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        }
        Ok(self)
    }

    /// The loop that the scenario describes, checked.
    pub fn setup(&self) -> Result<Setup, ScenarioError> {
        let here = self.source.as_ref().map_or(Path::new(&self.name), |(path, _)| path.as_path());
        let refuse = |place: &str, problem: String| {
            // `displacement_step = inf: ...` begins with the key that is wrong.
            let key = problem.split([' ', ':']).next().unwrap_or_default();
            let line = [self.line(place, key), self.line("", place)].into_iter().find(|line| !line.is_empty());
            Err(ScenarioError::of(here, format!("{}, {place}", line.unwrap_or_default()), problem))
        };
        let mut settings = match (&self.settings, &self.controller) {
            (Some(path), _) => read_toml::<Settings>(path)?,
            (None, name) => {
                let name = name.as_deref().unwrap_or("current");
                let Some(settings) = named::by_name(name, self.rate_hz.unwrap_or(named::RATE)) else {
                    let known = named::names().join(" ");
                    return refuse("controller", format!("`{name}`: expected one of {known}"));
                };
                settings
            }
        };
        if let Some(rate) = self.rate_hz {
            settings.rate = rate as f32;
        }
        settings.modification = self.modification.unwrap_or(settings.modification);
        if let Err(e) = settings.validate() {
            let stated = self.rate_hz.is_some() && e.to_string().starts_with("rate ");
            return refuse(if stated { "rate_hz" } else { "settings" }, e.to_string());
        }
        if let Err(e) = self.plant.validate() {
            return refuse("plant", e.to_string());
        }
        if let Err(e) = self.sensors.validate() {
            return refuse("sensors", e.to_string());
        }
        for (key, value, most) in [
            ("displacement_step", self.sensors.displacement_step, 0.1),
            ("acceleration_noise", self.sensors.acceleration_noise, 1000.0),
            ("velocity_noise", self.sensors.velocity_noise.unwrap_or(0.0), 1000.0),
        ] {
            if value > most {
                return refuse("sensors", format!("{key} = {value:e}: expected at most {most}, in SI units"));
            }
        }
        if let Err(e) = super::Clock::new(f64::from(settings.rate), self.steps) {
            return refuse("steps", e.to_string());
        }
        let table = match self.table.as_ref().map(|path| Twin::load(path)) {
            None => Twin::from(self.plant),
            Some(Ok(table)) => table,
            Some(Err(e)) => {
                let (place, text) =
                    (self.table.as_ref().map_or(String::new(), |path| path.display().to_string()), e.to_string());
                // A table that the command line names has no place in a scenario.
                if self.line("", "table").is_empty() {
                    return Err(ScenarioError::within(place, &text));
                }
                return refuse("table", if text.contains(&place) { text } else { format!("{place}: {text}") });
            }
        };
        Ok(Setup { settings, table, sensors: self.sensors.clone(), steps: self.steps })
    }

    /// The recipe at `rate` (Hz) for a record sampled every `dt` s.
    pub fn recipe(&self, rate: f64, dt: f64) -> Recipe {
        use crate::motion::condition::Step;
        match &self.conditioning {
            Conditioning::Steps(recipe) => recipe.clone(),
            Conditioning::Named(NamedRecipe::Plain) => {
                let mut recipe = Recipe::table1(rate);
                recipe.steps.retain(|step| !matches!(step, Step::Filter { .. }));
                recipe
            }
            Conditioning::Named(NamedRecipe::Fitting) => Recipe::fitting(None),
            Conditioning::Named(NamedRecipe::Table1) => Recipe::table1(rate),
            Conditioning::Named(NamedRecipe::Specimen) | Conditioning::Unstated => Recipe::specimen(dt),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Scenario, ScenarioError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("test.toml");
        std::fs::write(&path, text).unwrap();
        Scenario::read(&path)
    }

    #[test]
    fn a_whole_scenario_is_read() {
        let text = "controller = \"strong\"\nconditioning = \"plain\"\nfit = \"peak-kept\"\nmodification = \"causal\"\n\
                    [record]\nfile = \"a.AT2\"\n[plant]\nvelocity_limit = 0.3\n[sensors]\nseed = 5\n";
        let scenario = read(text).unwrap();
        assert_eq!(scenario.name, "test");
        assert!(scenario.record.file.as_ref().unwrap().is_absolute());
        assert_eq!(scenario.plant.velocity_limit, 0.3);
        let setup = scenario.setup().unwrap();
        assert_eq!(setup.settings.displacement.proportional, 10.0);
        assert_eq!(setup.settings.modification, Modification::Causal);
        assert_eq!(scenario.recipe(1000.0, 0.01).steps.len(), Recipe::table1(1000.0).steps.len() - 1);
        let preview = read("fit = \"taut\"\nmodification = { preview = { seconds = 0.25 } }").unwrap();
        assert_eq!(preview.fit, RecordFit::parse("taut"));
        assert_eq!(preview.setup().unwrap().settings.modification, Modification::Preview { seconds: 0.25 });
        assert_eq!(read("").unwrap().setup().unwrap().settings.displacement.proportional, 3.70205);
    }

    #[test]
    fn steps_of_conditioning_are_read() {
        let scenario = read("conditioning = [{ do = \"scale\", factor = 0.5 }]").unwrap();
        assert_eq!(scenario.recipe(1000.0, 0.01).steps.len(), 1);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let message = |text: &str| read(text).unwrap_err().to_string();
        assert!(message("name = \"x\"\nvelocity = 1\n").contains("test.toml, line 2: unknown key `velocity`"));
        let fit = message("fit = \"cut\"");
        assert!(fit.contains("line 1") && fit.contains("expected one of clip taut convex"), "{fit}");
        assert!(message("controller = \"strong\"\nsettings = \"a.toml\"").contains("exclude each other"));
        let setup = |text: &str| read(text).unwrap().setup().unwrap_err().to_string();
        assert!(setup("controller = \"fast\"").contains("`fast`: expected one of current strong"));
        assert!(setup("steps = 3").contains("even"));
        assert!(setup("steps = 200000000").contains("between 2 and 1000"));
        assert!(
            setup("[sensors]\nacceleration_noise = nan").contains("acceleration_noise = NaN: it must be zero or more")
        );
        assert!(setup("[sensors]\ndisplacement_step = inf").contains("displacement_step = inf"));
        let line = "[[sensors.displacement_lines]]\nshape = \"sine\"\nfrequency_hz = 50.0\namplitude = inf";
        assert!(setup(line).contains("amplitude = inf: it must be a finite number"));
        assert!(setup("rate_hz = 1.0").contains("rate"));
        assert!(setup("[plant]\na1 = -1.0").contains("a1 = -1"));
    }
}
