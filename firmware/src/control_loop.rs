//! One tick: codes in, the core's decision, a code out.
//!
//! What the valve gets in a run is decided by [`Controller::step`] alone. This file says which reference the core sees,
//! whether the relay of the hydraulic block may be closed, and that the output is the safe one when it is open.

use shakedown_core::link::{Phase, Record, Role, Setup, Source, Trip};
use shakedown_core::{Command, Controller, Sample};

use crate::queues::{Entry, LoopEnd, Order, Standing};
use crate::safe_output::{SafeRamp, target, to_code};
use crate::stream::{self, Next, Stop};

/// What the board noticed since the last tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Events {
    /// The emergency-stop circuit is open.
    pub emergency_stop: bool,
    /// The supply is below its threshold.
    pub supply_low: bool,
    /// The last tick was not done when this one began.
    pub overrun: bool,
    /// The converter failed.
    pub converter: bool,
}

/// What a tick leaves for the board to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Outcome {
    /// Output code.
    pub output: u16,
    /// The output code that would stop the oil now, for a program that fails before the next tick.
    pub safe: u16,
    /// Whether the relay of the hydraulic block is closed.
    pub relay: bool,
    /// The control rate changed to this, Hz: whole.
    pub rate: Option<u32>,
}

/// Everything that decides the output.
#[allow(missing_debug_implementations, reason = "the queues have none")]
pub struct Loop<'a> {
    setup: Setup,
    fresh: Controller,
    controller: Controller,
    queues: LoopEnd<'a>,
    standing: Standing,
    tick: u32,
    until_record: u16,
    dropped: u32,
    probe: Option<u16>,
    safe: SafeRamp,
    stop: Stop,
    /// Output of the last tick, code.
    output: u16,
    /// Reference of the last tick, and its change in it, m.
    reference: f32,
    change: f32,
    /// The last displacement read off a sensor that was not at the end of its range, m.
    displacement: f32,
}

impl<'a> Loop<'a> {
    /// A loop at rest around a controller made of `setup`. `restarted` when the last reset was none that anyone asked
    /// for: it begins tripped.
    pub fn new(controller: Controller, setup: &Setup, queues: LoopEnd<'a>, restarted: bool) -> Self {
        let output = to_code(0.0, &setup.wiring);
        let standing = if restarted {
            Standing { phase: Phase::Tripped, trip: Some(Trip::Restarted) }
        } else {
            Standing { phase: Phase::Idle, trip: None }
        };
        Self {
            setup: *setup,
            fresh: controller.clone(),
            controller,
            queues,
            standing,
            tick: 0,
            until_record: 0,
            dropped: 0,
            probe: None,
            safe: SafeRamp::new(output, &setup.wiring, setup.control.rate),
            stop: Stop::new(0.0, 0.0, setup.control.rate),
            output,
            reference: 0.0,
            change: 0.0,
            displacement: 0.0,
        }
    }

    /// Where the loop stands, the ticks so far and the records dropped.
    pub const fn standing(&self) -> (Standing, u32, u32) {
        (self.standing, self.tick, self.dropped)
    }

    /// One tick. `inputs` are the codes of reference, displacement, acceleration and existing command.
    pub fn tick(&mut self, inputs: [u16; 4], events: Events) -> Outcome {
        let wiring = &self.setup.wiring;
        let [reference, displacement, acceleration, command] = inputs;
        let sample = Sample {
            reference: wiring.reference.to_si(reference),
            displacement: wiring.displacement.to_si(displacement),
            acceleration: wiring.acceleration.to_si(acceleration),
        };
        let passed = wiring.command.to_si(command);
        let railed = wiring.rail_is_fault && (displacement == 0 || displacement >= wiring.full_scale);
        if !railed {
            self.displacement = sample.displacement;
        }
        if self.tick == 0 {
            self.safe = SafeRamp::new(target(wiring, self.displacement), wiring, self.setup.control.rate);
        }
        let rate = self.obey();
        self.watch(events, railed);
        let decision = self.decide(sample, passed);
        self.conclude(inputs, decision, rate)
    }

    /// Carries out at most one order. Returns the control rate where it changed.
    #[inline]
    fn obey(&mut self) -> Option<u32> {
        if self.queues.orders.is_empty() {
            return None;
        }
        self.carry_out()
    }

    #[inline(never)]
    fn carry_out(&mut self) -> Option<u32> {
        let phase = self.standing.phase;
        match self.queues.orders.dequeue()? {
            Order::Setup(setup) if matches!(phase, Phase::Idle | Phase::Tripped) => return self.take(&setup),
            Order::Arm if phase == Phase::Idle => {
                self.controller = self.fresh.clone();
                self.probe = None;
                self.reference = self.displacement;
                self.change = 0.0;
                self.enter(Phase::Armed);
            }
            Order::Start if phase == Phase::Armed => self.enter(Phase::Running),
            Order::Stop => self.bring_to_stand(),
            Order::ClearTrip if phase == Phase::Tripped => {
                self.standing = Standing { phase: Phase::Idle, trip: None };
            }
            Order::Probe(code) if phase == Phase::Idle => self.probe = code,
            _ => {}
        }
        None
    }

    /// Takes a setup between two ticks. The output stays where it is and ramps to what the new wiring calls safe.
    fn take(&mut self, setup: &Setup) -> Option<u32> {
        let controller = Controller::new(&setup.control).ok()?;
        let changed = setup.control.rate != self.setup.control.rate;
        self.setup = *setup;
        self.fresh = controller.clone();
        self.controller = controller;
        self.safe = SafeRamp::new(self.output, &setup.wiring, setup.control.rate);
        changed.then_some(setup.control.rate as u32)
    }

    /// Trips where something is wrong.
    #[inline]
    fn watch(&mut self, events: Events, railed: bool) {
        if events == Events::default() && !railed {
            return;
        }
        let trip = if events.emergency_stop {
            Trip::EmergencyStop
        } else if events.supply_low {
            Trip::SupplyLow
        } else if events.converter {
            Trip::Converter
        } else if events.overrun {
            Trip::Overrun
        } else {
            Trip::Rail
        };
        self.trip(trip);
    }

    /// The relay opens and the output ramps to the safe one. The first cause is kept.
    #[inline(never)]
    fn trip(&mut self, trip: Trip) {
        if self.standing.phase != Phase::Tripped {
            self.standing = Standing { phase: Phase::Tripped, trip: Some(trip) };
            self.safe = SafeRamp::new(self.output, &self.setup.wiring, self.setup.control.rate);
            self.probe = None;
            stream::clear(&mut self.queues);
        }
    }

    fn enter(&mut self, phase: Phase) {
        self.standing.phase = phase;
    }

    fn bring_to_stand(&mut self) {
        if matches!(self.standing.phase, Phase::Armed | Phase::Running) {
            self.stop = Stop::new(self.reference, self.change, self.setup.control.rate);
            self.enter(Phase::Stopping);
            stream::clear(&mut self.queues);
        }
    }

    /// The reference of this tick, m, as the phase has it.
    #[inline]
    fn next_reference(&mut self, analog: f32) -> f32 {
        match self.standing.phase {
            Phase::Running if self.setup.wiring.source == Source::Analog => analog,
            Phase::Running => match stream::next(&mut self.queues) {
                Next::Point(point) => point,
                end => {
                    if end == Next::Underrun {
                        self.standing.trip = Some(Trip::Underrun);
                    }
                    self.bring_to_stand();
                    self.reference
                }
            },
            Phase::Stopping => self.stop.step().unwrap_or_else(|| {
                self.enter(Phase::Idle);
                self.safe = SafeRamp::new(self.output, &self.setup.wiring, self.setup.control.rate);
                self.reference
            }),
            Phase::Armed | Phase::Idle | Phase::Tripped => self.reference,
        }
    }

    /// What the core makes of the sample; none while the relay is open.
    #[inline]
    fn decide(&mut self, mut sample: Sample, passed: f32) -> Option<(Sample, Command, f32)> {
        let reference = self.next_reference(sample.reference);
        if matches!(self.standing.phase, Phase::Idle | Phase::Tripped) {
            return None;
        }
        self.change = reference - self.reference;
        self.reference = reference;
        sample.reference = reference;
        let command = self.controller.step(&sample);
        let out = match self.setup.wiring.role {
            Role::Guard => passed,
            Role::Modifier => command.reference,
            Role::Controller => command.valve,
        };
        Some((sample, command, out))
    }

    /// Writes the output and the record.
    #[inline]
    fn conclude(&mut self, inputs: [u16; 4], decision: Option<(Sample, Command, f32)>, rate: Option<u32>) -> Outcome {
        let wiring = &self.setup.wiring;
        self.output = match (decision, self.probe) {
            (Some((_, _, out)), _) => to_code(out, wiring),
            (None, Some(code)) => code.min(wiring.full_scale),
            (None, None) => self.safe.step(wiring, self.displacement),
        };
        if self.setup.telemetry_every > 0 {
            if self.until_record == 0 {
                self.until_record = self.setup.telemetry_every;
                self.report(inputs, decision);
            }
            self.until_record -= 1;
        }
        self.tick = self.tick.wrapping_add(1);
        let safe = target(&self.setup.wiring, self.displacement);
        Outcome { output: self.output, safe, relay: decision.is_some(), rate }
    }

    #[inline]
    fn report(&mut self, inputs: [u16; 4], decision: Option<(Sample, Command, f32)>) {
        let mut record = Record { inputs, output: self.output, ..Record::default() };
        if let Some((sample, command, _)) = decision {
            record.reference = sample.reference;
            record.fitted = command.reference;
            record.flags = u16::from(command.status.saturated) | u16::from(command.status.held) << 1;
        }
        let entry = Entry { tick: self.tick, phase: self.standing.phase, record };
        if self.queues.records.enqueue(entry).is_err() {
            self.dropped = self.dropped.wrapping_add(1);
        }
    }
}
