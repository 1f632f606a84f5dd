//! What a device demands of its settings beyond each field's own range: limits that can act on this table, and a way to
//! stop that is as long as the envelope says.

use super::{Mode, Settings, SettingsError};
use crate::guard::GuardSettings;
use crate::math::max;

/// Share of the stroke that the table may cover at full speed without being observed, 1.
const BLIND_SHARE: f32 = 0.1;

/// One field against the others.
struct Rule {
    field: &'static str,
    value: f32,
    low: f32,
    high: f32,
    because: &'static str,
    remedy: &'static str,
}

impl Rule {
    fn check(&self) -> Result<(), SettingsError> {
        let &Self { field, value, low, high, because, remedy } = self;
        if value >= low && value <= high {
            return Ok(());
        }
        Err(SettingsError::Conflict { field, value, low, high, because, remedy })
    }
}

impl Settings {
    /// Checks that the fields make a guard that can act, for a device that moves a table: [`Self::validate`], a guard, and
    /// every limit of the guard within what this table can do. A limit at the far end of its own range never trips.
    ///
    /// Simulations take settings that only [`Self::validate`]; [`crate::link::Setup::validate`] asks for this as well.
    pub fn validate_for_device(&self) -> Result<(), SettingsError> {
        self.validate()?;
        let Some(guard) = &self.guard else {
            return Err(SettingsError::Contradiction { field: "guard", with: "a device that moves a table" });
        };
        self.check_ramps(guard)?;
        self.check_stopping(guard)?;
        self.check_envelope(guard)?;
        self.check_sensors(guard)?;
        self.check_valve(guard)
    }

    /// The fade of a test. A reference that stands d from the table is faded in by a smooth step, 1.5 d / test at its steepest.
    fn check_ramps(&self, guard: &GuardSettings) -> Result<(), SettingsError> {
        Rule {
            field: "guard.ramps.test",
            value: guard.ramps.test,
            low: 1.5 * self.blind_time(),
            high: 1000.0,
            because: "a reference a tenth of the stroke away would be faded in faster than velocity_limit",
            remedy: "lengthen it to a second or two",
        }
        .check()
    }

    /// The way to stop. A command that is ramped linearly to zero over `safe`, through a valve of time constant `lag`, moves
    /// the table on by v (safe / 2 + lag); the envelope plans v latency + v^2 / (2 deceleration).
    fn check_stopping(&self, guard: &GuardSettings) -> Result<(), SettingsError> {
        let (e, lag) = (&guard.envelope, self.valve.lag);
        Rule {
            field: "guard.envelope.stopping_latency",
            value: e.stopping_latency,
            low: 0.5 * guard.ramps.safe + lag,
            high: 10.0,
            because: "the table moves on for half of guard.ramps.safe and for valve.lag after a trip",
            remedy: "shorten guard.ramps.safe, or plan for a longer stop",
        }
        .check()?;
        Rule {
            field: "guard.envelope.stopping_deceleration",
            value: e.stopping_deceleration,
            low: 0.0,
            high: if lag > 0.0 { self.velocity_limit / lag } else { f32::INFINITY },
            because: "a valve of valve.lag slows the table from velocity_limit no faster than their ratio",
            remedy: "measure the deceleration at commissioning",
        }
        .check()
    }

    fn check_envelope(&self, guard: &GuardSettings) -> Result<(), SettingsError> {
        let e = &guard.envelope;
        Rule {
            field: "guard.envelope.velocity",
            value: e.velocity,
            low: 0.0,
            high: 2.0 * self.velocity_limit,
            because: "a table of velocity_limit never gets that fast, so the limit cannot trip",
            remedy: "set it a little above velocity_limit",
        }
        .check()?;
        self.check_roughness(guard)?;
        if self.mode != Mode::Guard {
            Rule {
                field: "guard.envelope.tracking",
                value: e.tracking,
                low: 0.0,
                high: 2.0 * self.stroke,
                because: "a table inside its stroke is never farther from its reference, so the limit cannot trip",
                remedy: "set it to a few times the tracking error of a healthy test",
            }
            .check()?;
        }
        Rule {
            field: "guard.envelope.persistence",
            value: e.persistence,
            low: 0.0,
            high: self.blind_time(),
            because: "the table covers more than a tenth of its stroke meanwhile",
            remedy: "shorten it",
        }
        .check()
    }

    /// Acceleration and jerk, which are judged by readings of the accelerometer.
    fn check_roughness(&self, guard: &GuardSettings) -> Result<(), SettingsError> {
        let e = &guard.envelope;
        Rule {
            field: "guard.envelope.acceleration",
            value: e.acceleration,
            low: 0.0,
            high: self.ranges.acceleration,
            because: "a reading beyond ranges.acceleration is not used, so the limit cannot trip",
            remedy: "set it to what specimen and table may feel",
        }
        .check()?;
        Rule {
            field: "guard.envelope.jerk",
            value: e.jerk,
            low: 0.0,
            high: 2.0 * self.ranges.acceleration * self.rate,
            because: "a reading within ranges.acceleration never changes faster, so the limit cannot trip",
            remedy: "set it to what specimen and table may feel",
        }
        .check()
    }

    fn check_sensors(&self, guard: &GuardSettings) -> Result<(), SettingsError> {
        let p = &guard.plausibility;
        let blind = "the table covers more than a tenth of its stroke meanwhile";
        let unread = "a reading beyond ranges.acceleration is not used, so the limit cannot trip";
        let rules = [
            ("guard.plausibility.lost", p.lost, self.blind_time(), blind, "shorten it"),
            ("guard.plausibility.stuck", p.stuck, self.blind_time(), blind, "shorten it"),
            (
                "guard.plausibility.disagreement",
                p.disagreement,
                BLIND_SHARE * self.stroke,
                "sensors may then contradict each other by more than a tenth of the stroke",
                "set it to a few times the innovation of a healthy test",
            ),
            (
                "guard.plausibility.offset",
                p.offset,
                self.ranges.acceleration,
                unread,
                "set it below the sensor's range",
            ),
            (
                "guard.plausibility.acceleration_noise",
                p.acceleration_noise,
                self.ranges.acceleration,
                unread,
                "set it to a few times the sensor's noise",
            ),
        ];
        for (field, value, high, because, remedy) in rules {
            Rule { field, value, low: 0.0, high, because, remedy }.check()?;
        }
        self.check_witness(guard)
    }

    /// What the stated errors of LVDT and accelerometer explain, in all no more than half the stroke; the largest of them is named.
    fn check_witness(&self, guard: &GuardSettings) -> Result<(), SettingsError> {
        let w = &guard.witness;
        let [of_delay, of_bias, of_noise] = w.explained(self.velocity_limit, 1.0 / self.rate);
        let of_all = of_delay + of_bias + of_noise;
        let (field, value, most) = if of_delay > of_bias && of_delay > of_noise {
            ("guard.witness.delay", w.delay, of_delay)
        } else if of_bias > of_noise {
            ("guard.witness.bias", w.bias, of_bias)
        } else {
            ("guard.witness.noise", w.noise, of_noise)
        };
        let room = max(0.5 * self.stroke - (of_all - most), 0.0);
        let high = if most > room { value * (room / most) } else { f32::INFINITY };
        let because = "LVDT and accelerometer may then contradict each other by more than half the stroke";
        Rule { field, value, low: 0.0, high, because, remedy: "state what the sensors' sheets say" }.check()?;
        Rule {
            field: "guard.witness.scale",
            value: w.scale,
            low: 0.0,
            high: 0.5,
            because: "an accelerometer that shows nothing would hardly contradict an LVDT that moves",
            remedy: "calibrate the two sensors against each other",
        }
        .check()
    }

    fn check_valve(&self, guard: &GuardSettings) -> Result<(), SettingsError> {
        let v = &guard.valve;
        Rule {
            field: "guard.valve.mismatch",
            value: v.mismatch,
            low: 0.0,
            high: 0.5 * self.stroke,
            because: "the table may then move by more than half its stroke without a command that explains it",
            remedy: "set it to a few times what a healthy test leaves unexplained",
        }
        .check()?;
        Rule {
            field: "guard.valve.memory",
            value: v.memory,
            low: v.mismatch / self.velocity_limit,
            high: 100.0,
            because: "a table at velocity_limit is forgotten before it has moved by guard.valve.mismatch",
            remedy: "lengthen the memory or lower the mismatch",
        }
        .check()
    }

    /// Time in which the table covers [`BLIND_SHARE`] of its stroke at full speed, s.
    fn blind_time(&self) -> f32 {
        BLIND_SHARE * self.stroke / self.velocity_limit
    }
}
