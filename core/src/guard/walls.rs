//! Walls at the edge: nothing that is not a believable number goes any farther.
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walls {
    ranges: Within,
    follows_external: bool,
    accelerometer: bool,
    /// Of the channels that few tables have, those that are read.
    rare: Channels,
}

impl Walls {
    /// Walls that nothing is behind: no range for any reading.
    pub(crate) fn shut() -> Self {
        let none = Ranges {
            reference: 0.0,
            displacement: 0.0,
            velocity: 0.0,
            acceleration: 0.0,
            external: 0.0,
            pressure_difference: 0.0,
        };
        Self { ranges: Within::new(&none), follows_external: false, accelerometer: false, rare: Channels::NONE }
    }

    /// The channels and ranges of `settings`.
    pub fn new(settings: &Settings) -> Self {
        let rare = [
            (settings.velocity_source == VelocitySource::Sensor, Channels::VELOCITY),
            (settings.reads_pressure(), Channels::PRESSURE_DIFFERENCE),
            (settings.reference_rates == ReferenceRates::Supplied, Channels::REFERENCE_RATES),
            (settings.reads_second_displacement(), Channels::SECOND_DISPLACEMENT),
        ];
        Self {
            ranges: Within::new(&settings.ranges),
            follows_external: settings.mode == Mode::Guard,
            accelerometer: settings.observer.accelerometer,
            rare: rare.iter().fold(Channels::NONE, |all, &(read, channel)| if read { all.and(channel) } else { all }),
        }
    }

    /// Whether the existing controller's command, the LVDT and the accelerometer are all that is read.
    pub(crate) fn three(&self) -> bool {
        self.follows_external && self.accelerometer && self.rare.is_empty()
    }

    /// Whether these three are all believable.
    #[inline(always)]
    pub(crate) fn admit_three(&self, sample: &Sample) -> bool {
        let (r, s) = (&self.ranges, sample);
        r.external.holds(s.external) && r.displacement.holds(s.displacement) && r.acceleration.holds(s.acceleration)
    }

    /// Takes what is believable of `sample` over into `readings`; gives the needed channels that were not.
    #[inline]
    pub fn take(&self, sample: &Sample, readings: &mut Sample) -> Channels {
        let (r, s) = (&self.ranges, sample);
        let mut missing = Channels::NONE;
        let mut take = |channel, value: f32, range: Magnitude, reading: &mut f32| {
            if range.holds(value) {
                *reading = value;
            } else {
                missing = missing.and(channel);
            }
        };
        if self.follows_external {
            take(Channels::EXTERNAL, s.external, r.external, &mut readings.external);
        } else {
            take(Channels::REFERENCE, s.reference, r.reference, &mut readings.reference);
        }
        take(Channels::DISPLACEMENT, s.displacement, r.displacement, &mut readings.displacement);
        if self.accelerometer {
            take(Channels::ACCELERATION, s.acceleration, r.acceleration, &mut readings.acceleration);
        }
        (readings.limit_switch, readings.relay_closed) = (s.limit_switch, s.relay_closed);
        if self.rare.is_empty() {
            return missing;
        }
        missing.and(self.take_rare(s, readings))
    }

    #[inline(never)]
    fn take_rare(&self, s: &Sample, readings: &mut Sample) -> Channels {
        let r = &self.ranges;
        let mut missing = Channels::NONE;
        let mut take = |channel, value: f32, range: Magnitude, reading: &mut f32| {
            if self.rare.any(channel) {
                if range.holds(value) {
                    *reading = value;
                } else {
                    missing = missing.and(channel);
                }
            }
        };
        take(Channels::VELOCITY, s.velocity, r.velocity, &mut readings.velocity);
        let pressure = &mut readings.pressure_difference;
        take(Channels::PRESSURE_DIFFERENCE, s.pressure_difference, r.pressure_difference, pressure);
        take(Channels::REFERENCE_RATES, s.reference_velocity, r.velocity, &mut readings.reference_velocity);
        let acceleration = &mut readings.reference_acceleration;
        take(Channels::REFERENCE_RATES, s.reference_acceleration, r.acceleration, acceleration);
        let second = &mut readings.second_displacement;
        take(Channels::SECOND_DISPLACEMENT, s.second_displacement, r.displacement, second);
        missing
    }
}
