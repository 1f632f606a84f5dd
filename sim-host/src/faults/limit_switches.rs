//! Where limit switches belong: what is left where an LVDT drifts so slowly that nothing else the device reads contradicts it.
//!
//! ```text
//! stroke - margin - d(velocity_limit),   d(v) = v latency + v^2 / (2 deceleration)         m from the middle, either side
//! ```
//! They open the emergency-stop circuit. A table at full speed, whose LVDT may say anything, then stops where the guard's
//! margin begins, by the guard's own estimate of the distance; what is between that and what it really needs is for the
//! switch's own delay.

use shakedown_core::Settings;
use shakedown_core::blocks::guard::Envelope;

/// The farthest from the middle that they may stand, m; none without a guard, or where full speed needs the whole stroke.
pub fn limit_switches(settings: &Settings) -> Option<f64> {
    let guard = settings.guard?.envelope;
    let envelope = Envelope::new(&guard, settings.stroke, 1.0 / settings.rate).ok()?;
    let from = settings.stroke - guard.margin - envelope.stopping_distance(settings.velocity_limit);
    (from > 0.0).then_some(f64::from(from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use shakedown_core::settings::{EnvelopeSettings, GuardSettings};

    #[test]
    fn the_papers_table_needs_18_mm_to_stop() {
        let settings = Settings { guard: Some(GuardSettings::default()), ..Settings::default() };
        // 0.242 x 0.05 + 0.242^2 / 10 = 0.017956 m, from 0.12 less 0.005.
        let wanted = f64::from(settings.stroke) - 0.005 - 0.017_956_4;
        assert!((limit_switches(&settings).unwrap() - wanted).abs() < 1e-7);
    }

    #[test]
    fn there_is_no_place_for_them_where_there_is_no_room() {
        assert_eq!(limit_switches(&Settings { guard: None, ..Settings::default() }), None);
        let envelope = EnvelopeSettings { stopping_latency: 1.0, ..EnvelopeSettings::default() };
        let guard = Some(GuardSettings { envelope, ..GuardSettings::default() });
        assert_eq!(limit_switches(&Settings { guard, ..Settings::default() }), None);
    }
}
