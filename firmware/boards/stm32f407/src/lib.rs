//! The board: an STM32F407. All register access is in this folder, and so is all `unsafe`.
//!
//! | pin | is |
//! |---|---|
//! | PA0 to PA3 | inputs: reference, LVDT, accelerometer, the existing controller's command; or see [`outboard`] |
//! | PA4 | output |
//! | PB0 | relay of the hydraulic block: high closes it |
//! | PB1 | emergency stop: a closed contact to ground; open is stop |
//! | PD8, PD9 | link, 1 Mbit/s, 8N1 |
#![no_std]
#![cfg(target_os = "none")]
#![allow(unsafe_code, reason = "register access")]

pub mod chip;
pub mod clock;
pub mod entropy;
pub mod failure;
pub mod flash;
pub mod line;
pub mod on_chip;
pub mod options;
pub mod outboard;
pub mod pair;
pub mod pins;
pub mod start;
pub mod ticker;
pub mod watchdog;
