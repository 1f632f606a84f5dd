//! From recordings to a model with error bars.

pub mod frequency;
