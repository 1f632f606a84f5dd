//! What a board can do, which no setup may ask beyond.

use shakedown_core::link::{RefusedBecause, Setup};

/// A board's bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Largest code of the converters fitted.
    pub full_scale: u16,
    /// Highest control rate that the board keeps up with, Hz.
    pub highest_rate: u32,
}

impl Limits {
    /// Whether a board of these takes `setup`: one that holds, for its converters, at a rate that it keeps up with. Whatever may
    /// become the setup in force comes by here, from the link or out of flash.
    pub fn check(&self, setup: &Setup) -> Result<(), RefusedBecause> {
        if setup.validate().is_err() || setup.wiring.full_scale != self.full_scale {
            return Err(RefusedBecause::Setup);
        }
        // A setup that holds has a rate of 50 Hz and more.
        if setup.control.rate > self.highest_rate as f32 {
            return Err(RefusedBecause::RateAbove(self.highest_rate));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defaults;

    #[test]
    fn a_rate_is_taken_up_to_the_boards_own() {
        let taken = |rate| {
            let mut setup = defaults::setup();
            setup.control.rate = rate;
            assert!(setup.validate().is_ok(), "the core itself takes {rate} Hz");
            defaults::LIMITS.check(&setup)
        };
        let highest = defaults::LIMITS.highest_rate;
        assert_eq!(taken(highest as f32), Ok(()));
        assert_eq!(taken(1000.0), Ok(()));
        assert_eq!(taken(highest as f32 + 1.0), Err(RefusedBecause::RateAbove(highest)));
        assert_eq!(taken(20_000.0), Err(RefusedBecause::RateAbove(highest)));
    }
}
