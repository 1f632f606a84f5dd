//! Examiner 2: servo-hydraulic tables as laboratories have them. A plant is put together from laws, one a file, each at its
//! place between controller and sensor; an experiment is drawn with the imperfections of its set-up; the sealed answer says
//! what was put in, where it acts, how visible it is, and what was misstated.

pub mod answer;
mod balance;
mod case;
pub mod choose;
pub mod closure;
pub mod corrupt;
pub mod engine;
mod flaw;
pub mod forms;
pub mod law;
pub mod measure;
pub mod plan;
pub mod plant;
mod region;
#[cfg(test)]
mod rest;
pub mod scene;
pub mod setup;
pub mod sheet;
pub mod stated;
#[cfg(test)]
mod testing;
mod tied;
pub mod ties;
pub mod unlisted;

pub use case::{Case, DEVELOPMENT, case, cases, locked};
