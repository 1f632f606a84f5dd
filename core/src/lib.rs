//! The control core of shakedown: every law that decides what a servovalve does.
//!
//! Firmware and simulator both call [`Controller::step`] once a tick; nothing else in the project decides anything
//! about the valve. `no_std`, `f32`, SI units, no allocation, no panic path, and bit for bit the same results on host
//! and target.
#![no_std]
#![forbid(unsafe_code)]

pub mod controller;
pub mod link;
pub mod math;
pub mod record;
pub mod settings;

pub use controller::{Command, Controller, Sample, Status};
pub use settings::{Settings, SettingsError};
