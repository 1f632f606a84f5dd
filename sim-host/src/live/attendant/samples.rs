//! Records of telemetry as samples in SI, with what is missing between them counted.

use shakedown_core::link::Setup;
use shakedown_core::settings::InnerLoop;

use super::super::bench::Sample;
use crate::device::{Gap, Row};

/// Turns records into samples.
#[derive(Debug)]
pub(super) struct Samples {
    setup: Setup,
    /// Ticks since the first record, and the tick of the last one: ticks wrap after weeks.
    at: Option<(u64, u32)>,
    count: u64,
    missing: u64,
}

impl Samples {
    pub(super) fn new(setup: &Setup) -> Self {
        Self { setup: *setup, at: None, count: 0, missing: 0 }
    }

    /// Samples so far.
    pub(super) const fn count(&self) -> u64 {
        self.count
    }

    /// Records missing so far.
    pub(super) const fn missing(&self) -> u64 {
        self.missing
    }

    /// The samples of `rows`, with `gaps` before some of them.
    pub(super) fn of(&mut self, rows: &[Row], gaps: &[Gap]) -> Vec<Sample> {
        self.missing += gaps.iter().map(|gap| u64::from(gap.records)).sum::<u64>();
        rows.iter().map(|row| self.sample(row, gaps)).collect()
    }

    fn sample(&mut self, row: &Row, gaps: &[Gap]) -> Sample {
        let every = u32::from(self.setup.telemetry_every.max(1));
        let before = |gap: &&Gap| gap.from.wrapping_add(gap.records.wrapping_mul(every)) == row.tick;
        let gap = gaps.iter().find(before).map_or(0, |gap| gap.records);
        let (passed, last) = self.at.unwrap_or((0, row.tick));
        let step = row.tick.wrapping_sub(last);
        // A device that was reset counts anew: its first record comes one step after the last one before.
        let ticks = passed + u64::from(if step > u32::MAX / 2 { every } else { step });
        self.at = Some((ticks, row.tick));
        self.count += 1;
        let wiring = &self.setup.wiring;
        let [_, displacement, acceleration, _] = row.record.inputs;
        let displacement = f64::from(wiring.displacement.to_si(displacement));
        let output = f64::from(wiring.output.to_si(row.record.output));
        let hardwired = self.setup.control.inner_loop == InnerLoop::Hardwired;
        let flag = |bit: u16| row.record.flags & (1 << bit) != 0;
        Sample {
            time: ticks as f64 / f64::from(self.setup.control.rate),
            gap,
            reference: f64::from(row.record.reference),
            modified: f64::from(row.record.fitted),
            displacement,
            acceleration: f64::from(wiring.acceleration.to_si(acceleration)),
            command: if hardwired { output - displacement } else { output },
            state: row.state,
            saturated: flag(0),
            held: flag(1),
            limited: flag(2),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shakedown_core::State;
    use shakedown_core::link::Record;
    use shakedown_firmware::defaults;

    fn row(tick: u32) -> Row {
        let record = Record { inputs: [2048; 4], output: 2048, flags: 0b101, ..Record::default() };
        Row { tick, state: State::Running, record }
    }

    #[test]
    fn what_is_missing_is_counted_where_it_is_missing() {
        let mut samples = Samples::new(&defaults::setup());
        let first = samples.of(&[row(7), row(8)], &[]);
        assert_eq!((first[0].time, first[1].time), (0.0, 0.001));
        assert!(first[0].saturated && first[0].limited && !first[0].held);
        let then = samples.of(&[row(12)], &[Gap { from: 9, records: 3 }]);
        assert_eq!((then[0].gap, then[0].time), (3, 0.005));
        assert_eq!((samples.count(), samples.missing()), (3, 3));
    }

    #[test]
    fn time_goes_on_where_ticks_wrap_or_begin_anew() {
        let mut samples = Samples::new(&defaults::setup());
        let times: Vec<f64> = samples.of(&[row(u32::MAX), row(0), row(1)], &[]).iter().map(|s| s.time).collect();
        assert_eq!(times, [0.0, 0.001, 0.002]);
        samples.of(&[row(100_000)], &[]);
        assert!((samples.of(&[row(3)], &[])[0].time - 100.002).abs() < 1e-9, "a reset");
    }
}
