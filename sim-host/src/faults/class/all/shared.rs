//! What happens to the one LVDT that the device and a loop behind it read.

use super::super::Promise::{Aided, Inside, Reported};
use super::super::{Class, Clock, Fault};
use super::{flicker, gain};
use crate::faults::spoil::SignalFault;

/// Lengths in m, accelerations in m/s2.
pub(super) const SHARED: &[Class] = &[
    Class::new(
        "shared-lvdt-open",
        "an LVDT shared with the loop behind the device: no number, a rail for the loop",
        Reported(Clock::Onset, 0.013),
        |_| Fault::Shared(SignalFault::Open),
    ),
    Class::new(
        "shared-lvdt-stuck",
        "an LVDT shared with the loop behind the device: stands where it stood, to the last bit",
        Aided,
        |_| Fault::Shared(SignalFault::Stuck),
    ),
    Class::new(
        "shared-lvdt-detached",
        "an LVDT shared with the loop behind the device: stands where it stood, with noise of 0.01 to 0.2 mm",
        Aided,
        |d| Fault::Shared(SignalFault::Detached(d.scale(1e-5, 2e-4))),
    ),
    Class::new(
        "shared-lvdt-clipped",
        "an LVDT shared with the loop behind the device: held within 5 to 60 mm of the middle",
        Aided,
        |d| Fault::Shared(SignalFault::Clipped(d.uniform(0.005, 0.06))),
    ),
    Class::new(
        "shared-lvdt-short",
        "an LVDT shared with the loop behind the device: a short, reads the middle",
        Aided,
        |d| Fault::Shared(SignalFault::Short(d.scale(1e-5, 1e-4))),
    ),
    Class::new(
        "shared-lvdt-flicker",
        "an LVDT shared with the loop behind the device: a loose contact, no number for 1 to 30 ms every 5 to 100 ms",
        Inside,
        |d| Fault::Shared(flicker(d)),
    ),
    Class::new(
        "shared-lvdt-reversed",
        "an LVDT shared with the loop behind the device: polarity turned",
        Inside,
        |_| Fault::Shared(SignalFault::Reversed),
    ),
    Class::new(
        "shared-lvdt-drifting",
        "an LVDT shared with the loop behind the device: moves away at 0.15 to 1 m/s",
        Inside,
        |d| Fault::Shared(SignalFault::Drifting(d.sign() * d.scale(0.15, 1.0))),
    ),
    Class::new(
        "shared-lvdt-creeping",
        "an LVDT shared with the loop behind the device: moves away at 0.5 to 150 mm/s",
        Aided,
        |d| Fault::Shared(SignalFault::Drifting(d.sign() * d.scale(5e-4, 0.15))),
    ),
    Class::new(
        "shared-lvdt-gain",
        "an LVDT shared with the loop behind the device: its gain goes to 0.5 to 1.5 of itself over 1 to 20 s",
        Aided,
        |d| Fault::Shared(gain(d)),
    ),
];
