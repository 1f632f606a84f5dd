//! What a device's converter codes mean, and the whole of what it keeps.

use serde::{Deserialize, Serialize};

use crate::guard::InputSettings;
use crate::settings::{Mode, ReferenceRates, Settings, SettingsError, VelocitySource};
use crate::units::Scale;

/// Where the reference comes from.
///
/// ```
/// use shakedown_core::link::Source;
///
/// assert!(Source::Rehearsal.streamed() && !Source::Analog.streamed());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    /// The reference input of the converter.
    Analog,
    /// The host, through the link, ahead of time.
    Streamed,
    /// The same, in a rehearsal: the device reads and moves a simulated table, and keeps its relay open.
    Rehearsal,
}

/// What the converters' codes mean.
///
/// ```
/// use shakedown_core::link::{Scale, Source, Wiring};
///
/// // 16 bits over +/-10 V: an LVDT of 20 mm/V, an accelerometer of 1 g/V.
/// let per_volt = |si: f32| Scale { zero: 32_767.5, per_code: si * 20.0 / 65_535.0 };
/// let wiring = Wiring {
///     source: Source::Analog,
///     reference: per_volt(0.02),
///     displacement: per_volt(0.02),
///     acceleration: per_volt(9.81),
///     external: per_volt(0.02),
///     output: per_volt(0.02),
///     full_scale: 65_535,
///     rails_are_faults: true,
/// };
/// assert_eq!(wiring.margin(), 16); // codes at either end that are no reading
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wiring {
    /// Where the reference comes from.
    pub source: Source,
    /// Reference input, m.
    pub reference: Scale,
    /// LVDT input, m.
    pub displacement: Scale,
    /// Accelerometer input, m/s2.
    pub acceleration: Scale,
    /// The existing controller's command, m.
    pub external: Scale,
    /// Output, m.
    pub output: Scale,
    /// Largest code of the converters: 65520 on chip, the sum of 16 scans of 12 bits; 65535 outboard.
    pub full_scale: u16,
    /// Whether a code at either end of the range ([`Wiring::margin`]) is no reading: with a signal biased to the middle, a broken wire,
    /// a short or a saturated amplifier ends there.
    pub rails_are_faults: bool,
}

/// Everything a device keeps in flash: the core's settings and the wiring.
///
/// ```
/// use shakedown_core::Settings;
/// use shakedown_core::link::{Scale, Setup, SetupError, Source, Wiring};
///
/// let scale = Scale { zero: 2048.0, per_code: 1e-4 };
/// let wiring = Wiring {
///     source: Source::Streamed,
///     reference: scale,
///     displacement: scale,
///     acceleration: Scale { zero: 2048.0, per_code: 0.01 },
///     external: scale,
///     output: scale,
///     full_scale: 4095,
///     rails_are_faults: true,
/// };
/// let setup = Setup { telemetry_every: 1, lease_ms: 0, wiring, control: Settings::default() };
/// assert_eq!(setup.validate(), Err(SetupError::NoGuard)); // a device does not run without
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    /// A record of telemetry every so many ticks; 0 sends none.
    pub telemetry_every: u16,
    /// How long the host may say nothing while the device is armed before the test is faded out, and as long again before it is disarmed,
    /// ms; 0 where the device needs no host, else at least [`Setup::SHORTEST_LEASE`].
    #[serde(default)]
    pub lease_ms: u16,
    /// How the device is wired.
    pub wiring: Wiring,
    /// What the core is set to.
    pub control: Settings,
}

/// Why a [`Setup`] was refused.
///
/// ```
/// use shakedown_core::link::SetupError;
///
/// let error = SetupError::Wiring { field: "output", value: 0.0 };
/// assert_eq!(error.to_string(), "wiring.output is 0, which no converter can have");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SetupError {
    /// The core refuses its settings.
    Control(SettingsError),
    /// There is no guard: a device does not run without.
    NoGuard,
    /// A field of the wiring is not a number, or outside its range.
    Wiring {
        /// The field's name.
        field: &'static str,
        /// What was given.
        value: f32,
    },
    /// A lease shorter than a host's own silence.
    Lease {
        /// What was given, ms.
        given: u16,
    },
    /// A channel of the wiring does not reach as far as the settings ask of it.
    Reach {
        /// The channel's name.
        field: &'static str,
        /// What its converter reaches, SI units: from, to.
        reach: [f32; 2],
        /// What the settings ask of it, SI units: from, to.
        needed: [f32; 2],
        /// Why, and what to do.
        remedy: &'static str,
    },
}

impl core::fmt::Display for SetupError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Control(error) => write!(f, "control.{error}"),
            Self::NoGuard => write!(f, "control.guard is missing: a device does not run without one"),
            Self::Wiring { field, value } => write!(f, "wiring.{field} is {value}, which no converter can have"),
            Self::Lease { given } => {
                let shortest = Setup::SHORTEST_LEASE;
                write!(
                    f,
                    "lease_ms is {given}, and a host may be silent for longer: at least {shortest}, or 0 for none"
                )
            }
            Self::Reach { field, reach: [low, high], needed: [from, to], remedy } => {
                write!(f, "wiring.{field} reaches {low} to {high}, and {from} to {to} is needed: {remedy}")
            }
        }
    }
}

impl core::error::Error for SetupError {}

impl Source {
    /// Whether the reference comes from the host.
    pub const fn streamed(self) -> bool {
        matches!(self, Self::Streamed | Self::Rehearsal)
    }
}

impl Wiring {
    /// Codes at either end that are no reading: where the rails are faults, those within a 4096th of the range, for a mean of several
    /// scans at a rail is not always its last code; else none.
    pub const fn margin(&self) -> u16 {
        if self.rails_are_faults { 1 + self.full_scale / 4096 } else { 0 }
    }
}

impl Setup {
    /// Shortest lease, ms: a host asks every 100 ms how a test stands, and some of its frames may be lost.
    pub const SHORTEST_LEASE: u16 = 500;

    /// Checks every field. A device takes a setup only when all of it holds.
    pub fn validate(&self) -> Result<(), SetupError> {
        self.control.validate().map_err(SetupError::Control)?;
        if self.control.guard.is_none() {
            return Err(SetupError::NoGuard);
        }
        if (1..Self::SHORTEST_LEASE).contains(&self.lease_ms) {
            return Err(SetupError::Lease { given: self.lease_ms });
        }
        self.control.validate_for_device().map_err(SetupError::Control)?;
        self.check_inputs()?;
        self.check_wiring()?;
        self.check_stroke()?;
        self.check_ranges()?;
        self.check_zero_flow()
    }

    /// What the settings read beside the wiring's four inputs: without a wire it would read zero for ever, and be believed.
    fn check_inputs(&self) -> Result<(), SetupError> {
        let control = &self.control;
        let guard = control.guard.unwrap_or_default();
        let unwired = [
            (guard.inputs != InputSettings::default(), "guard.inputs"),
            (guard.envelope.force.is_some(), "guard.envelope.force"),
            (control.velocity_source == VelocitySource::Sensor, "velocity_source"),
            (control.reference_rates == ReferenceRates::Supplied, "reference_rates"),
            (control.tracking.is_some_and(|tracking| tracking.pressure.is_some()), "tracking.pressure"),
        ];
        let with = "a wiring, which has no such input yet";
        match unwired.into_iter().find(|(unwired, _)| *unwired) {
            Some((_, field)) => Err(SetupError::Control(SettingsError::Contradiction { field, with })),
            None => Ok(()),
        }
    }

    /// Every line of the wiring by itself.
    fn check_wiring(&self) -> Result<(), SetupError> {
        let wiring = &self.wiring;
        let scales = [
            ("reference", wiring.reference),
            ("displacement", wiring.displacement),
            ("acceleration", wiring.acceleration),
            ("external", wiring.external),
            ("output", wiring.output),
        ];
        for (field, scale) in scales {
            require(field, scale.zero, scale.zero.is_finite())?;
            let slope = scale.per_code;
            require(field, slope, slope.is_finite() && slope.abs() > 1e-12 && slope.abs() < 1e3)?;
        }
        require("full_scale", f32::from(wiring.full_scale), wiring.full_scale >= 255)
    }

    /// The LVDT reads the whole stroke, with a code to spare at either end where the rails are faults.
    fn check_stroke(&self) -> Result<(), SetupError> {
        let wiring = &self.wiring;
        let spare = wiring.margin();
        let reach = wiring.displacement.span(spare, wiring.full_scale - spare);
        let needed = [-self.control.stroke, self.control.stroke];
        let remedy = "control.stroke must lie within what the LVDT reads; lower it, or rescale the input";
        covers("displacement", reach, needed, remedy)
    }

    /// A converter at its rail is a fault: by its code, or because the rail lies beyond what is believed.
    fn check_ranges(&self) -> Result<(), SetupError> {
        let (wiring, control) = (&self.wiring, &self.control);
        if wiring.rails_are_faults {
            return Ok(());
        }
        let channels = [
            ("displacement", wiring.displacement, control.ranges.displacement, true),
            ("acceleration", wiring.acceleration, control.ranges.acceleration, control.observer.accelerometer),
            ("external", wiring.external, control.ranges.external, control.mode == Mode::Guard),
            ("reference", wiring.reference, control.ranges.reference, self.reads_reference()),
        ];
        for (field, scale, range, read) in channels {
            let [low, high] = scale.span(0, wiring.full_scale);
            if read && (range >= high || -range <= low) {
                let remedy =
                    "a converter at its rail must read beyond control.ranges; lower the range, or set rails_are_faults";
                return Err(SetupError::Reach { field, reach: [low, high], needed: [-range, range], remedy });
            }
        }
        Ok(())
    }

    fn reads_reference(&self) -> bool {
        self.wiring.source == Source::Analog && self.control.mode != Mode::Guard
    }

    /// The output reaches zero flow wherever in its stroke the table is, with a code to spare at either side.
    fn check_zero_flow(&self) -> Result<(), SetupError> {
        let (wiring, control) = (&self.wiring, &self.control);
        let reach = wiring.output.span(1, wiring.full_scale - 1);
        let [low, high] = [-control.stroke, control.stroke].map(|x| control.zero_flow(x));
        let remedy = "the output must reach zero flow at both ends of the stroke; use a bipolar output or rescale it";
        covers("output", reach, [low, high], remedy)
    }
}

/// Whether `reach` covers what is `needed`; a reach that is no number covers nothing.
fn covers(field: &'static str, reach: [f32; 2], needed: [f32; 2], remedy: &'static str) -> Result<(), SetupError> {
    if reach[0] <= needed[0] && reach[1] >= needed[1] {
        return Ok(());
    }
    Err(SetupError::Reach { field, reach, needed, remedy })
}

fn require(field: &'static str, value: f32, holds: bool) -> Result<(), SetupError> {
    if holds { Ok(()) } else { Err(SetupError::Wiring { field, value }) }
}
