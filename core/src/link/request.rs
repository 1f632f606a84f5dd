//! What a host asks of a device.

use heapless::Vec;
use serde::{Deserialize, Serialize};

use super::Setup;

/// Most points of a reference in one frame.
pub const MAX_POINTS: usize = 64;

/// What a host asks of a device.
///
/// ```
/// use shakedown_core::link::{HostRequest, MAX_FRAME, decode, encode};
///
/// let mut frame = [0; MAX_FRAME];
/// let said = HostRequest::Probe(3);
/// let length = encode(&said, &mut frame)?;
/// assert_eq!(decode::<HostRequest>(&mut frame[..length - 1])?, said);
/// # Ok::<(), shakedown_core::link::LinkError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Request")]
pub enum HostRequest {
    /// Who are you? Answered by [`Report::Identity`](super::Report::Identity).
    Identify,
    /// Answered by [`Report::Setup`](super::Report::Setup).
    ReadSetup,
    /// Takes effect whole, between two ticks, without a bump. Only while the relay is open change the wiring, the rate, the mode and the inner
    /// loop, and the kinds of law and modifier.
    WriteSetup(Setup),
    /// Keeps the setup now in force over a reset. Only while off or tripped: the ticks stop for a second or two.
    Save,
    /// Answered by [`Report::Challenge`](super::Report::Challenge).
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
    /// Points of the reference, ahead of time. Answered by [`Report::Credit`](super::Report::Credit), whether they were taken or not: they are
    /// not when `first` is not the next point wanted, or when they do not all fit.
    Reference(Points),
    /// Puts a code on the output, for commissioning: only while off, and until arming, or any change of the test's state, is asked for, or the
    /// wiring changes.
    Probe(u16),
    /// Answered by [`Report::Vitals`](super::Report::Vitals).
    ReadVitals,
    /// Answered by [`Report::Options`](super::Report::Options).
    ReadOptions,
}

/// Points of a reference, one a tick.
///
/// ```
/// use heapless::Vec;
/// use shakedown_core::link::{HostRequest, MAX_FRAME, MAX_POINTS, Points, encode};
///
/// // As many points as there may be fit into one frame.
/// let points = Vec::from_slice(&[0.001; MAX_POINTS]).unwrap();
/// let request = HostRequest::Reference(Points { first: 0, points, last: true });
/// assert!(encode(&request, &mut [0; MAX_FRAME]).is_ok());
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Points {
    /// Index of the first of them, counted from the start of the record.
    pub first: u32,
    /// Displacement, m.
    pub points: Vec<f32, MAX_POINTS>,
    /// The record ends with the last of them.
    pub last: bool,
}
