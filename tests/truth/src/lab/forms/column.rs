//! Oil between valve and piston.

mod stiff;

pub use stiff::Stiff;
