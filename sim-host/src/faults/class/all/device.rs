//! What happens to commands, link, settings and time.

use super::super::Channel::Command;
use super::super::Promise::{Harmless, Inside, Reported};
use super::super::{Class, Clock, Fault};
use super::{bit, flicker, hum, signal};
use crate::faults::spoil::SignalFault;

/// Lengths in m, accelerations in m/s2.
pub(super) const DEVICE: &[Class] = &[
    Class::new("command-lost", "reference or existing command: no number", Reported(Clock::Onset, 0.013), |_| {
        signal(Command, SignalFault::Open)
    }),
    Class::new("command-gap", "reference or existing command: no number for 1 to 9 ms", Harmless(0.02), |d| {
        signal(Command, SignalFault::Gap(1 + d.below(9) as u32))
    }),
    Class::new(
        "command-flicker",
        "reference or existing command: a loose contact, no number for 1 to 30 ms every 5 to 100 ms",
        Inside,
        |d| signal(Command, flicker(d)),
    ),
    Class::new("command-jump", "reference or existing command: jumps by 5 mm to 1 m", Inside, |d| {
        signal(Command, SignalFault::Offset(d.sign() * d.scale(0.005, 1.0)))
    }),
    Class::new("command-stuck", "reference or existing command: stands where it stood", Inside, |_| {
        signal(Command, SignalFault::Stuck)
    }),
    Class::new("command-runaway", "reference or existing command: moves away at 10 mm/s to 2 m/s", Inside, |d| {
        signal(Command, SignalFault::Drifting(d.sign() * d.scale(0.01, 2.0)))
    }),
    Class::new("command-short", "reference or existing command: a short, reads zero", Inside, |_| {
        signal(Command, SignalFault::Short(0.0))
    }),
    Class::new("command-hum", "reference or existing command: hum of 45 to 420 Hz, 0.1 to 100 mm", Inside, |d| {
        signal(Command, hum(d, 1e-4, 0.1))
    }),
    Class::new("command-bit", "reference or existing command: one bit of its converter stands", Inside, |d| {
        signal(Command, bit(d, 1.0))
    }),
    Class::new("command-noisy", "reference or existing command: white noise of 0.1 to 100 mm", Inside, |d| {
        signal(Command, SignalFault::Noisy(d.scale(1e-4, 0.1)))
    }),
    Class::new("link-cut", "no point of the stream arrives any more", Reported(Clock::Onset, 1.1), |_| Fault::LinkCut),
    Class::new("link-garbled", "one bit in 10^2 to 10^5 bytes of the stream is flipped", Harmless(1e-9), |d| {
        Fault::LinkGarbled(d.scale(1e-5, 1e-2))
    }),
    Class::new("settings-garbled", "a frame of settings with 1 to 64 bits flipped", Harmless(1e-9), |d| {
        Fault::SettingsGarbled(1 + d.below(64) as u32)
    }),
    Class::new("settings-nonsense", "settings with one number no number, infinite, huge or negative", Inside, |_| {
        Fault::SettingsNonsense
    }),
    Class::new("settings-wrong", "gains off by factors up to 30, null by up to 5 mm", Inside, |d| {
        Fault::SettingsWrong(d.scale(1.5, 30.0))
    }),
    Class::new("jitter", "ticks longer or shorter by up to 1 to 30 %", Inside, |d| Fault::Jitter(d.scale(0.01, 0.3))),
    Class::new("missed-ticks", "no tick for 1 to 20 ms", Reported(Clock::Onset, 0.022), |d| {
        Fault::Missed(1 + d.below(20) as u32)
    }),
];
