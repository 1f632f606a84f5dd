//! What the core's laws are held against.

#[cfg(feature = "c")]
pub(crate) mod c;
pub(crate) mod idsp;
