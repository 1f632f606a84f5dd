//! The fault campaign: random faults at random times over random records, on a table that is not the one the guard was set
//! for, judged by a watcher that shares nothing with the guard.
//!
//! A run is a number under a seed: [`case`] deals it, [`rig`] runs it twice, with its fault and without, [`watcher`] says
//! whether what the hazard table promises of its [`class`] was kept. The tables have the limit switches of
//! docs/commissioning.md ([`limit_switches()`]), or a second displacement sensor, or the guard is alone.

pub mod adversary;
pub mod campaign;
pub mod case;
pub mod class;
pub mod dice;
pub mod feed;
pub mod healthy;
mod limit_switches;
pub mod machine;
pub mod motions;
pub mod rig;
mod settings;
pub mod spoil;
pub mod summary;
pub mod watcher;
mod words;

pub use campaign::{CampaignError, Plan};
pub use case::{Beside, Case};
pub use class::{CLASSES, Class, Clock, Fault, Promise};
pub use limit_switches::limit_switches;
pub use motions::Motions;
pub use summary::Summary;
pub use watcher::Outcome;
