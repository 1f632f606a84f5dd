//! Telemetry as a recording, and the experiment that names its columns.

use std::io::{self, Write};

use shakedown_core::State;
use shakedown_core::link::{Scale, Setup};
use shakedown_core::settings::InnerLoop;

use super::Row;
use crate::recording::signal::{detrend, deviation};

/// Longest gap that is written row by row, records.
const LONGEST: u32 = 10_000;

/// Rows that stand for what is missing from tick `expected` to `tick`, a record every `step` ticks; none where ticks went back.
fn missing_rows(expected: u32, tick: u32, step: u32) -> u32 {
    match tick.wrapping_sub(expected) {
        0 => 0,
        ticks if ticks > u32::MAX / 2 => 0,
        ticks if ticks / step > LONGEST => 1,
        ticks => ticks.div_ceil(step),
    }
}

/// Rows as CSV in SI, one a tick; a record that is missing between two others leaves its channels NaN. Time counts from
/// the first row. A gap of more than `LONGEST` records is one row: what a device says of its ticks does not decide how much
/// is written. The command is what the valve got: where an inner loop subtracts the LVDT, the output less that.
#[derive(Debug)]
pub struct Sheet<W> {
    out: W,
    setup: Setup,
    step: u32,
    /// Ticks of the first row and of the next, where there was one.
    ticks: Option<(u32, u32)>,
    rows: u64,
}

impl<W: Write> Sheet<W> {
    /// Writes the names of the columns; rows will come every [`Setup::telemetry_every`] ticks.
    pub fn begin(mut out: W, setup: &Setup) -> io::Result<Self> {
        out.write_all(
            b"time [s],reference [m],modified_reference [m],displacement [m],acceleration [m/s2],external [m],command\n",
        )?;
        Ok(Self { out, setup: *setup, step: u32::from(setup.telemetry_every.max(1)), ticks: None, rows: 0 })
    }

    /// Writes a row, after rows for what is missing before it.
    pub fn write(&mut self, row: &Row) -> io::Result<()> {
        let (first, expected) = self.ticks.unwrap_or((row.tick, row.tick));
        let rate = f64::from(self.setup.control.rate);
        let time = |tick: u32| f64::from(tick.wrapping_sub(first)) / rate;
        for k in 0..missing_rows(expected, row.tick, self.step) {
            writeln!(self.out, "{},NaN,NaN,NaN,NaN,NaN,NaN", time(expected.wrapping_add(k * self.step)))?;
        }
        let wiring = &self.setup.wiring;
        let [_, displacement, acceleration, external] = row.record.inputs;
        let displacement = wiring.displacement.to_si(displacement);
        let output = wiring.output.to_si(row.record.output);
        let hardwired = self.setup.control.inner_loop == InnerLoop::Hardwired;
        let command = if hardwired { output - displacement } else { output };
        let (reference, fitted) = (row.record.reference, row.record.fitted);
        let (acceleration, external) = (wiring.acceleration.to_si(acceleration), wiring.external.to_si(external));
        self.ticks = Some((first, row.tick.wrapping_add(self.step)));
        self.rows += 1;
        writeln!(self.out, "{},{reference},{fitted},{displacement},{acceleration},{external},{command}", time(row.tick))
    }

    /// Hands on what is written.
    pub fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }

    /// Rows written, those for what is missing not counted.
    pub const fn rows(&self) -> u64 {
        self.rows
    }

    /// What was written to.
    pub fn end(mut self) -> io::Result<W> {
        self.out.flush()?;
        Ok(self.out)
    }
}

/// Fewest records at rest that a noise is stated from: its standard deviation is then known to a tenth.
const FEWEST: usize = 64;

/// Standard deviation of an input over `codes`, codes, about the straight line through them; none where there are too few.
/// A converter's step over the root of twelve is the least that a channel can have.
fn noise(codes: &[f64]) -> Option<f64> {
    let mut codes = codes.to_vec();
    detrend(&mut codes);
    (codes.len() >= FEWEST).then(|| deviation(&codes).max(1.0 / 12f64.sqrt()))
}

/// An experiment of one run: the valve model of the setup, driven by the recorded command, so that nothing about the law
/// has to be known. The sensors' noise is what `rows`, all that the device sent, show before the test runs, the converters'
/// steps included; where that is too little, none is stated, and it is estimated from the recording: a converter's step
/// alone would be less than a sensor has, and what the sensor adds would then look like physics that the model leaves out.
pub(super) fn experiment(name: &str, file: &str, setup: &Setup, rows: &[Row]) -> String {
    let valve = &setup.control.valve;
    let a1 = 1.0 / valve.lag.max(1e-6);
    let wiring = &setup.wiring;
    let at_rest = |row: &&Row| matches!(row.state, State::Off | State::Ready);
    let before = || rows.iter().take_while(|row| row.state != State::Running).filter(at_rest);
    let stated = |input: usize, scale: &Scale| {
        let codes: Vec<f64> = before().filter_map(|row| row.record.inputs.get(input)).map(|&c| f64::from(c)).collect();
        noise(&codes).map_or_else(String::new, |codes| format!(", noise = {}", codes * f64::from(scale.per_code.abs())))
    };
    format!(
        "name = {name:?}\n\n[model]\nkind = \"servo\"\nb1 = 0.0\nb0 = {b0}\na1 = {a1}\nvelocity_limit = {limit}\n\n\
         [channels]\ntime = {{ column = \"time\", unit = \"s\" }}\n\
         reference = {{ column = \"modified_reference\", unit = \"m\" }}\n\
         displacement = {{ column = \"displacement\", unit = \"m\"{dx} }}\n\
         acceleration = {{ column = \"acceleration\", unit = \"m/s2\"{da} }}\n\
         command = {{ column = \"command\", unit = \"1\" }}\n\n[[runs]]\nfile = {file:?}\n",
        b0 = valve.gain * a1,
        limit = setup.control.velocity_limit,
        dx = stated(1, &wiring.displacement),
        da = stated(2, &wiring.acceleration),
    )
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use shakedown_core::Settings;
    use shakedown_core::link::{Record, Source, Wiring};

    pub(in super::super) fn row(tick: u32, state: State, displacement: u16) -> Row {
        let inputs = [2048, displacement, 2048, 2048];
        Row { tick, state, record: Record { inputs, ..Record::default() } }
    }

    pub(in super::super) fn setup() -> Setup {
        let scale = Scale { zero: 2048.0, per_code: 7.4e-5 };
        let wiring = Wiring {
            source: Source::Streamed,
            reference: scale,
            displacement: scale,
            acceleration: scale,
            external: scale,
            output: scale,
            full_scale: 4095,
            rails_are_faults: true,
        };
        Setup { telemetry_every: 1, lease_ms: 0, wiring, control: Settings::default() }
    }

    #[test]
    fn the_noise_stated_is_what_was_seen_at_rest() {
        let setup = setup();
        // Two codes up, two down, while the table rests; what it does in the test is no noise.
        let mut rows: Vec<Row> = (0..200).map(|k| row(k, State::Off, 2046 + 4 * (k % 2) as u16)).collect();
        rows.extend((200..400).map(|k| row(k, State::Running, 10 * k as u16)));
        let step = f64::from(setup.wiring.displacement.per_code);
        let stated = |rows: &[Row]| {
            let text = experiment("device", "recording.csv", &setup, rows);
            let line = text.lines().find(|line| line.starts_with("displacement")).unwrap().to_owned();
            line.split_once("noise = ").map(|(_, rest)| rest.trim_end_matches(" }").parse::<f64>().unwrap())
        };
        assert!(stated(&rows).is_some_and(|noise| (noise / (2.0 * step) - 1.0).abs() < 0.02), "{:?}", stated(&rows));
        let still: Vec<Row> = (0..200).map(|k| row(k, State::Ready, 2048)).collect();
        assert!(stated(&still).is_some_and(|noise| (noise * 12f64.sqrt() / step - 1.0).abs() < 1e-6));
        assert_eq!(stated(&rows[200..]), None, "nothing is stated where nothing rested");
        assert_eq!(stated(&rows[..10]), None, "nor where too little did");
    }

    #[test]
    fn a_missing_record_is_a_row_without_numbers() {
        let mut sheet = Sheet::begin(Vec::new(), &setup()).unwrap();
        for tick in [7, 8, 10] {
            sheet.write(&row(tick, State::Running, 2048)).unwrap();
        }
        assert_eq!(sheet.rows(), 3);
        let text = String::from_utf8(sheet.end().unwrap()).unwrap();
        let times: Vec<&str> = text.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
        assert_eq!(times, ["0", "0.001", "0.002", "0.003"]);
        assert!(text.contains("0.002,NaN,NaN"), "{text}");
    }

    #[test]
    fn a_gap_is_written_out_unless_it_is_absurd() {
        assert_eq!(missing_rows(5, 5, 1), 0);
        assert_eq!(missing_rows(5, 9, 2), 2);
        assert_eq!(missing_rows(9, 5, 1), 0, "a device that was reset counts anew");
        assert_eq!(missing_rows(u32::MAX, 3, 1), 4, "ticks wrap");
        assert_eq!(missing_rows(0, 2_000_000_000, 1), 1);
    }
}
