//! From recordings to a model with error bars.
//!
//! [`data`] holds runs as a fit sees them, [`model`] a model with the effects it has, [`evaluate`] the residuals and
//! their sensitivities to every free parameter, [`fit`] bounded Levenberg-Marquardt on them, [`judge`] scores the outcome on runs held back; [`frequency`] estimates
//! frequency responses and fits transfer functions to them.

pub mod data;
pub mod evaluate;
pub mod fit;
pub mod frequency;
pub mod judge;
pub mod model;
mod normal;
pub mod prepare;
pub mod quantity;
pub mod stated;
