//! What is left of the output before a change of settings.

/// The output's jump at the change, and how much of it is still held back.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Blend {
    /// m.
    pub(super) offset: f32,
    /// 1 to 0.
    pub(super) weight: f32,
    /// Whether the jump is yet to be seen.
    pub(super) pending: bool,
}
