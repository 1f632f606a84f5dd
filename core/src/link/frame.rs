//! What a device says.

use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

use super::{Challenge, Setup};
use crate::guard::{State, Trip};

/// Most records of telemetry in one frame.
pub const MAX_BATCH: usize = 16;

/// What a device counts time by.
///
/// ```
/// use shakedown_core::link::Clock;
///
/// // An internal oscillator drifts by per cents: a host may want to say so.
/// let drifts = |clock: Clock| clock == Clock::Internal;
/// assert!(drifts(Clock::Internal) && !drifts(Clock::Crystal));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// A crystal.
    Crystal,
    /// A clock that comes from outside.
    External,
    /// The chip's own oscillator, since neither of the others started: 1 % at room temperature, several over the whole range.
    Internal,
}

/// Who a device is.
///
/// ```
/// use shakedown_core::link::{Clock, Identity};
///
/// let device = Identity {
///     firmware: [0, 1, 0],
///     full_scale: 65_520,
///     buffer: 1024,
///     clock: Clock::Crystal,
///     highest_rate: 5000,
/// };
/// assert!(device.buffer >= 1000); // a second of a streamed reference at 1 kHz
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Firmware version: major, minor, patch.
    pub firmware: [u8; 3],
    /// Largest code of the converters fitted.
    pub full_scale: u16,
    /// Points that the reference buffer holds.
    pub buffer: u16,
    /// What it counts time by.
    pub clock: Clock,
    /// Highest control rate that the board keeps up with, Hz.
    pub highest_rate: u32,
}

/// Most option bytes that a board asks for.
pub const MAX_OPTIONS: usize = 8;

/// What an option byte decides.
///
/// ```
/// use shakedown_core::link::{OptionByte, OptionPurpose};
///
/// let resets_at_low_supply = |byte: &OptionByte| byte.purpose == OptionPurpose::BrownOut && byte.found == byte.wanted;
/// let name = "BOR_LEV".try_into().unwrap();
/// assert!(!resets_at_low_supply(&OptionByte { purpose: OptionPurpose::BrownOut, name, found: 3, wanted: 0 }));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OptionPurpose {
    /// Below which supply the chip is held in reset.
    BrownOut,
    /// Whether the watchdog runs from the reset on, or from the program's start of it.
    Watchdog,
    /// Who may read the flash.
    ReadProtection,
    /// Whether the settings slots can be written.
    WriteProtection,
    /// How the flash is divided.
    Banks,
}

/// One setting that a chip takes from its flash at power-on, as a board reads it back.
///
/// ```
/// use shakedown_core::link::{OptionByte, OptionPurpose};
///
/// let name = "BOR_LEV".try_into().unwrap();
/// let byte = OptionByte { purpose: OptionPurpose::BrownOut, name, found: 3, wanted: 0 };
/// assert_ne!(byte.found, byte.wanted); // the chip would not reset at a low supply
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct OptionByte {
    /// What it decides.
    pub purpose: OptionPurpose,
    /// Its name in the vendor's programmer.
    pub name: String<16>,
    /// The value found, as the programmer takes it.
    pub found: u32,
    /// The value that the board asks for.
    pub wanted: u32,
}

/// Why a device tripped, stopped by itself, or does not arm.
///
/// ```
/// use shakedown_core::Trip;
/// use shakedown_core::link::StopCause;
///
/// let by_the_guard = |cause: StopCause| matches!(cause, StopCause::Guard(_));
/// assert!(by_the_guard(StopCause::Guard(Trip::SensorLost)));
/// assert!(!by_the_guard(StopCause::Underrun)); // the host was too slow
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename = "Cause")]
pub enum StopCause {
    /// The emergency-stop circuit is open.
    EmergencyStop,
    /// A tick was not done when the next began.
    Overrun,
    /// The streamed reference ran dry: the test was faded out.
    Underrun,
    /// The supply fell below its threshold.
    SupplyLow,
    /// The last reset came from the watchdog, or from a panic.
    Restarted,
    /// The host asked for it.
    Asked,
    /// The host said nothing for as long as [`Setup::lease_ms`].
    HostSilent,
    /// The core's guard.
    Guard(Trip),
}

/// Why a request was not carried out.
///
/// ```
/// use shakedown_core::link::{RefusedBecause, Report};
///
/// // A stream that is ahead of the device waits; every other refusal is for the operator.
/// let waits = |report: &Report| *report == Report::Refused(RefusedBecause::Full);
/// assert!(waits(&Report::Refused(RefusedBecause::Full)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum RefusedBecause {
    /// Not in this state.
    State(State),
    /// A field of the setup does not hold.
    Setup,
    /// The answer is wrong, late, or to no challenge.
    Challenge,
    /// The cause of the trip still stands.
    CauseStands(StopCause),
    /// Too much asked at once.
    Full,
    /// The flash did not take it.
    Flash,
    /// The control rate is above the highest that the board keeps up with, Hz.
    RateAbove(u32),
}

/// One tick as the device saw it: the codes it read and wrote, and what lay between them.
///
/// ```
/// use shakedown_core::link::Record;
///
/// let tick = Record { reference: 0.01, fitted: 0.008, ..Record::default() };
/// assert!(tick.fitted < tick.reference); // the record modifier held the table back
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Record {
    /// Reference as it came, m.
    pub reference: f32,
    /// Reference after modification, m.
    pub fitted: f32,
    /// Codes read: reference, displacement, acceleration, existing controller's command.
    pub inputs: [u16; 4],
    /// Code written.
    pub output: u16,
    /// [`crate::Status::bits`].
    pub flags: u16,
}

/// Records of telemetry in the order of their ticks.
///
/// ```
/// use heapless::Vec;
/// use shakedown_core::State;
/// use shakedown_core::link::{Batch, Record};
///
/// let records = Vec::from_slice(&[Record::default(); 2]).unwrap();
/// let batch = Batch { first: 100, every: 10, state: State::Running, dropped: 0, records };
/// // Ticks 100 and 110: the next batch begins at 120 unless some were dropped.
/// assert_eq!(batch.first + u32::from(batch.every) * 2, 120);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Batch {
    /// Tick of the first record, counted from the device's reset.
    pub first: u32,
    /// Ticks from one record to the next.
    pub every: u16,
    /// Where the test stood, the same for all of them.
    pub state: State,
    /// Records that found no room since the device's reset; what is missing between two batches is among them.
    pub dropped: u32,
    /// The records.
    pub records: Vec<Record, MAX_BATCH>,
}

/// How a device fares.
///
/// ```
/// use shakedown_core::State;
/// use shakedown_core::link::DeviceHealth;
///
/// let health = DeviceHealth {
///     state: State::Off,
///     cause: None,
///     ticks: 0,
///     dropped: 0,
///     garbled: 0,
///     stored: true,
///     buffered: 0,
/// };
/// assert!(health.stored && health.cause.is_none()); // it may be armed
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename = "Vitals")]
pub struct DeviceHealth {
    /// Where the test stands.
    pub state: State,
    /// Why it tripped, stopped by itself or did not arm, last.
    pub cause: Option<StopCause>,
    /// Ticks since its reset.
    pub ticks: u32,
    /// Records of telemetry that found no room.
    pub dropped: u32,
    /// Frames that came garbled.
    pub garbled: u32,
    /// Whether the setup came from flash; the defaults otherwise.
    pub stored: bool,
    /// Points of the reference in the buffer.
    pub buffered: u16,
}

/// What a device says.
///
/// ```
/// use shakedown_core::link::{Report, MAX_FRAME, decode, encode};
///
/// let mut frame = [0; MAX_FRAME];
/// let said = Report::Done;
/// let length = encode(&said, &mut frame)?;
/// assert_eq!(decode::<Report>(&mut frame[..length - 1])?, said);
/// # Ok::<(), shakedown_core::link::LinkError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Report {
    /// To [`HostRequest::Identify`](super::HostRequest::Identify).
    Identity(Identity),
    /// To [`HostRequest::ReadSetup`](super::HostRequest::ReadSetup).
    Setup(Setup),
    /// To [`HostRequest::RequestArming`](super::HostRequest::RequestArming).
    Challenge(Challenge),
    /// To [`HostRequest::ReadVitals`](super::HostRequest::ReadVitals), and of its own accord at every change of state.
    Vitals(DeviceHealth),
    /// The request was carried out.
    Done,
    /// It was not.
    Refused(RefusedBecause),
    /// To [`HostRequest::Reference`](super::HostRequest::Reference), and of its own accord as the buffer empties: what may be sent.
    Credit {
        /// Index of the next point wanted.
        next: u32,
        /// How many there is room for.
        room: u16,
    },
    /// Telemetry.
    Telemetry(Batch),
    /// To [`HostRequest::ReadOptions`](super::HostRequest::ReadOptions); empty where the device has none.
    Options(Vec<OptionByte, MAX_OPTIONS>),
}
