//! Filters: one recurrence a file, coefficients worked out once.

pub(crate) mod differentiator;
pub(crate) mod lag;
pub(crate) mod observer;
pub(crate) mod second_order;
pub(crate) mod washout;

pub(crate) use differentiator::Differentiator;
pub(crate) use lag::Lag;
pub(crate) use observer::{MotionObserver, MotionState};
pub(crate) use second_order::SecondOrder;
pub(crate) use washout::Washout;
