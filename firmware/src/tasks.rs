//! What the tasks do.

pub(crate) mod control;
pub(crate) mod link;
pub(crate) mod start;
