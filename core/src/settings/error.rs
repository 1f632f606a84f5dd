//! Why settings were refused: the field, its value, its range and what to do; or the line of a text.

use crate::block::BlockError;

/// Why [`super::Settings`] were refused.
///
/// ```
/// use shakedown_core::Settings;
///
/// let error = Settings { stroke: -0.1, ..Settings::default() }.validate().unwrap_err();
/// assert_eq!(error.to_string(), "stroke is -0.1, not within 0.001 to 10");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SettingsError {
    /// A field is not a number, or outside its range.
    OutOfRange {
        /// The field's name.
        field: &'static str,
        /// What was given.
        value: f32,
        /// Smallest value accepted.
        low: f32,
        /// Largest value accepted.
        high: f32,
    },
    /// Two fields contradict each other.
    Contradiction {
        /// The field to change.
        field: &'static str,
        /// What it contradicts.
        with: &'static str,
    },
    /// A field is within its own range, but not with the others.
    Conflict {
        /// The field's name.
        field: &'static str,
        /// What was given.
        value: f32,
        /// Smallest value accepted with the others as they are.
        low: f32,
        /// Largest value accepted with the others as they are.
        high: f32,
        /// Why.
        because: &'static str,
        /// What to do.
        remedy: &'static str,
    },
}

impl core::fmt::Display for SettingsError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::OutOfRange { field, value, low, high } => write!(f, "{field} is {value}, not within {low} to {high}"),
            Self::Contradiction { field, with } => write!(f, "{field} does not go with {with}"),
            Self::Conflict { field, value, low, high, because, remedy } => {
                write!(f, "{field} is {value}, not within {low} to {high}: {because}; {remedy}")
            }
        }
    }
}

impl core::error::Error for SettingsError {}

impl From<BlockError> for SettingsError {
    fn from(error: BlockError) -> Self {
        let BlockError { field, value, low, high } = error;
        Self::OutOfRange { field, value, low, high }
    }
}

/// Why a text or a name was not taken.
///
/// ```
/// use shakedown_core::Settings;
/// use shakedown_core::settings::NameError;
///
/// let mut settings = Settings::default();
/// assert_eq!(settings.read("rate = 500\nstrok = 0.1"), Err(NameError::Unknown { line: 2 }));
/// assert_eq!(settings, Settings::default()); // whole or not at all
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum NameError {
    /// There is no setting of this name; in a text, the line is counted from 1, else 0.
    Unknown {
        /// The line, 0 for a single value.
        line: u32,
    },
    /// The value is not of the setting's kind, or the line is no setting.
    Value {
        /// The line, 0 for a single value.
        line: u32,
    },
}

impl NameError {
    pub(super) fn at(self, line: u32) -> Self {
        match self {
            Self::Unknown { .. } => Self::Unknown { line },
            Self::Value { .. } => Self::Value { line },
        }
    }
}

impl core::fmt::Display for NameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Unknown { line: 0 } => write!(f, "there is no setting of this name"),
            Self::Unknown { line } => write!(f, "line {line}: there is no setting of this name"),
            Self::Value { line: 0 } => write!(f, "the value is not of this setting's kind"),
            Self::Value { line } => write!(f, "line {line}: neither a table nor a name and a value of its kind"),
        }
    }
}

impl core::error::Error for NameError {}
