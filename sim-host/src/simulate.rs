//! Tests on a simulated table: the control core, the plant's clock and a motion.
//!
//! ```
//! use shakedown::fit::{Recipe, generate::FAR_FIELD};
//! use shakedown::simulate::{Named, ScoredSignal, Setup};
//!
//! let motion = Recipe::table1(1000.0).apply(&FAR_FIELD.generate(1)?)?;
//! let trial = Setup::paper(Named::Current).play(&motion)?;
//! let scores = trial.scores(ScoredSignal::Truly, None)?;
//! // E_a = ||a_table - a_ref|| / ||a_ref|| after the best time shift (Eq. 11); this motion stays below the velocity limit.
//! assert!(scores.against_wanted.e_a.ratio < 1.0 && scores.saturated_s == 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use crate::closed_loop::published::{Event, Figures, Named, PublishedGains};
pub use crate::closed_loop::scenario::{Scenario, ScenarioError};
pub use crate::closed_loop::trial::{ScoredSignal, Scores, Setup, Trial, TrialError};
pub use crate::closed_loop::twin::{Twin, TwinError};
pub use crate::closed_loop::{
    Actuation, Clock, ClockError, ClosedLoopError, ControlLaw, Flags, Measured, PlainPi, Trace, run,
};
pub use crate::plant::Plant;
pub use crate::plant::sensors::{SensorModel, Sensors};
