//! What goes between table, core and valve in a run, with what its faults make of it.

use super::Rig;
use crate::faults::class::{Channel, Fault};
use crate::faults::feed::Line;
use crate::faults::machine::OUTPUT;
use crate::faults::spoil::{BITS, Converter, Spoiled};
use shakedown_core::{Mode, OperatorRequest, Sample, State};

/// A fault that has begun.
#[derive(Clone)]
pub(super) struct Active {
    pub(super) fault: Fault,
    /// What becomes of a signal.
    pub(super) spoiled: Option<Spoiled>,
}

/// What the converters of reference and LVDT, accelerometer, and valve commands reach either way, m, m/s2 and m.
const SPANS: [f64; 3] = [0.2, 61.0, OUTPUT.span];

/// Noise of a second displacement sensor, m, and by how much its scale may differ, 1.
const SECOND: (f64, f64) = (5e-5, 0.01);

/// What a loop behind the device reads of a broken wire, m: the end of its converter.
const RAIL: f64 = 0.16;

impl Rig<'_> {
    /// What the valve gets of the core's output: in modifier mode an existing controller stands between, with an LVDT of its
    /// own or the device's; behind a device that cancels it, a hard-wired loop of unity gain over the device's.
    pub(super) fn valve(&self, output: f64) -> f64 {
        let shares = self.case.shares();
        let modifies = self.case.settings.mode == Mode::Modifier;
        let converter = if modifies { Converter { span: SPANS[0], ..OUTPUT } } else { OUTPUT };
        let output = if self.case.converters { converter.pass(output) } else { output };
        match self.case.settings.mode {
            Mode::Modifier => self.case.existing * (output - if shares { self.shared } else { self.machine.x }),
            Mode::Controller if shares => output - self.shared,
            _ => output,
        }
    }

    /// What arrives of a value of `channel`.
    fn arrives(&mut self, channel: Channel, value: f64) -> f64 {
        let mut value = value;
        for active in &mut self.active {
            let sits = match active.fault {
                Fault::Signal(on, _) => on == channel,
                Fault::Shared(_) => channel == Channel::Displacement,
                _ => false,
            };
            if let Some(spoiled) = active.spoiled.as_mut().filter(|_| sits) {
                value = spoiled.pass(value, &mut self.dice);
            }
        }
        let span = match channel {
            Channel::Acceleration => SPANS[1],
            Channel::Command if self.case.settings.mode == Mode::Guard => SPANS[2],
            _ => SPANS[0],
        };
        // The tracking law differentiates its reference three times: it is streamed, and goes through no converter.
        let streamed = channel == Channel::Command && self.case.settings.tracking.is_some();
        let converts = self.case.converters && !streamed;
        if converts { Converter { bits: BITS[0], span }.pass(value) } else { value }
    }

    /// What the converters read, and by how much LVDT and accelerometer are wrong.
    pub(super) fn measure(&mut self, tick: usize) -> (Sample, [f64; 2]) {
        let truth = [self.machine.x, (self.machine.v - self.velocity_before) * self.rate];
        let x = self.sensors.displacement(self.time, truth[0]);
        let x = self.arrives(Channel::Displacement, x);
        let a = self.sensors.acceleration(self.time, truth[1]);
        let a = self.arrives(Channel::Acceleration, a);
        let wanted = self.case.reference.get(tick).copied().unwrap_or(0.0);
        let before = self.case.reference.get(tick.saturating_sub(1)).copied().unwrap_or(wanted);
        // The existing controller closes its loop over its own reading of the same LVDT.
        let existing = self.case.existing * (wanted - x) + self.case.feed_forward * (wanted - before) * self.rate;
        let (mut external, mut reference) = (existing, wanted as f32);
        if self.case.settings.mode == Mode::Guard {
            external = self.arrives(Channel::Command, existing);
        } else if self.feed.is_some() {
            reference = self.next_point();
        } else {
            reference = self.arrives(Channel::Command, wanted) as f32;
        }
        // A broken wire is pulled to the rail that drives the table outward.
        self.shared = if x.is_finite() { x } else { RAIL.copysign(-truth[0]) };
        let second = if self.case.second_sensor() { self.second(truth[0]) } else { 0.0 };
        let sample = Sample {
            external: external as f32,
            second_displacement: second as f32,
            ..Sample::new(reference, x as f32, a as f32)
        };
        (sample, [x - truth[0], a - truth[1]])
    }

    /// What a second displacement sensor reads of the `truth` (m).
    fn second(&mut self, truth: f64) -> f64 {
        let read = truth * (1.0 + SECOND.1) + SECOND.0 * self.dice.normal();
        self.arrives(Channel::Second, read)
    }

    /// The next point of the stream, as the firmware's loop takes it: its absence fades the test out.
    fn next_point(&mut self) -> f32 {
        let line = self.active.iter().fold(Line::Whole, |line, active| match active.fault {
            Fault::LinkCut => Line::Cut,
            Fault::LinkGarbled(share) => Line::Garbled(share),
            _ => line,
        });
        if self.controller.state() == State::Running
            && let Some(feed) = &mut self.feed
        {
            match feed.tick(line, &mut self.dice) {
                Some(point) => self.reference = point,
                None => {
                    let _ = self.controller.request(OperatorRequest::Stop);
                }
            }
        }
        self.reference
    }
}
