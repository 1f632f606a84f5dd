//! What happens to LVDT and accelerometer.

use super::super::Channel::{Acceleration, Displacement};
use super::super::Promise::{self, Aided, Harmless, Inside, Reported};
use super::super::{Channel, Class, Clock};
use super::{bit, flicker, gain, hum, returning, second, signal, spikes};
use crate::faults::spoil::SignalFault;

/// An LVDT that creeps passes for no gain: it goes one way.
const CREEPS: Promise = Promise::Roomy { as_gain: false };

/// Lengths in m, accelerations in m/s2.
pub(super) const SENSORS: &[Class] = &[
    Class::new("lvdt-open", "LVDT: no number", Reported(Clock::Onset, 0.013), |_| {
        signal(Displacement, SignalFault::Open)
    }),
    Class::new("lvdt-saturated", "LVDT: at a rail of its converter", Reported(Clock::Onset, 0.013), |d| {
        signal(Displacement, SignalFault::Rail(0.1524 * 1.1 * d.sign()))
    }),
    Class::new("lvdt-clipped", "LVDT: held within 5 to 60 mm of the middle", Harmless(0.04), |d| {
        signal(Displacement, SignalFault::Clipped(d.uniform(0.005, 0.06)))
    }),
    Class::new("lvdt-stuck", "LVDT: stands where it stood, to the last bit", Harmless(0.04), |_| {
        signal(Displacement, SignalFault::Stuck)
    }),
    Class::new("lvdt-detached", "LVDT: stands where it stood, with noise of 0.01 to 0.2 mm", Harmless(0.05), |d| {
        signal(Displacement, SignalFault::Detached(d.scale(1e-5, 2e-4)))
    }),
    Class::new("lvdt-noisy", "LVDT: white noise of 0.1 to 30 mm", Reported(Clock::Deviation(0.02), 0.1), |d| {
        signal(Displacement, SignalFault::Noisy(d.scale(1e-4, 0.03)))
    }),
    Class::new("lvdt-drifting", "LVDT: moves away at 0.15 to 1 m/s", Reported(Clock::Displacement(0.005), 0.5), |d| {
        signal(Displacement, SignalFault::Drifting(d.sign() * d.scale(0.15, 1.0)))
    }),
    Class::new("lvdt-sliding", "LVDT: moves away at 20 to 150 mm/s", CREEPS, |d| {
        signal(Displacement, SignalFault::Drifting(d.sign() * d.scale(0.02, 0.15)))
    }),
    Class::new("lvdt-creeping", "LVDT: moves away at 0.5 to 20 mm/s", Aided, |d| {
        signal(Displacement, SignalFault::Drifting(d.sign() * d.scale(5e-4, 0.02)))
    }),
    Class::new(
        "lvdt-returning",
        "LVDT: moves away by 10 to 60 mm at 20 to 150 mm/s, and part of the way back",
        CREEPS,
        |d| signal(Displacement, returning(d)),
    ),
    Class::new("lvdt-spikes", "LVDT: spikes of 1 to 200 mm, 1 to 20 ms", Harmless(0.03), |d| {
        signal(Displacement, spikes(d, 1e-3, 0.2))
    }),
    Class::new("lvdt-gap", "LVDT: no number for 1 to 9 ms", Harmless(0.02), |d| {
        signal(Displacement, SignalFault::Gap(1 + d.below(9) as u32))
    }),
    Class::new("lvdt-flicker", "LVDT: a loose contact, no number for 1 to 30 ms every 5 to 100 ms", Inside, |d| {
        signal(Displacement, flicker(d))
    }),
    Class::new("lvdt-short", "LVDT: a short, reads the middle with noise of 0.01 to 0.1 mm", Harmless(0.04), |d| {
        signal(Displacement, SignalFault::Short(d.scale(1e-5, 1e-4)))
    }),
    Class::new("lvdt-hum", "LVDT: hum of 45 to 420 Hz, 0.1 to 20 mm", Harmless(0.04), |d| {
        signal(Displacement, hum(d, 1e-4, 0.02))
    }),
    Class::new("lvdt-bit", "LVDT: one bit of its converter stands", Harmless(0.04), |d| {
        signal(Displacement, bit(d, 0.1676))
    }),
    Class::new("lvdt-reversed", "LVDT: polarity turned", Harmless(0.06), |_| {
        signal(Displacement, SignalFault::Reversed)
    }),
    Class::new(
        "lvdt-gain",
        "LVDT: its gain goes to 0.5 to 1.5 of itself over 1 to 20 s",
        Promise::Roomy { as_gain: true },
        |d| signal(Displacement, gain(d)),
    ),
    Class::new("second-lvdt", "second displacement sensor: any of the above", Harmless(0.02), |d| {
        signal(Channel::Second, second(d))
    }),
    Class::new("accelerometer-open", "accelerometer: no number", Reported(Clock::Onset, 0.013), |_| {
        signal(Acceleration, SignalFault::Open)
    }),
    Class::new(
        "accelerometer-saturated",
        "accelerometer: at a rail of its converter",
        Reported(Clock::Onset, 0.013),
        |d| signal(Acceleration, SignalFault::Rail(61.0 * d.sign())),
    ),
    Class::new("accelerometer-stuck", "accelerometer: stands where it stood", Harmless(0.05), |_| {
        signal(Acceleration, SignalFault::Stuck)
    }),
    Class::new("accelerometer-off", "accelerometer: off by 3.5 to 20 m/s2", Reported(Clock::Onset, 0.1), |d| {
        signal(Acceleration, SignalFault::Offset(d.sign() * d.scale(3.5, 20.0)))
    }),
    Class::new("accelerometer-noisy", "accelerometer: white noise of 0.5 to 30 m/s2", Harmless(0.05), |d| {
        signal(Acceleration, SignalFault::Noisy(d.scale(0.5, 30.0)))
    }),
    Class::new(
        "accelerometer-drifting",
        "accelerometer: moves away at 0.1 to 30 m/s3",
        Reported(Clock::Acceleration(3.5), 0.3),
        |d| signal(Acceleration, SignalFault::Drifting(d.sign() * d.scale(0.1, 30.0))),
    ),
    Class::new("accelerometer-spikes", "accelerometer: spikes of 1 to 100 m/s2, 1 to 20 ms", Harmless(0.05), |d| {
        signal(Acceleration, spikes(d, 1.0, 100.0))
    }),
    Class::new(
        "accelerometer-flicker",
        "accelerometer: a loose contact, no number for 1 to 30 ms every 5 to 100 ms",
        Inside,
        |d| signal(Acceleration, flicker(d)),
    ),
    Class::new(
        "accelerometer-short",
        "accelerometer: a short, reads zero with noise of 0.01 to 0.1 m/s2",
        Harmless(0.05),
        |d| signal(Acceleration, SignalFault::Short(d.scale(0.01, 0.1))),
    ),
    Class::new("accelerometer-hum", "accelerometer: hum of 45 to 420 Hz, 0.1 to 30 m/s2", Harmless(0.05), |d| {
        signal(Acceleration, hum(d, 0.1, 30.0))
    }),
    Class::new("accelerometer-bit", "accelerometer: one bit of its converter stands", Harmless(0.05), |d| {
        signal(Acceleration, bit(d, 61.0))
    }),
    Class::new(
        "accelerometer-gain",
        "accelerometer: its gain goes to 0 to 3 of itself over 0.1 to 20 s",
        Harmless(0.05),
        |d| signal(Acceleration, SignalFault::Gain { left: d.uniform(0.0, 3.0), over: d.scale(0.1, 20.0) }),
    ),
    Class::new("accelerometer-reversed", "accelerometer: polarity turned", Harmless(0.05), |_| {
        signal(Acceleration, SignalFault::Reversed)
    }),
];
