//! The control core of shakedown: every law that decides what a servovalve does.
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

mod block;
pub mod blocks;
mod control;
mod controller;
mod filter;
mod guard;
pub mod host;
#[cfg(feature = "link")]
pub mod link;
mod math;
mod modifier;
mod record;
mod sample;
mod saturation;
mod scalar;
pub mod settings;
pub mod units;

pub use controller::{Controller, Tuning};
pub use guard::{OperatorRequest, Refused, State, Trip};
pub use sample::{Channels, Command, Relay, Sample, Status};
pub use settings::{Mode, Modification, Settings, SettingsError};
