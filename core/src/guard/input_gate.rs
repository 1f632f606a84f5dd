//! InputGate at the edge: nothing that is not a believable number goes any farther.
//!
//! A reading passes when it is a number within its range; otherwise the last one that passed is kept, channel by
//! channel, and the channel is reported missing. Channels that the settings do not use are not looked at.

use crate::math::Magnitude;
use crate::sample::{Channels, Sample};
use crate::settings::{Mode, Ranges, ReferenceRates, Settings, VelocitySource};

/// What the channels may say.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Within {
    external: Magnitude,
    reference: Magnitude,
    displacement: Magnitude,
    acceleration: Magnitude,
    velocity: Magnitude,
    pressure_difference: Magnitude,
}

impl Within {
    fn new(ranges: &Ranges) -> Self {
        Self {
            external: Magnitude::new(ranges.external),
            reference: Magnitude::new(ranges.reference),
            displacement: Magnitude::new(ranges.displacement),
            acceleration: Magnitude::new(ranges.acceleration),
            velocity: Magnitude::new(ranges.velocity),
            pressure_difference: Magnitude::new(ranges.pressure_difference),
        }
    }
}

/// Which channels are read, and what they may say.
///
/// ```
/// use shakedown_core::blocks::guard::InputGate;
/// use shakedown_core::{Channels, Sample, Settings};
///
/// let gate = InputGate::new(&Settings::default());
/// let mut readings = Sample::default();
/// let missing = gate.take(&Sample::new(0.01, f32::NAN, 0.0), &mut readings);
/// assert_eq!(missing, Channels::DISPLACEMENT);
/// assert_eq!((readings.reference, readings.displacement), (0.01, 0.0)); // the last believable ones
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputGate {
    ranges: Within,
    read: Channels,
}

impl InputGate {
    /// A gate that reads no channel, of a device without settings.
    pub(crate) fn shut() -> Self {
        Self { ranges: Within::new(&Ranges::default()), read: Channels::NONE }
    }

    /// The channels and ranges of `settings`.
    pub fn new(settings: &Settings) -> Self {
        let guards = settings.mode == Mode::Guard;
        let channels = [
            (guards, Channels::EXTERNAL),
            (!guards, Channels::REFERENCE),
            (true, Channels::DISPLACEMENT),
            (settings.observer.accelerometer, Channels::ACCELERATION),
            (settings.velocity_source == VelocitySource::Sensor, Channels::VELOCITY),
            (settings.reads_pressure(), Channels::PRESSURE_DIFFERENCE),
            (settings.reference_rates == ReferenceRates::Supplied, Channels::REFERENCE_RATES),
            (settings.reads_second_displacement(), Channels::SECOND_DISPLACEMENT),
        ];
        let read =
            channels.iter().fold(Channels::NONE, |all, &(read, channel)| if read { all.union(channel) } else { all });
        Self { ranges: Within::new(&settings.ranges), read }
    }

    /// Whether a `reference` (m) is believable.
    pub(crate) fn believes(&self, reference: f32) -> bool {
        self.ranges.reference.holds(reference)
    }

    /// Takes what is believable of `sample` over into `readings`; gives the needed channels that were not.
    pub fn take(&self, sample: &Sample, readings: &mut Sample) -> Channels {
        let (r, s, to) = (&self.ranges, sample, &mut *readings);
        (to.limit_switch, to.relay_closed) = (s.limit_switch, s.relay_closed);
        let mut missing = Channels::NONE;
        let mut take = |channel, value: f32, range: Magnitude, reading: &mut f32| {
            if self.read.intersects(channel) {
                if range.holds(value) {
                    *reading = value;
                } else {
                    missing = missing.union(channel);
                }
            }
        };
        take(Channels::REFERENCE, s.reference, r.reference, &mut to.reference);
        take(Channels::EXTERNAL, s.external, r.external, &mut to.external);
        take(Channels::DISPLACEMENT, s.displacement, r.displacement, &mut to.displacement);
        take(Channels::ACCELERATION, s.acceleration, r.acceleration, &mut to.acceleration);
        take(Channels::VELOCITY, s.velocity, r.velocity, &mut to.velocity);
        take(Channels::PRESSURE_DIFFERENCE, s.pressure_difference, r.pressure_difference, &mut to.pressure_difference);
        take(Channels::REFERENCE_RATES, s.reference_velocity, r.velocity, &mut to.reference_velocity);
        take(Channels::REFERENCE_RATES, s.reference_acceleration, r.acceleration, &mut to.reference_acceleration);
        take(Channels::SECOND_DISPLACEMENT, s.second_displacement, r.displacement, &mut to.second_displacement);
        missing
    }
}
