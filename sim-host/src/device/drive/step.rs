//! The steps of a run.

use shakedown_core::State;

/// What is asked next; what is behind it has been answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    Identify,
    Setup,
    Vitals,
    ClearTrip,
    /// Disarmed first: a device counts the points of a reference from its arming.
    Release,
    Challenge,
    /// With the answer to the challenge.
    Arm(u64),
    Fill,
    Start,
    Stream,
    /// Started, of a test that is attended, at this time, ms.
    Attend(u64),
    Stop,
    Stand,
    /// Faded out and held until the operator ends the test.
    Held,
    Disarm,
    Done,
}

impl Step {
    /// What is asked, for whom it is not answered.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Identify => "who it is",
            Self::Setup => "its setup",
            Self::Vitals | Self::Attend(_) | Self::Stand | Self::Held => "its health",
            Self::ClearTrip => "clearing the trip",
            Self::Challenge | Self::Arm(_) => "arming",
            Self::Fill | Self::Stream => "the reference",
            Self::Start => "the start",
            Self::Stop => "the stop",
            Self::Release | Self::Disarm => "disarming",
            Self::Done => "nothing",
        }
    }

    /// Whether a refusal because the device is in `state` answers a repeated order of an earlier step: the device answered
    /// the order after the host had repeated it, and the order had led to `state`.
    pub(super) const fn comes_after(self, state: State) -> bool {
        match state {
            State::Off => matches!(self, Self::Vitals | Self::Challenge | Self::Arm(_)),
            State::Ready => matches!(self, Self::Fill | Self::Start | Self::Stand | Self::Held | Self::Disarm),
            State::Running => matches!(self, Self::Stream | Self::Attend(_) | Self::Stop | Self::Stand | Self::Held),
            _ => false,
        }
    }
}
