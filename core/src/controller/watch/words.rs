//! What the monitors are told, and what they say.

use crate::guard::Trip;

/// What a monitor has to say after its turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Word {
    /// Nothing, which is nearly always.
    Nothing,
    /// Something is unusual, and why the guard should trip, if it should.
    Unusual(Option<Trip>),
}

/// What pushes the table, as the monitors see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drive {
    /// Reference after modification, m.
    pub(crate) reference: f32,
    /// Its velocity, m/s.
    pub(crate) reference_velocity: f32,
    /// Command beyond zero flow, m.
    pub(crate) excess: f32,
}
