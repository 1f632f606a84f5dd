//! Arming: what a stray stream of bytes cannot do.
//!
//! A device that is asked to arm gives a challenge it has not given before since its reset; it arms on the one answer
//! to it, within a second, in a frame of its own. A stream of random bytes must hit a frame's 32-bit check sum and then
//! the 64-bit answer: 1 in 2^96 a frame. A recording of an earlier session holds the answer to another challenge.

use serde::{Deserialize, Serialize};

/// What a device asks of who wants to arm it.
///
/// ```
/// use shakedown_core::link::{Challenge, HostRequest, answer};
///
/// // The device has answered a request for arming with this challenge.
/// let challenge = Challenge(7);
/// let arm = HostRequest::Arm(answer(challenge));
/// assert_ne!(arm, HostRequest::Arm(answer(Challenge(8))));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Challenge(pub u64);

/// The one answer to a challenge. This keeps accidents out, not attackers: the function is public.
pub const fn answer(challenge: Challenge) -> u64 {
    // splitmix64 (Steele, Lea, Flood 2014): every output bit depends on every input bit.
    let mut z = challenge.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
