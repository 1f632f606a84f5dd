//! The control core of shakedown: every law that decides what a servovalve does.
//!
//! Firmware and simulator both call [`Controller::step`] once a tick; nothing else in the project decides anything
//! about the valve. `no_std`, `f32`, SI units, no allocation, no panic path, and bit for bit the same results on host
//! and target.
#![no_std]
#![forbid(unsafe_code)]

pub mod block;
pub mod control;
pub mod controller;
pub mod filter;
pub mod guard;
pub mod host;
#[cfg(feature = "link")]
pub mod link;
pub mod math;
mod modifier;
pub mod record;
pub mod sample;
pub mod saturation;
pub mod scalar;
pub mod settings;
pub mod units;

pub use controller::{Controller, Tuning};
pub use guard::{Refused, Request, State, Trip};
pub use sample::{Channels, Command, Relay, Sample, Status};
pub use settings::{Mode, Modification, Settings, SettingsError};
