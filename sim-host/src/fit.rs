//! Ground motions, and what is left of them within a table's limits.
//!
//! ```
//! use shakedown::fit::{Limits, Method, Recipe, generate::NEAR_FIELD_STRONG, modify};
//!
//! let motion = Recipe::table1(200.0).apply(&NEAR_FIELD_STRONG.generate(1)?)?;
//! let limits = Limits::velocity(0.242);
//! assert!(motion.peaks().1 > limits.velocity);
//! let fitted = modify(&motion, &limits, Method::Taut, |_| {})?;
//! assert!(fitted.motion.peaks().1 <= limits.velocity);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use crate::motion::condition::{ConditionError, PeakError, Recipe, Step, peak_acceleration};
pub use crate::motion::fit::answer::{Answer, AnswerError, Compared};
pub use crate::motion::fit::method::{Method, Modified, modify};
pub use crate::motion::fit::named::PREVIEW;
pub use crate::motion::fit::{FitError, Fitted, Limits, Norm, Reference};
pub use crate::motion::write::{WriteError, write};
pub use crate::motion::{AccelerationUnit, Fact, Format, Motion, Record, UnknownUnit, generate, peak, read};
