//! Whether a table that is told to move stands still by its LVDT: a valve that is shut, or an LVDT that stands while the table moves
//! evenly, of which the accelerometer sees nothing.
//!
//! ```text
//! s[k] = s[k-1] + dt w - (dt / 5 memory) s[k-1]     while the LVDT stays within mismatch / 20 of where it stood, else 0
//! |s| > mismatch / 2: it does not move
//! ```
//! w is the speed that is asked for, m/s: of the valve by its command, or of an existing controller by its error, at the gain of a
//! slow loop. An even speed below a tenth of mismatch / memory is not seen, so that an unknown null does not trip a table at rest.

use crate::math::Magnitude;

/// The monitor's configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StillMonitor {
    dt: f32,
    /// What is kept from turn to turn, 1.
    keep: f32,
    band: Magnitude,
    limit: Magnitude,
}

/// Where the LVDT has stood since it last moved, m, and what it was told to move since, m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct StillState {
    stood: f32,
    told: f32,
}

impl StillMonitor {
    /// A monitor that allows for `mismatch` (m), forgotten over `memory` (s), at turns of `dt` (s).
    pub(crate) fn new(mismatch: f32, memory: f32, dt: f32) -> Self {
        let keep = 1.0 - (0.2 * dt / memory).min(1.0);
        Self { dt, keep, band: Magnitude::new(0.05 * mismatch), limit: Magnitude::new(0.5 * mismatch) }
    }

    /// One turn: speed asked for (m/s) and displacement (m). True: it does not move.
    #[inline(always)]
    pub(crate) fn advance(&self, state: &mut StillState, asked: f32, displacement: f32) -> bool {
        if self.band.holds(displacement - state.stood) {
            state.told = self.keep * state.told + self.dt * asked;
        } else {
            *state = StillState { stood: displacement, told: 0.0 };
        }
        !self.limit.holds(state.told)
    }
}
