//! From recordings to a model with error bars.
//!
//! [`data`] holds runs as a fit sees them, [`model`] a model with the effects it has, [`evaluate`] the residuals and
//! their sensitivities to every free parameter, [`fit`] bounded Levenberg-Marquardt on them, [`starts`] from several
//! places, [`interval`] how far each parameter can be moved; [`judge`] scores the outcome on hold-out runs; [`spectra`]
//! compares both sides by frequency; [`frequency`] estimates frequency responses and fits transfer functions to them; [`transfer`]
//! does so from command to motion, its order chosen by what was held out.

pub mod answer;
pub mod change;
mod covariance;
pub mod data;
pub mod evaluate;
pub mod fit;
mod floor;
pub mod frequency;
pub mod interval;
pub mod judge;
pub mod model;
mod normal;
pub mod outcome;
pub mod prepare;
pub mod quantity;
mod shift;
pub mod spectra;
pub mod starts;
pub mod stated;
pub mod transfer;
pub mod yardsticks;
