//! What the settings leave the guard unable to see: no reason to refuse them, but to be said before a test.

use super::{Mode, Settings};

/// A hazard that the guard cannot see under these settings.
///
/// ```
/// use shakedown_core::Settings;
/// use shakedown_core::settings::Finding;
///
/// assert!(Settings::default().findings().any(|finding| finding == Finding::NoGuard));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Finding {
    /// There is no guard at all.
    NoGuard,
    /// Without an accelerometer only the valve command, through the model, contradicts the LVDT.
    NoAccelerometer,
    /// Without an accelerometer, in front of an existing controller, nothing contradicts the LVDT.
    NoSecondWitness,
    /// Without saturation detection the velocity limit in force is not known.
    NoSaturationDetection,
    /// Neither a second displacement sensor nor limit switches are read: a slow drift of the LVDT is seen by nobody but a
    /// switch in the emergency-stop circuit.
    NoDriftWitness,
    /// A relay that is welded is seen by nobody.
    NoRelayFeedback,
}

impl core::fmt::Display for Finding {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NoGuard => "guard is missing: nothing limits the table; add [guard]",
            Self::NoAccelerometer => {
                "observer.accelerometer is false: no plausibility of the LVDT but its noise and the valve command through the \
                 model; fit an accelerometer, or expect up to guard.valve.mismatch of undetected travel"
            }
            Self::NoSecondWitness => {
                "observer.accelerometer is false behind an existing controller: a drifting or stuck LVDT is not detected; fit an \
                 accelerometer or a second displacement sensor"
            }
            Self::NoSaturationDetection => "saturation is missing: a sagging supply is not detected; add [saturation]",
            Self::NoDriftWitness => {
                "guard.inputs has neither a second displacement sensor nor limit switches: a slow LVDT drift is not detected, and behind \
                 an existing controller that shares the LVDT neither is any even one, nor a gain that sinks in slow motion; put \
                 limit switches into the emergency-stop circuit"
            }
            Self::NoRelayFeedback => {
                "guard.inputs.relay_feedback is missing: a welded relay is not detected; try the relay before every test"
            }
        })
    }
}

impl Settings {
    /// What the guard cannot see under these settings, for the report at commissioning and before a test.
    pub fn findings(&self) -> impl Iterator<Item = Finding> {
        let inputs = self.guard.map(|guard| guard.inputs).unwrap_or_default();
        let second = inputs.second_displacement.is_some();
        let blind = !self.observer.accelerometer;
        let modifies = self.mode == Mode::Modifier;
        let guarded = self.guard.is_some();
        let all = [
            (!guarded, Finding::NoGuard),
            (guarded && blind && (second || !modifies), Finding::NoAccelerometer),
            (guarded && blind && modifies && !second, Finding::NoSecondWitness),
            (self.saturation.is_none(), Finding::NoSaturationDetection),
            (guarded && !second && !inputs.limit_switches, Finding::NoDriftWitness),
            (guarded && inputs.relay_feedback.is_none(), Finding::NoRelayFeedback),
        ];
        all.into_iter().filter_map(|(found, finding)| found.then_some(finding))
    }
}
