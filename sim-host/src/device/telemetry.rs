//! Telemetry put together again, with what is missing in it named.

use shakedown_core::State;
use shakedown_core::link::{Batch, Record};

/// One tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Tick since the device's reset.
    pub tick: u32,
    /// Where the test stood.
    pub state: State,
    /// What it saw and did.
    pub record: Record,
}

/// Records that are missing: sent by the device and lost on the line, or dropped by it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gap {
    /// Tick of the first record missing.
    pub from: u32,
    /// How many are.
    pub records: u32,
}

/// All records of a session, in the order of their ticks.
#[derive(Debug, Clone, Default)]
pub struct Telemetry {
    rows: Vec<Row>,
    gaps: Vec<Gap>,
    dropped: u32,
    every: u16,
    expected: Option<u32>,
}

impl Telemetry {
    /// Takes a batch.
    pub fn take(&mut self, batch: &Batch) {
        let every = u32::from(batch.every.max(1));
        if let Some(expected) = self.expected.filter(|&expected| expected != batch.first && batch.every == self.every) {
            let missing = batch.first.wrapping_sub(expected);
            if missing < u32::MAX / 2 {
                self.gaps.push(Gap { from: expected, records: missing / every });
            }
        }
        self.every = batch.every;
        self.dropped = batch.dropped;
        let mut tick = batch.first;
        for &record in &batch.records {
            self.rows.push(Row { tick, state: batch.state, record });
            tick = tick.wrapping_add(every);
        }
        self.expected = Some(tick);
    }

    /// The records.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The records since the last time, which are not kept any longer.
    pub fn take_rows(&mut self) -> Vec<Row> {
        std::mem::take(&mut self.rows)
    }

    /// What is missing between them.
    pub fn gaps(&self) -> &[Gap] {
        &self.gaps
    }

    /// The gaps since the last time, which are not kept any longer.
    pub fn take_gaps(&mut self) -> Vec<Gap> {
        std::mem::take(&mut self.gaps)
    }

    /// What the device says it dropped since its reset.
    pub const fn dropped(&self) -> u32 {
        self.dropped
    }

    /// The records of the run: from its first tick to its last.
    pub fn run(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| of_the_run(row))
    }
}

/// Whether a record is of a test while it runs.
pub(super) fn of_the_run(row: &Row) -> bool {
    row.state == State::Running
}

#[cfg(test)]
mod tests {
    use super::*;

    fn batch(first: u32, every: u16, records: usize) -> Batch {
        let records = (0..records).map(|_| Record::default()).collect();
        Batch { first, every, state: State::Running, dropped: 0, records }
    }

    #[test]
    fn what_is_missing_is_named() {
        let mut telemetry = Telemetry::default();
        telemetry.take(&batch(100, 5, 4));
        telemetry.take(&batch(120, 5, 4));
        assert_eq!(telemetry.gaps(), []);
        telemetry.take(&batch(180, 5, 1));
        assert_eq!(telemetry.gaps(), [Gap { from: 140, records: 8 }]);
        assert_eq!(telemetry.rows().len(), 9);
        assert_eq!(telemetry.rows()[8].tick, 180);
    }
}
