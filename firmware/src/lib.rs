//! The parts of the firmware that no register knows of: what happens in a tick, what a request does, how a setup
//! survives a reset. The boards, each a folder of its own in `boards`, supply the rest. They build for the host as well, where their tests run, and where the same [`ControlLoop`] that decides
//! on the target is the reference that the emulated image is held against, bit for bit.
//!
//! Two contexts share the work and no memory:
//!
//! - the **loop** runs in the highest-priority task, once a tick, and owns everything that decides the output;
//! - the **server** runs below it, owns the serial link, and speaks to the loop through queues that neither side
//!   ever waits on: orders and points of the reference down, records of telemetry up.
//!
//! What must not happen with oil behind the valve (a flash erase, another wiring, another rate) takes an [`OpenRelay`], which
//! the loop alone can make and which keeps the relay open while it exists.
#![no_std]

#[cfg(test)]
extern crate std;

pub mod control_loop;
pub mod converters;
pub mod defaults;
#[cfg(feature = "board")]
pub mod failure;
mod input_scaling;
pub mod limits;
pub mod line;
pub mod link_server;
pub mod link_task;
#[cfg(feature = "log")]
mod logged;
pub mod options;
pub mod output;
#[cfg(feature = "board")]
pub mod parts;
pub mod published;
pub mod queues;
pub mod signs_of_life;
pub mod store;
pub mod tick;
pub mod watchdog;

pub use control_loop::{Codes, ControlLoop, Events, Notifications, OpenRelay, Outcome};
pub use link_server::LinkServer;
