//! The controller that ran while a recording was made.

use super::document::read_text;
use super::document::{Entry, Section};
use super::error::{Place, Problem, RecordingError, nearest};
use crate::plant::simulate::Notch;
use shakedown_core::Settings;
use std::path::{Path, PathBuf};

/// The loop that ran; a simulation closes the same loop from the reference.
#[derive(Debug, Clone, PartialEq)]
pub enum RecordedLaw {
    /// No controller: the recorded command drives the model.
    Open,
    /// `u[k] = kp e[k] + ki dt (e[0] + ... + e[k])`, plain: no anti-windup, no limits.
    ProportionalIntegral {
        /// Proportional gain, unit of u per m.
        kp: f64,
        /// Integral gain, unit of u per m s.
        ki: f64,
    },
    /// `u[k] = kv (kp e[k] - velocity[k])`, the velocity being the backward difference of the measured displacement.
    Cascade {
        /// Position gain, 1/s.
        kp: f64,
        /// Velocity gain, unit of u per m/s.
        kv: f64,
    },
    /// The whole control core.
    Core {
        /// Its settings.
        settings: Box<Settings>,
        /// Where they were read.
        path: PathBuf,
    },
}

/// Share of what a gain over a time is off by that the other gain may be off by, for a clock to be why.
const EXACT: f64 = 0.2;

/// Gains of a law over those of another of its kind.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GainFactors {
    /// Of the gain that no time enters.
    plain: f64,
    /// Of the gain over a time, as another period would make it.
    over_time: f64,
}

impl GainFactors {
    /// True over stated sampling period, less one, where the gain over a time is off and the other is as stated.
    pub(crate) fn clock_rate(self) -> Option<f64> {
        let (plain, rate) = (self.plain - 1.0, self.over_time - 1.0);
        (rate != 0.0 && plain.abs() < EXACT * rate.abs()).then_some(rate)
    }
}

impl RecordedLaw {
    /// The gains of a law that was found over those of this one; none of another kind, and of laws without such gains.
    pub(crate) fn factors_of(&self, found: &Self) -> Option<GainFactors> {
        match (self, found) {
            (Self::ProportionalIntegral { kp, ki }, Self::ProportionalIntegral { kp: found, ki: over_time }) => {
                Some(GainFactors { plain: found / kp, over_time: over_time / ki })
            }
            (Self::Cascade { kp, kv }, Self::Cascade { kp: outer, kv: inner }) => {
                Some(GainFactors { plain: (outer * inner) / (kp * kv), over_time: kv / inner })
            }
            _ => None,
        }
    }

    /// Reads a run's `controller`, with what surrounds it; a settings file is looked for beside the experiment.
    pub(crate) fn read(entry: &Entry<'_>, folder: &Path) -> Result<(Self, Shaping), RecordingError> {
        const CHOICES: &str = "{ kp, ki }, { kind = \"cascade\", kp, kv }, { core = \"settings.toml\" }, \"none\"";
        if entry.is_string() {
            return match entry.string()? {
                "none" => Ok((Self::Open, Shaping::default())),
                other => Err(entry.refuse(Problem::NotAChoice {
                    found: other.to_owned(),
                    choices: CHOICES.to_owned(),
                    suggestion: nearest(other, ["none"]),
                })),
            };
        }
        let section = entry.section()?;
        let read = if let Some(core) = section.get("core") {
            (Self::core(&core, folder)?, Shaping::default())
        } else {
            (Self::gains(&section)?, Shaping::read(&section)?)
        };
        section.finish()?;
        Ok(read)
    }

    fn gains(section: &Section<'_>) -> Result<Self, RecordingError> {
        let kind = section.get("kind");
        let name = kind.as_ref().map_or(Ok("pi"), Entry::string)?;
        // Whatever else may stand here is no misspelt `kp`.
        for key in ["ki", "kv", "kvf", "kdp", "notch"] {
            section.get(key);
        }
        let kp = section.required("kp", "write the proportional gain, or leave `controller` out where none ran")?;
        let gain = |entry: &Entry<'_>| {
            let value = entry.number()?;
            let expected =
                "it must be above zero and at most 1e9; a command of the other sign is turned in the recording";
            if value > 0.0 && value <= 1e9 {
                Ok(value)
            } else {
                Err(entry.refuse(Problem::OutOfRange { value, expected }))
            }
        };
        match (name, kind) {
            ("cascade", _) => {
                let kv = section.required("kv", "a cascade needs its velocity gain")?.number()?;
                Ok(Self::Cascade { kp: gain(&kp)?, kv })
            }
            ("pi", _) => Ok(Self::ProportionalIntegral { kp: gain(&kp)?, ki: section.number("ki")?.unwrap_or(0.0) }),
            (other, kind) => Err(kind.as_ref().unwrap_or(&kp).refuse(Problem::NotAChoice {
                found: other.to_owned(),
                choices: "\"pi\", \"cascade\"".to_owned(),
                suggestion: nearest(other, ["pi", "cascade"]),
            })),
        }
    }

    fn core(entry: &Entry<'_>, folder: &Path) -> Result<Self, RecordingError> {
        let path = folder.join(entry.string()?);
        let text = read_text(&path)?;
        let settings: Settings = toml::from_str(&text).map_err(|error| {
            let line = error.span().map(|s| 1 + text[..s.start.min(text.len())].matches('\n').count());
            let place = Place { line, ..Place::file(&path) };
            place.refuse(Problem::Syntax(crate::files::wording::plain(error.message())))
        })?;
        settings.validate().map_err(|error| {
            Place::file(&path).refuse(Problem::Contradiction(format!("settings refused: {error:?}")))
        })?;
        Ok(Self::Core { settings: Box::new(settings), path })
    }

    /// In a sentence, for reports.
    pub fn describe(&self) -> String {
        match self {
            Self::Open => "no controller: the recorded command drives".to_owned(),
            Self::ProportionalIntegral { kp, ki } => format!("PI, kp = {kp}, ki = {ki} 1/s"),
            Self::Cascade { kp, kv } => format!("cascade, kp = {kp} 1/s, kv = {kv}"),
            Self::Core { path, .. } => format!("control core, {}", path.display()),
        }
    }
}

/// What a PI law of these gains and feed-forward makes of reference and displacement (m), sampled every `dt` seconds. Until then the integral
/// of the error had come to `sum` (m s), and the reference was at `before` (m).
pub(crate) fn commands_of_pi(
    [kp, ki, kvf]: [f64; 3],
    [reference, displacement]: [&[f64]; 2],
    (mut sum, mut before): (f64, f64),
    dt: f64,
) -> Vec<f64> {
    let command = |(r, x): (&f64, &f64)| {
        let error = r - x;
        sum += error * dt;
        let fed = kvf * (r - before) / dt;
        before = *r;
        kp * error + ki * sum + fed
    };
    reference.iter().zip(displacement).map(command).collect()
}

/// What surrounds a law: feed-forward, feedback of pressure, a notch, and delays.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shaping {
    /// Feed-forward, `u += kvf (r[k] - r[k-1]) / dt`, unit of u s per m.
    pub kvf: f64,
    /// Feedback of the pressure difference, `u -= kdp p`, unit of u per unit of p.
    pub kdp: f64,
    /// A notch that the whole command passes.
    pub notch: Option<Notch>,
    /// Samples by which the command comes late.
    pub late_command: usize,
    /// Samples by which the controller sees the displacement late.
    pub late_displacement: usize,
}

impl Shaping {
    fn read(section: &Section<'_>) -> Result<Self, RecordingError> {
        let (kvf, kdp) = (section.number("kvf")?.unwrap_or(0.0), section.number("kdp")?.unwrap_or(0.0));
        let notch = section.get("notch").map(|entry| notch(&entry)).transpose()?;
        Ok(Self { kvf, kdp, notch, ..Self::default() })
    }
}

/// Reads `notch = { frequency, damping, depth }`: Hz and two numbers without unit.
fn notch(entry: &Entry<'_>) -> Result<Notch, RecordingError> {
    let section = entry.section()?;
    let frequency = section.required("frequency", "write the centre of the notch in Hz")?.positive()?;
    let damping = section.required("damping", "write the damping of the notch")?.positive()?;
    let depth = section.number("depth")?.unwrap_or(0.0);
    section.finish()?;
    Ok(Notch { frequency, damping, depth })
}
