//! Filters: one recurrence a file, coefficients worked out once.

pub mod differentiator;
pub mod lag;
pub mod observer;
pub mod second_order;
pub mod washout;

pub use differentiator::Differentiator;
pub use lag::Lag;
pub use observer::{MotionObserver, MotionState};
pub use second_order::SecondOrder;
pub use washout::Washout;
