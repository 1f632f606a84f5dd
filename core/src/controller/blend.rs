//! What is left of the output before a change of settings.

/// The output's jump at the change, and how much of it is still applied; the default is none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Blend {
    /// m.
    offset: f32,
    /// 1 to 0.
    weight: f32,
    /// Whether the jump is yet to be met.
    pub(super) pending: bool,
}

impl Blend {
    /// One tick: the flow command `asked` for (m), with what is left of the one `before` the change (m); `step` is the share
    /// that is let go in a tick, along the smooth step 3 w^2 - 2 w^3.
    pub(super) fn step(&mut self, asked: f32, before: f32, step: f32) -> f32 {
        if self.pending {
            *self = Self { offset: before - asked, weight: 1.0, pending: false };
        }
        let w = self.weight;
        let next = w - step;
        self.weight = if next > 0.0 { next } else { 0.0 };
        if w > 0.0 { asked + self.offset * (w * w * (3.0 - 2.0 * w)) } else { asked }
    }
}
