//! Telemetry as a recording, and the experiment that names its columns.

use std::fmt::Write as _;

use shakedown_core::control::InnerLoop;
use shakedown_core::link::Setup;

use super::Row;

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

/// The rows as CSV in SI, one a tick; a record that is missing between two others leaves its channels NaN. Time counts from
/// the first row. A gap of more than [`LONGEST`] records is one row: what a device says of its ticks does not decide how much
/// is written. The command is what the valve got: where an inner loop subtracts the LVDT, the output less that.
pub fn csv(rows: &[Row], setup: &Setup, every: u16) -> String {
    let mut text = String::from(
        "time [s],reference [m],modified_reference [m],displacement [m],acceleration [m/s2],external [m],command\n",
    );
    let rate = f64::from(setup.control.rate);
    let wiring = &setup.wiring;
    let hardwired = setup.control.inner_loop == InnerLoop::Hardwired;
    let first = rows.first().map_or(0, |row| row.tick);
    let (mut expected, step) = (first, u32::from(every.max(1)));
    for row in rows {
        let time = |tick: u32| f64::from(tick.wrapping_sub(first)) / rate;
        for k in 0..missing_rows(expected, row.tick, step) {
            let _ = writeln!(text, "{},NaN,NaN,NaN,NaN,NaN,NaN", time(expected.wrapping_add(k * step)));
        }
        let [_, displacement, acceleration, external] = row.record.inputs;
        let displacement = wiring.displacement.to_si(displacement);
        let output = wiring.output.to_si(row.record.output);
        let command = if hardwired { output - displacement } else { output };
        let (reference, fitted) = (row.record.reference, row.record.fitted);
        let (acceleration, external) = (wiring.acceleration.to_si(acceleration), wiring.external.to_si(external));
        let _ = writeln!(
            text,
            "{},{reference},{fitted},{displacement},{acceleration},{external},{command}",
            time(row.tick)
        );
        expected = row.tick.wrapping_add(step);
    }
    text
}

/// An experiment of one run: the valve model of the setup, driven by the recorded command, so that nothing about the law
/// has to be known. A converter's step over the root of twelve is the least noise that a channel can have.
pub fn experiment(name: &str, file: &str, setup: &Setup) -> String {
    let valve = &setup.control.valve;
    let a1 = 1.0 / valve.lag.max(1e-6);
    let noise = |per_code: f32| per_code.abs() / 12f32.sqrt();
    let wiring = &setup.wiring;
    format!(
        "name = {name:?}\n\n[model]\nkind = \"servo\"\nb1 = 0.0\nb0 = {b0}\na1 = {a1}\nvelocity_limit = {limit}\n\n\
         [channels]\ntime = {{ column = \"time\", unit = \"s\" }}\n\
         reference = {{ column = \"modified_reference\", unit = \"m\" }}\n\
         displacement = {{ column = \"displacement\", unit = \"m\", noise = {dx} }}\n\
         acceleration = {{ column = \"acceleration\", unit = \"m/s2\", noise = {da} }}\n\
         command = {{ column = \"command\", unit = \"1\" }}\n\n[[runs]]\nfile = {file:?}\n",
        b0 = valve.gain * a1,
        limit = setup.control.velocity_limit,
        dx = noise(wiring.displacement.per_code),
        da = noise(wiring.acceleration.per_code),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_is_written_out_unless_it_is_absurd() {
        assert_eq!(missing_rows(5, 5, 1), 0);
        assert_eq!(missing_rows(5, 9, 2), 2);
        assert_eq!(missing_rows(9, 5, 1), 0, "a device that was reset counts anew");
        assert_eq!(missing_rows(u32::MAX, 3, 1), 4, "ticks wrap");
        assert_eq!(missing_rows(0, 2_000_000_000, 1), 1);
    }
}
