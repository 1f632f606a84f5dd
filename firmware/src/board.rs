//! The board: an STM32F407 with its own converters. All register access is here, and so is all `unsafe`.
//!
//! | pin | is |
//! |---|---|
//! | PA0 to PA3 | inputs: reference, LVDT, accelerometer, the existing controller's command |
//! | PA4 | output |
//! | PB0 | relay of the hydraulic block: high closes it |
//! | PB1 | emergency stop: a closed contact to ground; open is stop |
//! | PD8, PD9 | link, 1 Mbit/s, 8N1 |
#![allow(unsafe_code, reason = "register access")]

pub(crate) mod clock;
pub(crate) mod converters;
pub(crate) mod entropy;
pub(crate) mod failure;
pub(crate) mod flash;
pub(crate) mod line;
pub(crate) mod pins;
pub(crate) mod standing;
pub(crate) mod ticker;
pub(crate) mod watchdog;
