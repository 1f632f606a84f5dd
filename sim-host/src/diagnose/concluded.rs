//! What came of a pass through the data.

use super::term::Modelled;
use super::verdict::Conclusion;
use crate::identify::prepare::Prepared;

/// Share of what was left below which a second look at the data is the better one.
pub(super) const FAR_LESS: f64 = 0.3;

/// What came out, and of which cut of the data.
pub(super) struct Concluded {
    pub(super) whole: Prepared,
    pub(super) conclusion: Conclusion,
    pub(super) modelled: Option<Modelled>,
    pub(super) held_out_shared: bool,
}
