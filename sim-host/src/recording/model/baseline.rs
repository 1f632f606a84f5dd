//! The three baselines of an experiment (docs/formats.md), each with its parameters in SI.

use super::super::document::Section;
use super::super::error::{Problem, RecordingError, nearest};
use super::{Accuracy, quantity};
use std::collections::BTreeMap;

/// The equations that are fitted and judged.
#[derive(Debug, Clone, PartialEq)]
pub enum Baseline {
    /// Eq. 7 and the velocity limiter, driven by the command.
    Servo(Servo),
    /// Eq. 1, `m x'' + c x' = gain u`.
    RigidMass(RigidMass),
    /// `pressure_difference = scale (x'' + viscous x' + f) + offset`, driven by the measured motion.
    ForceBalance(ForceBalance),
}

/// `G(s) = (b1 s + b0) / (s^2 + a1 s)` (Eq. 7), its velocity limited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Servo {
    /// Coefficient of s, 1/s per unit of u (m).
    pub b1: f64,
    /// Constant coefficient, 1/s2 per unit of u (m).
    pub b0: f64,
    /// Pole, 1/s.
    pub a1: f64,
    /// Largest speed, m/s; none where the model has no limiter.
    pub velocity_limit: Option<f64>,
    /// Moving mass, kg: with the piston area it makes `pressure_difference` absolute.
    pub mass: Option<f64>,
    /// Piston area, m2.
    pub piston_area: Option<f64>,
}

/// `m x'' + c x' = gain u` (Eq. 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMass {
    /// Moving mass, kg.
    pub mass: f64,
    /// Viscous friction, N s/m.
    pub viscous: f64,
    /// Force per unit of command, N.
    pub gain: f64,
}

/// `pressure_difference(t) = scale (x'' + viscous x' + f)(t + lead) + offset`; scale, lead and offset are always free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceBalance {
    /// Viscous friction per table mass, 1/s.
    pub viscous: f64,
    /// Where the scale's fit starts, unit of pressure per m/s2; none starts at its least-squares value.
    pub scale: Option<f64>,
    /// Where the offset's fit starts, unit of pressure.
    pub offset: Option<f64>,
    /// Where the fit of how much earlier the pressure was recorded than its motion starts, s.
    pub lead: f64,
}

/// Reads the numbers of `[model]`, keeping what is known of their accuracy.
struct Numbers<'a, 's> {
    section: &'a Section<'s>,
    accuracy: &'a mut BTreeMap<String, Accuracy>,
}

impl Numbers<'_, '_> {
    fn optional(&mut self, key: &'static str) -> Result<Option<f64>, RecordingError> {
        let Some(entry) = self.section.get(key) else { return Ok(None) };
        let (value, accuracy) = quantity(&entry)?;
        accuracy.map(|a| self.accuracy.insert(key.to_owned(), a));
        Ok(Some(value))
    }

    fn required(&mut self, key: &'static str, remedy: &'static str) -> Result<f64, RecordingError> {
        let place = self.section.place();
        let missing = || self.section.misspelt(key).unwrap_or_else(|| place.refuse(Problem::Missing { key, remedy }));
        if self.section.get(key).is_none() {
            return Err(missing());
        }
        self.optional(key)?.ok_or_else(|| self.section.place().refuse(Problem::Missing { key, remedy }))
    }

    /// Refuses a value for which `holds` is false.
    fn check(&self, key: &'static str, value: f64, holds: bool, expected: &'static str) -> Result<(), RecordingError> {
        let place = self.section.get(key).map_or_else(|| self.section.place(), |e| e.place());
        if holds { Ok(()) } else { Err(place.refuse(Problem::OutOfRange { value, expected })) }
    }

    fn positive(&mut self, key: &'static str) -> Result<Option<f64>, RecordingError> {
        let value = self.optional(key)?;
        if let Some(v) = value {
            self.check(key, v, v > 0.0, "it must be above zero")?;
            self.believed(key, v)?;
        }
        Ok(value)
    }

    /// Refuses a size that no table has, in SI; zero has none.
    fn believed(&self, key: &'static str, value: f64) -> Result<(), RecordingError> {
        let expected = "1e-9 to 1e9 in magnitude is expected, in SI units";
        self.check(key, value, value == 0.0 || (1e-9..=1e9).contains(&value.abs()), expected)
    }
}

/// The kinds, for messages.
const KINDS: [&str; 3] = ["servo", "rigid-mass", "force-balance"];

impl Baseline {
    /// Reads `kind` and the kind's parameters.
    pub(super) fn read(
        section: &Section<'_>,
        accuracy: &mut BTreeMap<String, Accuracy>,
    ) -> Result<Self, RecordingError> {
        let kind = section.required("kind", "write `kind = \"servo\"`, \"rigid-mass\" or \"force-balance\"")?;
        let mut numbers = Numbers { section, accuracy };
        match kind.string()? {
            "servo" => Servo::read(&mut numbers).map(Self::Servo),
            "rigid-mass" => RigidMass::read(&mut numbers).map(Self::RigidMass),
            "force-balance" => ForceBalance::read(&mut numbers).map(Self::ForceBalance),
            other => Err(kind.refuse(Problem::NotAChoice {
                found: other.to_owned(),
                choices: KINDS.join(", "),
                suggestion: nearest(other, KINDS),
            })),
        }
    }

    /// `servo`, `rigid-mass` or `force-balance`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Servo(_) => KINDS[0],
            Self::RigidMass(_) => KINDS[1],
            Self::ForceBalance(_) => KINDS[2],
        }
    }

    /// The names `fit` may use.
    pub fn names(&self) -> &'static [&'static str] {
        match self {
            Self::Servo(_) => &["b1", "b0", "a1", "velocity_limit"],
            Self::RigidMass(_) => &["mass", "viscous", "gain"],
            Self::ForceBalance(_) => &["viscous", "scale", "offset", "lead"],
        }
    }

    /// The parameters that have a value, by name, in SI.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        let all: Vec<(&'static str, Option<f64>)> = match self {
            Self::Servo(s) => vec![
                ("b1", Some(s.b1)),
                ("b0", Some(s.b0)),
                ("a1", Some(s.a1)),
                ("velocity_limit", s.velocity_limit),
                ("mass", s.mass),
                ("piston_area", s.piston_area),
            ],
            Self::RigidMass(r) => {
                vec![("mass", Some(r.mass)), ("viscous", Some(r.viscous)), ("gain", Some(r.gain))]
            }
            Self::ForceBalance(f) => {
                vec![("viscous", Some(f.viscous)), ("scale", f.scale), ("offset", f.offset), ("lead", Some(f.lead))]
            }
        };
        all.into_iter().filter_map(|(name, value)| value.map(|v| (name, v))).collect()
    }

    /// Sets a parameter by its name; false where the baseline has none of that name.
    pub fn set(&mut self, name: &str, value: f64) -> bool {
        match (self, name) {
            (Self::Servo(s), "b1") => s.b1 = value,
            (Self::Servo(s), "b0") => s.b0 = value,
            (Self::Servo(s), "a1") => s.a1 = value,
            (Self::Servo(s), "velocity_limit") => s.velocity_limit = Some(value),
            (Self::Servo(s), "mass") => s.mass = Some(value),
            (Self::Servo(s), "piston_area") => s.piston_area = Some(value),
            (Self::RigidMass(r), "mass") => r.mass = value,
            (Self::RigidMass(r), "viscous") => r.viscous = value,
            (Self::RigidMass(r), "gain") => r.gain = value,
            (Self::ForceBalance(f), "viscous") => f.viscous = value,
            (Self::ForceBalance(f), "scale") => f.scale = Some(value),
            (Self::ForceBalance(f), "offset") => f.offset = Some(value),
            (Self::ForceBalance(f), "lead") => f.lead = value,
            _ => return false,
        }
        true
    }

    /// Unit of a parameter, as `identify --json` writes it.
    pub fn unit(&self, name: &str) -> &'static str {
        match (self, name) {
            (Self::Servo(_), "b1" | "a1") | (Self::ForceBalance(_), "viscous") => "1/s",
            (Self::Servo(_), "b0") => "1/s2",
            (Self::ForceBalance(_), "lead") => "s",
            (Self::Servo(_), "velocity_limit") => "m/s",
            (_, "mass") => "kg",
            (_, "piston_area") => "m2",
            (Self::RigidMass(_), "viscous") => "N s/m",
            (Self::RigidMass(_), "gain") => "N",
            _ => "1",
        }
    }
}

impl Servo {
    fn read(numbers: &mut Numbers<'_, '_>) -> Result<Self, RecordingError> {
        const REMEDY: &str = "a servo model needs b1, b0 and a1 (Eq. 7); `shakedown identify` estimates those in `fit`";
        let servo = Self {
            b1: numbers.required("b1", REMEDY)?,
            b0: numbers.required("b0", REMEDY)?,
            a1: numbers.required("a1", REMEDY)?,
            velocity_limit: numbers.positive("velocity_limit")?,
            mass: numbers.positive("mass")?,
            piston_area: numbers.positive("piston_area")?,
        };
        numbers.check("a1", servo.a1, servo.a1 > 0.0, "a stable servo needs it above zero")?;
        numbers.check(
            "b0",
            servo.b0,
            servo.b0 > 0.0,
            "it must be above zero; a command of the other sign is turned in the recording",
        )?;
        for (key, value) in [("b1", servo.b1), ("b0", servo.b0), ("a1", servo.a1)] {
            numbers.believed(key, value)?;
        }
        if let Some(limit) = servo.velocity_limit {
            numbers.check("velocity_limit", limit, (1e-4..=100.0).contains(&limit), "1e-4 to 100 m/s is expected")?;
        }
        Ok(servo)
    }
}

impl RigidMass {
    fn read(numbers: &mut Numbers<'_, '_>) -> Result<Self, RecordingError> {
        let mass = numbers.required("mass", "write the moving mass in kg")?;
        numbers.check("mass", mass, mass > 0.0, "it must be above zero")?;
        let gain = numbers.optional("gain")?.unwrap_or(1.0);
        numbers.check("gain", gain, gain != 0.0, "it must not be zero")?;
        let viscous = numbers.optional("viscous")?.unwrap_or(0.0);
        for (key, value) in [("mass", mass), ("gain", gain), ("viscous", viscous)] {
            numbers.believed(key, value)?;
        }
        Ok(Self { mass, viscous, gain })
    }
}

impl ForceBalance {
    fn read(numbers: &mut Numbers<'_, '_>) -> Result<Self, RecordingError> {
        Ok(Self {
            viscous: numbers.optional("viscous")?.unwrap_or(0.0),
            scale: numbers.optional("scale")?,
            offset: numbers.optional("offset")?,
            lead: numbers.optional("lead")?.unwrap_or(0.0),
        })
    }
}
