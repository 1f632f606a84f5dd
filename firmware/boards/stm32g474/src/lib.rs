//! The board: an STM32G474, as on a NUCLEO-G474RE. All register access is in this folder, and so is all `unsafe`. Sections are those of
//! the reference manual, RM0440.
//!
//! | pin | is |
//! |---|---|
//! | PA0 to PA3 | inputs: reference, LVDT, accelerometer, the existing controller's command |
//! | PA4 | output |
//! | PB0 | relay of the hydraulic block: high closes it |
//! | PB1 | emergency stop: a closed contact to ground; open is stop |
//! | PC10, PC11 | link, 1 Mbit/s, 8N1 |
//!
//! Memory: the workspace's one map holds here too. RAM is 128 KiB from the same address (SRAM1, SRAM2 and the core-coupled memory's
//! alias); of the flash there are 512 KiB, of which the image takes a fifth, and the settings the last two pages.
#![no_std]
#![cfg(target_os = "none")]
#![allow(unsafe_code, reason = "register access")]

pub mod chip;
pub mod clock;
pub mod converters;
pub mod entropy;
pub mod failure;
pub mod flash;
pub mod line;
pub mod options;
pub mod pins;
pub mod start;
pub mod ticker;
pub mod watchdog;
