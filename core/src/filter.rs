//! Filters: one recurrence a file, coefficients worked out once.

pub mod differentiator;
pub mod fusion;
pub mod lag;
pub mod second_order;
pub mod washout;

pub use differentiator::Differentiator;
pub use fusion::Fusion;
pub use lag::Lag;
pub use second_order::SecondOrder;
pub use washout::Washout;
