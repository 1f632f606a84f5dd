//! The record modifier that the settings name, behind one call.

use crate::record::{ReferenceLimits, causal, clip, preview};
use crate::settings::{Settings, SettingsError};

/// How the reference is modified on its way in.
///
/// ```
/// use shakedown_core::{Controller, Modification, Sample, Settings};
///
/// let mut controller = Controller::new(&Settings { modification: Modification::Causal, ..Settings::default() })?;
/// controller.step(&Sample::default());
/// // 1 m/s asked for, 0.242 m/s let through.
/// let command = controller.step(&Sample::new(0.001, 0.0, 0.0));
/// assert!((command.reference - 0.242e-3).abs() < 1e-6);
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Modification {
    /// Not at all.
    #[default]
    Off,
    /// The paper's Eq. 10: velocity clipped, then integrated. It drifts, and is kept for comparison.
    Clip,
    /// Inside velocity and stroke, without drift and without preview ([`causal`](crate::blocks::record::causal)).
    Causal,
    /// The same, with the reference known ahead of time: the modified one lags it by the preview ([`preview`](crate::blocks::record::preview)).
    Preview {
        /// How far ahead, s; at most [`PREVIEW_WINDOW`] less one ticks.
        seconds: f32,
    },
}

/// Samples of the reference that a preview can hold: half a second at 1 kHz.
pub const PREVIEW_WINDOW: usize = 512;
/// Bytes that it keeps beside them.
pub const PREVIEW_PLACES: usize = preview::places(PREVIEW_WINDOW);

/// Configuration of the modifier chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Modifier {
    Off,
    Clip(clip::Config),
    Causal(causal::Config),
    Preview(preview::Config),
}

/// What the modifier chosen remembers.
#[derive(Debug, Clone)]
pub(crate) enum ModifierState {
    Off,
    Clip(clip::State),
    Causal(causal::State),
    Preview(preview::State<PREVIEW_WINDOW, PREVIEW_PLACES>),
}

impl Modifier {
    /// The modifier that `settings` name, at their limits.
    pub(crate) fn new(settings: &Settings) -> Result<Self, SettingsError> {
        let mut limits = ReferenceLimits::new(settings.rate, settings.slower_limit(), settings.stroke);
        if let Some(guard) = &settings.guard {
            // A reference that the guard would stop on its way is no reference.
            limits.stroke = guard.envelope.reach(limits.stroke, limits.velocity, limits.braking);
        }
        Ok(match settings.modification {
            Modification::Off => Self::Off,
            Modification::Clip => Self::Clip(clip::Config::new(&limits)?),
            Modification::Causal => {
                Self::Causal(causal::Config::new(&limits, &causal::Config::DRIFT_RECOVERY, causal::Config::MEMORY)?)
            }
            Modification::Preview { seconds } => Self::Preview(preview::Config::new::<PREVIEW_WINDOW>(
                &limits,
                &preview::Config::DRIFT_RECOVERY,
                seconds,
            )?),
        })
    }

    /// A state at rest at `reference` (m).
    pub(crate) fn start(&self, reference: f32) -> ModifierState {
        match self {
            Self::Off => ModifierState::Off,
            Self::Clip(_) => ModifierState::Clip(clip::State::at(reference)),
            Self::Causal(_) => ModifierState::Causal(causal::State::at(reference)),
            Self::Preview(_) => ModifierState::Preview(preview::State::at(reference)),
        }
    }

    /// Puts `state` at rest at `reference` (m). Where it is of this modifier it stays where it is: moved, it would take its largest
    /// kind's bytes along, those of a preview, which is thousands of instructions in one tick and more than a small target's stack.
    #[inline(never)]
    pub(crate) fn restart(&self, state: &mut ModifierState, reference: f32) {
        match (self, &mut *state) {
            (Self::Off, ModifierState::Off) => {}
            (Self::Clip(_), ModifierState::Clip(state)) => *state = clip::State::at(reference),
            (Self::Causal(_), ModifierState::Causal(state)) => *state = causal::State::at(reference),
            (Self::Preview(_), ModifierState::Preview(state)) => state.restart(reference),
            _ => *state = self.start(reference),
        }
    }

    /// Goes on after ticks that were not heard, with `reference` (m) the next.
    #[cold]
    pub(crate) fn resume(state: &mut ModifierState, reference: f32) {
        match state {
            ModifierState::Off => {}
            ModifierState::Clip(state) => state.resume(reference),
            ModifierState::Causal(state) => state.resume(reference),
            ModifierState::Preview(state) => state.resume(reference),
        }
    }

    /// Whether `state` is of this modifier, so that it can go on under a new configuration.
    pub(crate) fn owns(&self, state: &ModifierState) -> bool {
        matches!(
            (self, state),
            (Self::Off, ModifierState::Off)
                | (Self::Clip(_), ModifierState::Clip(_))
                | (Self::Causal(_), ModifierState::Causal(_))
                | (Self::Preview(_), ModifierState::Preview(_))
        )
    }

    /// Whether it is of the same kind as another, and as late.
    pub(crate) fn is_of_kind(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Preview(one), Self::Preview(other)) => one.delay() == other.delay(),
            _ => core::mem::discriminant(self) == core::mem::discriminant(other),
        }
    }

    /// One tick: reference (m) and the velocity limit now in force (m/s) in, modified reference (m) out.
    pub(crate) fn advance(&self, state: &mut ModifierState, reference: f32, velocity_limit: f32) -> f32 {
        match (self, state) {
            (Self::Clip(config), ModifierState::Clip(state)) => clip::step(config, state, reference, velocity_limit),
            (Self::Causal(config), ModifierState::Causal(state)) => {
                causal::step(config, state, reference, velocity_limit)
            }
            (Self::Preview(config), ModifierState::Preview(state)) => {
                preview::step(config, state, reference, velocity_limit)
            }
            _ => reference,
        }
    }
}
