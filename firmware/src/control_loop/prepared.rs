//! A setup worked out beside the tick, for the loop to exchange in it.

use shakedown_core::link::Setup;
use shakedown_core::{SettingsError, Tuning};

use shakedown_rehearsal::Behind;

use crate::output::ZeroFlow;

/// Everything that a tick needs of a [`Setup`], and nothing left to work out.
#[derive(Debug, Clone, Copy)]
pub struct Prepared {
    pub(super) tuning: Tuning,
    /// With the wires.
    pub(super) zero_flow: ZeroFlow,
    /// Control rate, Hz.
    pub(super) rate: f32,
    /// A record of telemetry every so many ticks.
    pub(super) every: u16,
    /// What a rehearsal's table is wired to.
    pub(super) behind: Behind,
}

impl Prepared {
    /// Works out `setup`, or says which of its settings does not hold. Takes longer than a tick.
    // Into its caller, which puts it where it stays: a frame of its own would hold another copy.
    #[inline(always)]
    pub fn new(setup: &Setup) -> Result<Self, SettingsError> {
        Ok(Self {
            tuning: Tuning::new(&setup.control)?,
            zero_flow: ZeroFlow::new(setup),
            rate: setup.control.rate,
            every: setup.telemetry_every,
            behind: Behind::of(&setup.control),
        })
    }
}
