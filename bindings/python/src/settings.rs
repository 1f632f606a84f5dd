//! What may be set of the core, from a text or one by one.

use pyo3::prelude::*;
use shakedown_core::Settings;
use shakedown_core::host::{self, code};

use crate::refused;

/// Everything a user may set of the core. Made from the text of a settings file; what the text leaves out has its default.
#[pyclass(name = "Settings", module = "shakedown_table", frozen, eq)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PySettings(pub(crate) Settings);

#[pymethods]
impl PySettings {
    #[new]
    #[pyo3(signature = (text = ""))]
    fn new(py: Python<'_>, text: &str) -> PyResult<Self> {
        match toml::from_str(text) {
            Ok(settings) => Ok(Self(settings)),
            // Said by its number where a host without a parser of TOML would say it, else in the parser's words.
            Err(error) => {
                let code = match host::settings(text).map(|settings| settings.validate()) {
                    Err(code) => code,
                    Ok(validated) => validated.err().map_or(code::WRONG_VALUE, |error| host::settings_code(&error)),
                };
                Err(refused(py, code, error.to_string()))
            }
        }
    }

    /// These settings with one more, by its dotted name: `settings.set("guard.envelope.velocity", 0.5)`.
    fn set(&self, py: Python<'_>, name: &str, value: Value) -> PyResult<Self> {
        let value = match value {
            Value::Switch(on) => on.to_string(),
            Value::Number(number) => (number as f32).to_string(),
            Value::Word(word) => format!("\"{word}\""),
        };
        let mut settings = self.0;
        let said = |error| refused(py, host::name_code(error), format!("{name}: {error}"));
        settings.set(name, &value).map_err(said)?;
        Ok(Self(settings))
    }

    /// Refuses settings that no controller takes.
    fn validate(&self, py: Python<'_>) -> PyResult<()> {
        self.0.validate().map_err(|error| refused(py, host::settings_code(&error), error.to_string()))
    }

    /// Control rate, Hz.
    #[getter]
    fn rate(&self) -> f32 {
        self.0.rate
    }

    /// The settings as a settings file.
    #[allow(clippy::wrong_self_convention, reason = "Python has no receiver by value")]
    fn to_toml(&self, py: Python<'_>) -> PyResult<String> {
        toml::to_string(&self.0).map_err(|error| refused(py, code::WRONG_VALUE, error.to_string()))
    }

    fn __repr__(&self) -> String {
        format!("{:?}", self.0)
    }
}

/// A value in Python's words.
#[derive(FromPyObject)]
enum Value {
    Switch(bool),
    Number(f64),
    Word(String),
}
