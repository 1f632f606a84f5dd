//! The frames themselves.

use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

use super::{Challenge, Setup};
use crate::guard::{State, Trip};

/// Most points of a reference in one frame.
pub const MAX_POINTS: usize = 64;

/// Most records of telemetry in one frame.
pub const MAX_BATCH: usize = 16;

/// What a host asks of a device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Request")]
pub enum HostRequest {
    /// Who are you? Answered by [`Report::Identity`].
    Identify,
    /// Answered by [`Report::Setup`].
    ReadSetup,
    /// Takes effect whole, between two ticks, without a bump. The wiring and the rate change only while the test is off
    /// or tripped.
    WriteSetup(Setup),
    /// Keeps the setup now in force over a reset. Only while off or tripped: the ticks stop for a second or two.
    Save,
    /// Answered by [`Report::Challenge`].
    RequestArming,
    /// The answer to the challenge: closes the relay and holds the table where it stands.
    Arm(u64),
    /// Starts the test.
    Start,
    /// Fades the test out and holds the table; a streamed reference ends.
    Stop,
    /// Opens the relay, from a stand.
    Disarm,
    /// Clears a trip whose cause is gone. The only way out of one.
    ClearTrip,
    /// Trips, from anywhere.
    Trip,
    /// Points of the reference, ahead of time. Answered by [`Report::Credit`], whether they were taken or not: they are
    /// not when `first` is not the next point wanted, or when they do not all fit.
    Reference(Points),
    /// Puts a code on the output, for commissioning: only while off, and until the next request that is not this one.
    Probe(u16),
    /// Answered by [`Report::Vitals`].
    ReadVitals,
    /// Answered by [`Report::Options`].
    ReadOptions,
}

/// Points of a reference, one a tick.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Points {
    /// Index of the first of them, counted from the start of the record.
    pub first: u32,
    /// Displacement, m.
    pub points: Vec<f32, MAX_POINTS>,
    /// The record ends with the last of them.
    pub last: bool,
}

/// What a device counts time by.
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
    /// The core's guard.
    Guard(Trip),
}

/// Why a request was not carried out.
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Report {
    /// To [`HostRequest::Identify`].
    Identity(Identity),
    /// To [`HostRequest::ReadSetup`].
    Setup(Setup),
    /// To [`HostRequest::RequestArming`].
    Challenge(Challenge),
    /// To [`HostRequest::ReadVitals`], and of its own accord at every change of state.
    Vitals(DeviceHealth),
    /// The request was carried out.
    Done,
    /// It was not.
    Refused(RefusedBecause),
    /// To [`HostRequest::Reference`], and of its own accord as the buffer empties: what may be sent.
    Credit {
        /// Index of the next point wanted.
        next: u32,
        /// How many there is room for.
        room: u16,
    },
    /// Telemetry.
    Telemetry(Batch),
    /// To [`HostRequest::ReadOptions`]; empty where the device has none.
    Options(Vec<OptionByte, MAX_OPTIONS>),
}
