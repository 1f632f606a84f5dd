//! The controller for hosts of every kind: codes in place of enums, and tapes that hold one host against another.
//!
//! A tape is a row of records, each a tag and a length (two u32) and that many bytes, all little-endian:
//!
//! ```text
//! 1 begin     text of settings      a new controller
//! 2 retune    text of settings      the one there is; refused settings leave it as it was
//! 3 request   u32, REQUESTS         arm, start, ...
//! 4 sample    9 f32, u32 flags      one tick; bit 0 limit switch, 1 relay closed
//! ```
//! Each record is answered by four u32: a [`code`] and three zeros, or to a sample the bits of valve, reference and velocity
//! limit, and a word of status. A host is judged by its answers to the same tape, byte by byte, and by their [`Digest`].

use crate::guard::{OperatorRequest, Refused};
use crate::sample::{Command, Sample};
use crate::settings::{NameError, Settings, SettingsError};
use crate::{Controller, Relay};

/// What a call came to, as a number that stays the same from version to version.
pub mod code {
    /// It was done.
    pub const OK: i32 = 0;
    /// A setting is not a number, or outside its range.
    pub const OUT_OF_RANGE: i32 = 1;
    /// Two settings contradict each other.
    pub const CONTRADICTION: i32 = 2;
    /// A setting is within its own range, but not with the others.
    pub const CONFLICT: i32 = 3;
    /// The request does not apply in this state.
    pub const REFUSED_STATE: i32 = 4;
    /// The safe ramp after the trip has not ended.
    pub const REFUSED_MOVING: i32 = 5;
    /// The guard sees a reason to trip already.
    pub const REFUSED_CAUSE: i32 = 6;
    /// There is no guard, and so nothing to ask.
    pub const REFUSED_NO_GUARD: i32 = 7;
    /// There is no setting of this name.
    pub const UNKNOWN_NAME: i32 = 8;
    /// The value is not of the setting's kind.
    pub const WRONG_VALUE: i32 = 9;
    /// There is no request of this number.
    pub const UNKNOWN_REQUEST: i32 = 10;
}

/// The number of an error in settings.
pub const fn settings_code(error: &SettingsError) -> i32 {
    match error {
        SettingsError::OutOfRange { .. } => code::OUT_OF_RANGE,
        SettingsError::Contradiction { .. } => code::CONTRADICTION,
        SettingsError::Conflict { .. } => code::CONFLICT,
    }
}

/// The number of a refusal.
pub const fn refused_code(refused: Refused) -> i32 {
    match refused {
        Refused::State(_) => code::REFUSED_STATE,
        Refused::StillMoving(_) => code::REFUSED_MOVING,
        Refused::Cause(_) => code::REFUSED_CAUSE,
        Refused::NoGuard => code::REFUSED_NO_GUARD,
    }
}

/// The number of an error in a name.
pub const fn name_code(error: NameError) -> i32 {
    match error {
        NameError::Unknown { .. } => code::UNKNOWN_NAME,
        NameError::Value { .. } => code::WRONG_VALUE,
    }
}

/// Every request; its place here is its number on every host.
pub const REQUESTS: [OperatorRequest; 8] = [
    OperatorRequest::Arm,
    OperatorRequest::Start,
    OperatorRequest::Hold,
    OperatorRequest::Resume,
    OperatorRequest::Stop,
    OperatorRequest::Off,
    OperatorRequest::Reset,
    OperatorRequest::Trip,
];

/// Asks `controller` for the request of this number.
///
/// ```
/// use shakedown_core::host::{self, code};
/// use shakedown_core::{Controller, Settings};
///
/// let mut controller = Controller::new(&Settings::default())?;
/// assert_eq!(host::request(&mut controller, 0), code::REFUSED_NO_GUARD); // there is none to arm
/// assert_eq!(host::request(&mut controller, 99), code::UNKNOWN_REQUEST);
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
pub fn request(controller: &mut Controller, number: u32) -> i32 {
    match REQUESTS.get(number as usize) {
        None => code::UNKNOWN_REQUEST,
        Some(request) => controller.request(*request).map_or_else(refused_code, |()| code::OK),
    }
}

/// Settings from the text of a begin or retune, over the defaults.
///
/// ```
/// use shakedown_core::host::{self, code};
///
/// assert_eq!(host::settings("rate = 500").map(|settings| settings.rate), Ok(500.0));
/// assert_eq!(host::settings("rat = 500").unwrap_err(), code::UNKNOWN_NAME);
/// ```
pub fn settings(text: &str) -> Result<Settings, i32> {
    let mut settings = Settings::default();
    settings.read(text).map_err(name_code)?;
    Ok(settings)
}

/// A sample from its numbers in the order of [`Sample`], in SI, and its flags.
pub const fn sample(numbers: &[f32; 9], flags: u32) -> Sample {
    let [reference, displacement, acceleration, external, velocity, pressure_difference, rest @ ..] = *numbers;
    let [reference_velocity, reference_acceleration, second_displacement] = rest;
    Sample {
        reference,
        displacement,
        acceleration,
        external,
        velocity,
        pressure_difference,
        reference_velocity,
        reference_acceleration,
        second_displacement,
        limit_switch: flags & 1 != 0,
        relay_closed: flags & 2 != 0,
    }
}

/// The status of a tick as a word: 0 saturated, 1 held, 2 limited, 3 relay closed, 4 to 6 the state, 8 to 12 the trip, 16 to 23
/// the missing channels, 24 to 31 the controller's count of changes.
pub fn status(command: &Command, changes: u8) -> u32 {
    let status = &command.status;
    u32::from(status.bits()) | u32::from(status.missing.bits()) << 16 | u32::from(changes) << 24
}

/// What a host answers to a record.
pub type Answer = [u32; 4];

/// A record that is not on any tape: its tag, and what is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Damaged {
    /// The record's tag.
    pub tag: u32,
}

impl core::fmt::Display for Damaged {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "the tape is damaged: no record of tag {} is like this", self.tag)
    }
}

impl core::error::Error for Damaged {}

/// Plays a tape to a controller, one record at a time.
///
/// ```
/// use shakedown_core::host::{Player, code};
///
/// let mut player = Player::new();
/// assert_eq!(player.play(1, b"rate = 500")?, [code::OK as u32, 0, 0, 0]); // begin
/// assert!(player.play(9, b"").is_err()); // no such record
/// # Ok::<(), shakedown_core::host::Damaged>(())
/// ```
#[derive(Debug, Clone)]
pub struct Player {
    controller: Controller,
}

impl Player {
    /// Tags of the records.
    pub const TAGS: [u32; 4] = [1, 2, 3, 4];

    /// Before the first record: a controller without settings.
    pub fn new() -> Self {
        Self { controller: Controller::inert() }
    }

    /// Plays one record.
    pub fn play(&mut self, tag: u32, content: &[u8]) -> Result<Answer, Damaged> {
        let damaged = Damaged { tag };
        let text = || core::str::from_utf8(content).map_err(|_| damaged);
        let code = match tag {
            1 => {
                self.controller = Controller::inert();
                self.retune(text()?)
            }
            2 => self.retune(text()?),
            3 => request(&mut self.controller, word(content, 0).ok_or(damaged)?),
            4 => return self.step(content).ok_or(damaged),
            _ => return Err(damaged),
        };
        Ok([code as u32, 0, 0, 0])
    }

    fn retune(&mut self, text: &str) -> i32 {
        match settings(text) {
            Ok(settings) => self.controller.retune(&settings).map_or_else(|e| settings_code(&e), |()| code::OK),
            Err(code) => code,
        }
    }

    fn step(&mut self, content: &[u8]) -> Option<Answer> {
        let mut numbers = [0.0; 9];
        for (at, number) in numbers.iter_mut().enumerate() {
            *number = f32::from_bits(word(content, at)?);
        }
        let command = self.controller.step(&sample(&numbers, word(content, 9)?));
        let numbers = [command.valve, command.reference, command.status.velocity_limit].map(f32::to_bits);
        let [valve, reference, limit] = numbers;
        Some([valve, reference, limit, status(&command, self.controller.changes())])
    }

    /// What the relay of the hydraulic block is to do.
    pub const fn relay(&self) -> Relay {
        self.controller.relay()
    }

    /// The controller, as the tape left it.
    pub const fn controller(&self) -> &Controller {
        &self.controller
    }
}

impl Default for Player {
    fn default() -> Self {
        Self::new()
    }
}

/// The little-endian word at this place.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.as_chunks().0.get(at).map(|word| u32::from_le_bytes(*word))
}

/// FNV-1a over bytes, 64 bits.
///
/// ```
/// use shakedown_core::host::Digest;
///
/// let mut digest = Digest::new();
/// digest.bytes(b"a");
/// assert_eq!(digest.to_string(), "af63dc4c8601ec8c");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Digest(pub u64);

impl Digest {
    /// Of nothing.
    pub const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Takes in an answer.
    pub fn answer(&mut self, answer: Answer) {
        for word in answer {
            self.bytes(&word.to_le_bytes());
        }
    }

    /// Takes in bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

impl Default for Digest {
    fn default() -> Self {
        Self::new()
    }
}

impl core::fmt::Display for Digest {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}
