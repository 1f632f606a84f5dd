//! What of a table's effects a law can counter, in the terms of the core's tracking law.

use super::entry;

/// Notes an effect's parameters where a law counters them.
pub(crate) type Counter = fn(&[f64], &mut Countered);

/// What a law is told of a table beyond Eq. 7. SI; zeros and none where there is nothing to counter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Countered {
    /// Null bias, m.
    pub null_bias: f64,
    /// Delay of the command, s.
    pub delay: f64,
    /// Half width of the spool's overlap, m.
    pub deadband: f64,
    /// Sharpness of a soft limit, 1; 0 for a hard one.
    pub sharpness: f64,
    /// Velocity limits toward positive and negative displacement, m/s, where they differ from the model's.
    pub limits: Option<(f64, f64)>,
    /// Depth (1) and recovery (s) of the supply's droop.
    pub droop: (f64, f64),
    /// Acceleration at which the flow stalls, m/s2; 0 where no load slows it.
    pub stall: f64,
    /// Frequency (Hz) and damping (1) of the oil column; none where it is stiff.
    pub oil: Option<(f64, f64)>,
    /// Friction that slides, per table mass, m/s2.
    pub coulomb: f64,
    /// What friction has beyond that at standstill: its size there, per table mass (m/s2), and the speed over which it falls
    /// (m/s). The law counters the sliding part alone.
    pub peak: Option<(f64, f64)>,
    /// Viscous friction per table mass, 1/s.
    pub viscous: f64,
}

impl Default for Countered {
    /// Nothing.
    fn default() -> Self {
        Self {
            null_bias: 0.0,
            delay: 0.0,
            deadband: 0.0,
            sharpness: 0.0,
            limits: None,
            droop: (0.0, 1.0),
            stall: 0.0,
            oil: None,
            coulomb: 0.0,
            peak: None,
            viscous: 0.0,
        }
    }
}

impl Countered {
    /// What a law counters of these effects: their identifiers, with their parameters in the order of the entries.
    pub fn of<'a>(effects: impl IntoIterator<Item = (&'a str, &'a [f64])>) -> Self {
        let mut countered = Self::default();
        for (id, parameters) in effects {
            // What acts in a region has parameters more than its entry: a law would counter it where it is not.
            let plain = entry(id).filter(|entry| parameters.len() <= entry.parameters.len());
            if let Some(counter) = plain.and_then(|entry| entry.counter) {
                counter(parameters, &mut countered);
            }
        }
        countered
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::effects::ENTRIES;

    /// An effect that says how a law counters it is countered, however many details its form has.
    #[test]
    fn every_effect_that_can_be_countered_is() {
        for entry in ENTRIES.iter().filter(|entry| entry.counter.is_some()) {
            let starts = entry.parameters.iter().map(|p| p.starts.first().copied().filter(|&start| start != 0.0));
            let parameters: Vec<f64> = starts.map(|start| start.unwrap_or(0.01)).collect();
            assert_ne!(Countered::of([(entry.id, &parameters[..])]), Countered::default(), "{}", entry.id);
        }
    }
}
