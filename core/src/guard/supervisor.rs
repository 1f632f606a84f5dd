//! The state machine of a test.
//!
//! ```text
//!            arm            start             hold
//!    Off ---------> Ready ---------> Running <------> Hold
//!     ^ <--------- ^   ^                |      resume  |
//!     |    off     |   |  at rest       | stop         | stop
//!     |            |   +------------ RampDown <--------+
//!     | reset
//!  Tripped  <------- any state, on a trip; `off` from any other state goes through the safe ramp
//! ```
//! Weights between 0 and 1 do the moving. `test_weight` is how much of the test is let through: s(p) s(q) with the smooth step
//! s(p) = 3 p^2 - 2 p^3, of which p rises on start and resume and q falls on hold and stop. Neither turns back: a stop
//! during a fade-in lets p go on rising while q falls, and a resume during a fade-out waits for its end, so that neither position nor
//! velocity of the reference jumps.
//! `command` is how much of the last command is left after a trip: it falls from 1 to 0 over the safe ramp, to the
//! output at which no oil flows.
//!
//! There is no way from Tripped but `reset`, and `reset` is refused until the safe ramp has ended. The relay of the
//! hydraulic block is open in Off, and from the end of the safe ramp on in Tripped. It opens at the tick of the trip where no
//! command is known to stop the table: the valve itself is not believed, or the zero-flow output follows an LVDT that is not
//! believed.

mod weight;

use weight::{down, smooth, up};

use super::test_state::{OperatorRequest, Refused, State};
use super::{RampSettings, Trip};
use crate::block::{BlockError, require};
use crate::sample::Relay;

/// How fast the weights move, per tick.
///
/// ```
/// use shakedown_core::blocks::guard::Ramps;
/// use shakedown_core::settings::RampSettings;
///
/// assert!(Ramps::new(&RampSettings::default(), 1e-3).is_ok());
/// assert!(Ramps::new(&RampSettings { safe: -1.0, ..RampSettings::default() }, 1e-3).is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramps {
    test: f32,
    safe: f32,
}

impl Ramps {
    /// Ramps at ticks of `dt` (s).
    pub fn new(settings: &RampSettings, dt: f32) -> Result<Self, BlockError> {
        let test = require("guard.ramps.test", settings.test, 0.0, 1000.0)?;
        let safe = require("guard.ramps.safe", settings.safe, 0.0, 10.0)?;
        Ok(Self { test: dt / test.max(dt), safe: dt / safe.max(dt) })
    }
}

/// The state machine's state.
///
/// ```
/// use shakedown_core::blocks::guard::{Ramps, Supervisor};
/// use shakedown_core::settings::RampSettings;
/// use shakedown_core::{OperatorRequest, State};
///
/// let ramps = Ramps::new(&RampSettings::default(), 1e-3).unwrap();
/// let mut test = Supervisor::off();
/// test.request(OperatorRequest::Arm).unwrap();
/// test.request(OperatorRequest::Start).unwrap();
/// for _ in 0..2000 {
///     test.advance(ramps); // the test fades in over 2 s
/// }
/// assert!(test.state() == State::Running && test.test_weight() == 1.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Supervisor {
    state: State,
    trip: Option<Trip>,
    /// How far the test has been faded in since it was last out, and how much a fade-out since then has left, 0 to 1.
    risen: f32,
    left: f32,
    command: f32,
    relay: Relay,
    /// Whether the relay opens without waiting for the safe ramp, because no command is known to stop the table.
    open_at_once: bool,
    steady: bool,
    changes: u8,
}

impl Supervisor {
    /// Off, and never tripped.
    pub const fn off() -> Self {
        Self {
            state: State::Off,
            trip: None,
            risen: 0.0,
            left: 1.0,
            command: 0.0,
            relay: Relay::Open,
            open_at_once: false,
            steady: false,
            changes: 0,
        }
    }

    /// A test that needs no arming and is never stopped: that of a bare law.
    pub const fn unguarded() -> Self {
        Self {
            state: State::Running,
            trip: None,
            risen: 1.0,
            left: 1.0,
            command: 0.0,
            relay: Relay::Closed,
            open_at_once: false,
            steady: true,
            changes: 0,
        }
    }

    /// Where the test stands.
    #[inline]
    pub const fn state(&self) -> State {
        self.state
    }

    /// Why it tripped, until it is reset.
    #[inline]
    pub const fn cause(&self) -> Option<Trip> {
        self.trip
    }

    /// What the relay of the hydraulic block is to do.
    #[inline]
    pub const fn relay(&self) -> Relay {
        self.relay
    }

    /// How often state or cause have changed, modulo 256.
    #[inline]
    pub const fn changes(&self) -> u8 {
        self.changes
    }

    /// Takes on another state, and works out what follows from it.
    fn enter(&mut self, state: State) {
        self.state = state;
        self.changes = self.changes.wrapping_add(1);
        self.settle();
    }

    /// Works out what follows from the rest; done at every change, so that a tick need not.
    fn settle(&mut self) {
        self.relay = match self.state {
            State::Off => Relay::Open,
            State::Tripped if self.command <= 0.0 || self.open_at_once => Relay::Open,
            _ => Relay::Closed,
        };
        self.steady = self.state == State::Running && self.whole();
    }

    /// Whether the test runs whole: nothing fades, nothing has tripped.
    #[inline]
    pub fn steady(&self) -> bool {
        self.steady
    }

    /// Whether a law decides the output, rather than the safe ramp.
    #[inline]
    pub fn moves(&self) -> bool {
        !matches!(self.state, State::Off | State::Tripped)
    }

    /// How much of the test is let through, 0 to 1. Exactly 1 while it runs.
    #[inline]
    pub fn test_weight(&self) -> f32 {
        smooth(self.risen) * smooth(self.left)
    }

    /// How far the test has been faded in since it was last out, and how much a fade-out since then has left, 0 to 1.
    #[inline]
    pub const fn fades(&self) -> (f32, f32) {
        (self.risen, self.left)
    }

    /// Whether the test is neither faded nor fading.
    #[inline]
    pub fn whole(&self) -> bool {
        self.risen >= 1.0 && self.left >= 1.0
    }

    /// How much of the command at the trip is left, 1 to 0.
    #[inline]
    pub fn command(&self) -> f32 {
        self.command
    }

    /// Carries out `request`, or says why not and changes nothing.
    pub fn request(&mut self, request: OperatorRequest) -> Result<(), Refused> {
        let state = match (request, self.state) {
            (OperatorRequest::Trip, _) => {
                self.trip(Trip::External);
                return Ok(());
            }
            (OperatorRequest::Arm, State::Off) => {
                self.fade_anew();
                State::Ready
            }
            (OperatorRequest::Start, State::Ready) | (OperatorRequest::Resume, State::Hold) => State::Running,
            (OperatorRequest::Hold, State::Running) => State::Hold,
            (OperatorRequest::Stop, State::Running | State::Hold) => State::RampDown,
            (OperatorRequest::Off, State::Ready) => State::Off,
            (OperatorRequest::Reset, State::Tripped) => match self.trip {
                Some(trip) if self.command > 0.0 => return Err(Refused::StillMoving(trip)),
                _ => {
                    self.trip = None;
                    self.open_at_once = false;
                    State::Off
                }
            },
            (_, state) => return Err(Refused::State(state)),
        };
        self.enter(state);
        Ok(())
    }

    /// Trips while anything moves: what monitors say of a table without oil is no reason.
    #[cold]
    pub fn doubt(&mut self, cause: Trip) {
        if self.moves() {
            self.trip(cause);
        }
    }

    /// Trips, from any state. The first cause stands.
    #[inline]
    pub fn trip(&mut self, cause: Trip) {
        if self.state == State::Tripped {
            return;
        }
        self.command = if self.moves() { 1.0 } else { 0.0 };
        self.trip = Some(cause);
        self.open_at_once = cause.doubts_valve();
        self.enter(State::Tripped);
    }

    /// Opens the relay of a tripped test without waiting for the end of the safe ramp: no command is known to stop the table.
    #[cold]
    pub fn open_relay_at_once(&mut self) {
        if self.state == State::Tripped {
            self.open_at_once = true;
            self.settle();
        }
    }

    /// One tick of the weights. Needed while it is not [`Supervisor::steady`].
    pub fn advance(&mut self, ramps: Ramps) {
        match self.state {
            State::Off | State::Ready => self.fade_anew(),
            State::Running if self.left < 1.0 => self.fade_out(ramps.test),
            State::Running => self.risen = up(self.risen, ramps.test),
            State::Hold => self.fade_out(ramps.test),
            State::RampDown => {
                self.fade_out(ramps.test);
                if self.risen <= 0.0 {
                    self.enter(State::Ready);
                }
            }
            State::Tripped => {
                self.fade_anew();
                self.command = down(self.command, ramps.safe);
            }
        }
        self.settle();
    }

    /// Nothing of the test is let through.
    fn fade_anew(&mut self) {
        (self.risen, self.left) = (0.0, 1.0);
    }

    /// One tick of a fade-out, on top of what may still be fading in.
    fn fade_out(&mut self, step: f32) {
        if self.risen <= 0.0 {
            return;
        }
        self.risen = up(self.risen, step);
        self.left = down(self.left, step);
        if self.left <= 0.0 {
            self.fade_anew();
        }
    }
}
