//! `[table]` of a `table.toml`: what a table is beside its model, described once so that no limit is typed twice.

use super::document::read_text;
use super::document::{Section, Source, parse};
use super::error::{Problem, RecordingError};
use std::path::{Path, PathBuf};

/// What `[table]` states; what it leaves out is `None`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Described {
    /// Largest displacement to either side, m.
    pub stroke: Option<f64>,
    /// Largest acceleration, m/s2.
    pub acceleration: Option<f64>,
    /// Largest jerk, m/s3.
    pub jerk: Option<f64>,
    /// The controller that runs, by its name in `run`.
    pub controller: Option<String>,
    /// Mass on the table, kg.
    pub payload: Option<f64>,
    /// The device's serial port.
    pub port: Option<PathBuf>,
    /// The unit that drives are written in: m, cm, mm, in, V or %.
    pub drive_unit: Option<String>,
    /// Volts of the controller for one metre, V/m.
    pub volts_per_metre: Option<f64>,
    /// The valve's unit, `V`, `mA` or `%`, and how much of it opens the valve fully.
    pub valve: Option<(String, f64)>,
}

impl Described {
    /// What a `table.toml` states under `[table]`; nothing where it has no such section.
    pub fn load(path: &Path) -> Result<Self, RecordingError> {
        let text = read_text(path)?;
        let source = Source::new(path, &text);
        let document = parse(&source, &text)?;
        Self::read(&Section::root(&source, &document))
    }

    /// True where nothing is stated.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    pub(crate) fn read(root: &Section<'_>) -> Result<Self, RecordingError> {
        let Some(entry) = root.get("table") else { return Ok(Self::default()) };
        let section = entry.section()?;
        let within = |key: &'static str, low: f64, high: f64, expected: &'static str| {
            let Some(entry) = section.get(key) else { return Ok(None) };
            let value = entry.number()?;
            let inside = (low..=high).contains(&value);
            if inside { Ok(Some(value)) } else { Err(entry.refuse(Problem::OutOfRange { value, expected })) }
        };
        let choice = |key: &'static str, choices: &[&str]| {
            let Some(entry) = section.get(key) else { return Ok(None) };
            let found = entry.string()?;
            if choices.contains(&found) {
                return Ok(Some(found.to_owned()));
            }
            let suggestion = super::error::nearest(found, choices.iter().copied());
            Err(entry.refuse(Problem::NotAChoice { found: found.to_owned(), choices: choices.join(", "), suggestion }))
        };
        let described = Self {
            stroke: within("stroke", 1e-4, 5.0, "expected 0.0001 to 5 m")?,
            acceleration: within("acceleration", 1e-2, 1e3, "expected 0.01 to 1000 m/s2")?,
            jerk: within("jerk", 1e-1, 1e6, "expected 0.1 to 1e6 m/s3")?,
            controller: section.string("controller")?,
            payload: within("payload", 0.0, 1e7, "expected 0 to 1e7 kg")?,
            port: section.string("port")?.map(PathBuf::from),
            drive_unit: choice("drive_unit", &["m", "cm", "mm", "in", "V", "%"])?,
            volts_per_metre: within("volts_per_metre", 1e-3, 1e5, "expected 0.001 to 1e5 V/m")?,
            valve: choice("valve_unit", &["V", "mA", "%"])?
                .zip(Some(within("valve_full", 1e-3, 1e4, "expected 0.001 to 10000")?.unwrap_or(100.0))),
        };
        section.finish()?;
        Ok(described)
    }
}

/// A `table.toml` to be filled in, of a table with this `[model]`.
pub(crate) fn template(model: &str) -> String {
    format!(
        "# The table, described once. Commands started in this folder use it as soon as [table] states something; elsewhere\n\
         # name it with --table. Take the comment signs away and write your own values.\n\n\
         {model}\n\
         [table]\n\
         # stroke = 0.12              # m, to either side\n\
         # acceleration = 15.0        # m/s2\n\
         # jerk = 2000.0              # m/s3\n\
         # controller = \"current\"     # as `run --controller` names it\n\
         # payload = 0.0              # kg\n\
         # port = \"/dev/ttyACM0\"      # the device's; `shakedown device list` shows what there is\n\
         # drive_unit = \"mm\"          # m, cm, mm, in, V or %\n\
         # volts_per_metre = 80.0     # where drives are in V\n\
         # valve_unit = \"V\"           # V, mA or %\n\
         # valve_full = 10.0          # what opens the valve fully, in that unit\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Model;

    const MODEL: &str = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n";

    fn read(table: &str) -> Result<Described, RecordingError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.toml");
        std::fs::write(&path, format!("{MODEL}{table}")).unwrap();
        Model::load(&path)?;
        Described::load(&path)
    }

    #[test]
    fn a_table_is_read_or_refused_by_line() {
        let found = read("[table]\nstroke = 0.1\nvalve_unit = \"V\"\nvalve_full = 10\nport = \"/dev/x\"\n").unwrap();
        assert_eq!((found.stroke, found.valve), (Some(0.1), Some(("V".to_owned(), 10.0))));
        assert!(read("").unwrap().is_empty());
        for (wrong, said) in [
            ("[table]\nstroke = 120\n", "line 8, `table.stroke`: is 120; expected 0.0001 to 5 m"),
            ("[table]\nstorke = 0.1\n", "did you mean `stroke`"),
            ("[table]\nvalve_unit = \"A\"\n", "not among V, mA, %"),
            ("[table]\nstroke = \"big\"\n", "a number"),
        ] {
            let message = read(wrong).unwrap_err().to_string();
            assert!(message.contains(said), "{message}");
        }
    }

    #[test]
    fn the_template_states_nothing_and_can_be_filled_in() {
        let text = template(MODEL);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.toml");
        std::fs::write(&path, &text).unwrap();
        assert!(Described::load(&path).unwrap().is_empty() && Model::load(&path).is_ok());
        let (head, tail) = text.split_once("\n[table]\n").unwrap();
        std::fs::write(&path, format!("{head}\n[table]\n{}", format!("\n{tail}").replace("\n# ", "\n"))).unwrap();
        let filled = Described::load(&path).unwrap();
        assert_eq!((filled.stroke, filled.drive_unit.as_deref()), (Some(0.12), Some("mm")));
    }
}
