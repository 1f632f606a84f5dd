//! The steps with the pressure low: what the table does by itself, which way it moves, how it stops.

use super::super::asking::prompted;
use super::{failed, inputs};
use crate::cli::Failure;
use crate::cli::output::print;
use crate::device::{Port, Row, Session, SessionError, TestRunner};
use crate::faults::limit_switches;
use crate::files::Unfinished;
use shakedown_core::link::{HostRequest, Report, Setup, answer};
use shakedown_core::settings::InnerLoop;
use shakedown_core::{Mode, State};
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::time::Duration;

/// Step 10: how far (m), and how long the way and the stand after it (s).
const PUSH: f64 = 0.002;
const WAY: f64 = 2.0;
const STAND: f64 = 1.0;
/// Shares of the record that step 12 plays.
const SHARES: [(&str, f32); 3] = [("tenth", 0.1), ("third", 1.0 / 3.0), ("full", 1.0)];
/// Why nothing is played.
const AT_THE_CONVERTER: &str = "the reference is at the converter: play it there, and `device run --seconds`";
/// Flag of a record of telemetry: the table is at its velocity limit.
const SATURATED: u16 = 1;

/// The device, and what it is to play.
pub(super) struct Oil<'a> {
    pub(super) session: &'a mut Session<Port>,
    pub(super) setup: Setup,
    pub(super) record: Option<Vec<f32>>,
}

impl Oil<'_> {
    /// All of the steps, as far as they are agreed to.
    pub(super) fn walk(&mut self, text: &mut String) -> Result<(), Failure> {
        let guards = self.setup.control.mode == Mode::Guard;
        let streamed = self.setup.wiring.source.streamed();
        self.limit_switches(text);
        if !agreed(text, "9", "Pressure at its least, a soft stop either side. Arm, and hold for three seconds")? {
            return Ok(());
        }
        self.creep(text)?;
        if guards {
            let _ = writeln!(text, "\n[step-10]\nleft_out = \"in guard mode the existing controller moves the table\"");
        } else if !streamed {
            let _ = writeln!(text, "\n[step-10]\nleft_out = {AT_THE_CONVERTER:?}");
        } else if !agreed(text, "10", "Polarity: a slow +2 mm")? {
            return Ok(());
        } else {
            self.polarity(text)?;
        }
        for (number, what) in [("11a", "Accelerometer at rest, then Enter."), ("11b", "One side lifted, then Enter.")] {
            let Some(typed) = prompted(number, what)? else { return Ok(()) };
            let _ = writeln!(text, "\n[step-{number}]\ninstruction = {what:?}\ntyped = {typed:?}");
            inputs(self.session, text)?;
        }
        let Some(record) = self.record.take().filter(|_| streamed) else {
            let why = if streamed { "no record was given (--record)" } else { AT_THE_CONVERTER };
            let _ = writeln!(text, "\n[step-12]\nleft_out = {why:?}");
            return Ok(());
        };
        for (name, share) in SHARES {
            if !agreed(text, &format!("12-{name}"), &format!("The record at {:.0} %", 100.0 * share))? {
                return Ok(());
            }
            self.play(record.iter().map(|x| share * x).collect(), text)?;
        }
        if agreed(text, "14", "The record at full size: press the emergency stop at full speed")? {
            self.stop(record, text)?;
        }
        Ok(())
    }

    /// Where they belong, while they can still be moved with the hydraulics off.
    fn limit_switches(&self, text: &mut String) {
        if let Some(from) = limit_switches(&self.setup.control) {
            print(&format!("Limit switches: no farther than {:.0} mm from the middle, either side.\n", 1e3 * from));
            let _ = writeln!(text, "\n[limit-switches]\nno_farther_than = {} # m from the middle", number(from));
        }
    }

    /// Armed, the table should stand. What it creeps by, and what the law asks for against it, is the valve's null bias:
    /// v = gain (command - null).
    fn creep(&mut self, text: &mut String) -> Result<(), Failure> {
        let unfinished = Unfinished::begin();
        let challenge = self
            .session
            .ask(&HostRequest::RequestArming, |report| if let Report::Challenge(c) = report { Some(*c) } else { None })
            .map_err(failed)?;
        self.session.order(&HostRequest::Arm(answer(challenge))).map_err(failed)?;
        self.session.listen(Duration::from_secs(1)).map_err(failed)?;
        let heard = self.session.listen(Duration::from_secs(2)).map_err(failed)?;
        let vitals = self.session.vitals().map_err(failed)?;
        let state = vitals.state;
        // Whatever the state is, the relay opens.
        let order = if state == State::Ready { HostRequest::Disarm } else { HostRequest::Trip };
        self.session.order(&order).map_err(failed)?;
        on(&unfinished)?;
        let rows: Vec<Row> = heard.rows().iter().copied().filter(|row| row.state == State::Ready).collect();
        let not_held = || {
            let (rows, cause) = (heard.rows().len(), vitals.cause);
            Failure::Work(format!("the table was not held: the device is {state:?}, {cause:?}; {rows} records came"))
        };
        let speed = self.drift(&rows).ok_or_else(not_held)?;
        let _ = writeln!(text, "state = \"{state:?}\"\ncreeps_by = {} # m/s", number(speed));
        if self.setup.control.mode == Mode::Controller {
            let command = mean(rows.iter().map(|row| self.command(row)));
            let null = command - speed / f64::from(self.setup.control.valve.gain);
            let _ = writeln!(text, "null_bias = {} # m, for control.valve.null_bias", number(null));
        }
        Ok(())
    }

    /// A little toward positive displacement, from where the table stands.
    fn polarity(&mut self, text: &mut String) -> Result<(), Failure> {
        let heard = self.session.listen(Duration::from_millis(300)).map_err(failed)?;
        let from = mean(heard.rows().iter().map(|row| self.displacement(row)));
        let rate = f64::from(self.setup.control.rate);
        let points = ((WAY + STAND) * rate) as usize;
        let share = |tick: usize| (tick as f64 / (WAY * rate)).min(1.0);
        let record = (0..points).map(|tick| (from + PUSH * share(tick).powi(2) * (3.0 - 2.0 * share(tick))) as f32);
        let rows = self.play(record.collect(), text)?;
        let last = rows.len() - rows.len().min((0.3 * rate) as usize);
        let moved = mean(rows.get(last..).unwrap_or_default().iter().map(|row| self.displacement(row))) - from;
        let right = if moved > 0.25 * PUSH { "right" } else { "wrong, or stuck" };
        let _ = writeln!(text, "asked_for = {PUSH}\nmoved_by = {} # m\npolarity = \"{right}\"", number(moved));
        Ok(())
    }

    /// Plays `record`, m, and says how it went; its telemetry.
    fn play(&mut self, record: Vec<f32>, text: &mut String) -> Result<Vec<Row>, Failure> {
        let mut drive = TestRunner::new(None, record);
        let unfinished = Unfinished::begin();
        let go_on = |_: &mut TestRunner, _| {
            if unfinished.asked_to_end() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let ended = match self.session.drive(&mut drive, go_on) {
            Ok(()) => "done".to_owned(),
            Err(SessionError::Drive(error)) => error.to_string(),
            Err(error) => return Err(failed(error)),
        };
        let rows: Vec<Row> = drive.telemetry().run().copied().collect();
        let saturated = rows.iter().filter(|row| row.record.flags & SATURATED != 0).count();
        let error = rows.iter().map(|row| (f64::from(row.record.fitted) - self.displacement(row)).abs());
        let _ = writeln!(
            text,
            "ended = {ended:?}\nrecords = {}\nsaturated = {saturated}\nlargest_error = {} # m",
            rows.len(),
            number(error.fold(0.0, f64::max))
        );
        on(&unfinished)?;
        Ok(rows)
    }

    /// From full speed to a stand, beside the distance that the guard assumes.
    fn stop(&mut self, record: Vec<f32>, text: &mut String) -> Result<(), Failure> {
        let before = self.play(record, text)?;
        let after = self.session.listen(Duration::from_millis(500)).map_err(failed)?;
        let tail = before.get(before.len().saturating_sub(20)..).unwrap_or_default();
        let (Some(at), Some(speed), Some(end)) = (tail.last(), self.drift(tail), after.rows().last()) else {
            return Err(Failure::Work("no telemetry of the stop came".into()));
        };
        let cause = self.session.vitals().map_err(failed)?.cause;
        let way = (self.displacement(end) - self.displacement(at)).abs();
        let _ = writeln!(
            text,
            "cause = \"{cause:?}\"\nspeed = {} # m/s\nstopped_within = {} # m",
            number(speed),
            number(way)
        );
        if let Some(guard) = &self.setup.control.guard {
            let (latency, braking) = (guard.envelope.stopping_latency, guard.envelope.stopping_deceleration);
            let allowed = speed.abs() * (f64::from(latency) + 0.5 * speed.abs() / f64::from(braking));
            let _ = writeln!(text, "guard_reckons_with = {} # m", number(allowed));
        }
        Ok(())
    }

    fn displacement(&self, row: &Row) -> f64 {
        f64::from(self.setup.wiring.displacement.to_si(row.record.inputs[1]))
    }

    /// What the valve got, m.
    fn command(&self, row: &Row) -> f64 {
        let output = f64::from(self.setup.wiring.output.to_si(row.record.output));
        if self.setup.control.inner_loop == InnerLoop::Hardwired { output - self.displacement(row) } else { output }
    }

    /// Slope of the displacement over time by least squares, m/s; none of fewer than two rows.
    fn drift(&self, rows: &[Row]) -> Option<f64> {
        let time = |row: &Row| f64::from(row.tick) / f64::from(self.setup.control.rate);
        let (t0, x0) = (mean(rows.iter().map(time)), mean(rows.iter().map(|row| self.displacement(row))));
        let spread: f64 = rows.iter().map(|row| (time(row) - t0).powi(2)).sum();
        let both: f64 = rows.iter().map(|row| (time(row) - t0) * (self.displacement(row) - x0)).sum();
        (spread > 0.0).then(|| both / spread)
    }
}

/// Whether to go on, now that the relay is open.
fn on(unfinished: &Unfinished) -> Result<(), Failure> {
    let ended = || Failure::Work("interrupted: the test was ended and the relay opened".into());
    if unfinished.asked_to_end() { Err(ended()) } else { Ok(()) }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
    sum / f64::from(count)
}

/// As TOML writes it.
fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:e}") } else { "nan".into() }
}

/// Asks whether to go on with a step that moves oil, and opens its table in the notes.
fn agreed(text: &mut String, number: &str, what: &str) -> Result<bool, Failure> {
    let agreed = prompted(number, &format!("{what} [yes/stop]?"))?.is_some_and(|typed| typed == "yes");
    if agreed {
        let _ = writeln!(text, "\n[step-{number}]\ninstruction = {what:?}");
    }
    Ok(agreed)
}
