//! One run: the core in charge of a table, what surrounds it as the board does, and the fault.

mod signals;

use super::case::Case;
use super::class::Fault;
use super::dice::FaultRng;
use super::feed::Feed;
use super::machine::Machine;
use super::settings;
use super::spoil::Spoiled;
use crate::plant::sensors::{SensorModel, Sensors};
use shakedown_core::{Command, Controller, OperatorRequest, Relay, Sample, Settings, SettingsError, State, Trip};
use signals::Active;

/// A tick as an onlooker sees it who knows the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruthSample {
    /// Tick.
    pub tick: usize,
    /// Time, s.
    pub time: f64,
    /// Displacement of the table, m.
    pub x: f64,
    /// Its velocity, m/s.
    pub v: f64,
    /// LVDT's reading less the truth, m; not a number where there is none.
    pub displacement_error: f64,
    /// Accelerometer's reading less the truth, m/s2.
    pub acceleration_error: f64,
    /// Way that the command does not explain since the valve or the supply failed, m.
    pub unexplained: f64,
    /// Reference after modification, m.
    pub reference: f64,
    /// Whether a payload that came off has a blow left.
    pub knocked: bool,
    /// What the core put out, m.
    pub output: f64,
    /// What the LVDT said, m.
    pub measured: f64,
    /// Where the test stands.
    pub state: State,
    /// Why it tripped.
    pub trip: Option<Trip>,
    /// The relay.
    pub relay: Relay,
}

/// A run under way.
#[derive(Clone)]
struct Rig<'a> {
    case: &'a Case,
    /// Ticks a second, 1/s.
    rate: f64,
    /// Whether its faults begin in their turn.
    faulty: bool,
    active: Vec<Active>,
    controller: Controller,
    machine: Machine,
    sensors: Sensors,
    feed: Option<Feed<'a>>,
    dice: FaultRng,
    time: f64,
    velocity_before: f64,
    last: Option<TruthSample>,
    reference: f32,
    /// Ticks that the table has been at a limit switch.
    at_switch: u32,
    /// What a loop behind the device that shares its LVDT reads, m.
    shared: f64,
}

/// Why a run could not begin: the campaign's own settings do not hold.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("run {number}: {cause}")]
pub struct RigError {
    /// The run.
    pub number: u64,
    /// Why.
    pub cause: SettingsError,
}

/// A run and the same without its fault: every tick, and where the table would have been, m.
#[derive(Debug, Clone, Default)]
pub struct Pair {
    /// The run, until it ends or has stood for a while after a trip.
    pub seen: Vec<TruthSample>,
    /// The table without the fault, m, as long.
    pub without: Vec<f64>,
    /// Where the test without the fault stands.
    pub expected: Vec<State>,
}

/// From a table at a limit switch to its circuit open, s: a roller's way, and the contact's own.
const CONTACT: f64 = 0.005;

/// How long a run goes on after a trip, and after the last blow of a payload, s.
pub const AFTER: f64 = 0.8;

/// Runs `case` with its fault and without; they are one up to the fault.
pub fn run(case: &Case) -> Result<Pair, RigError> {
    let mut rig = Rig::new(case)?;
    let mut pair = Pair::default();
    for tick in 0..case.onset.min(case.ticks()) {
        let seen = rig.tick(tick);
        pair.push(seen, &seen);
    }
    let mut twin = rig.clone();
    rig.faulty = true;
    let mut left = (AFTER * rig.rate) as usize;
    for tick in case.onset..case.ticks() {
        let seen = rig.tick(tick);
        left -= usize::from(seen.trip.is_some() && !seen.knocked);
        pair.push(seen, &twin.tick(tick));
        if left == 0 {
            break;
        }
    }
    Ok(pair)
}

impl Pair {
    fn push(&mut self, seen: TruthSample, twin: &TruthSample) {
        self.without.push(twin.x);
        self.expected.push(twin.state);
        self.seen.push(seen);
    }
}

impl<'a> Rig<'a> {
    fn new(case: &'a Case) -> Result<Self, RigError> {
        let controller = Controller::new(&case.settings).map_err(|cause| RigError { number: case.number, cause })?;
        let start = case.reference.first().copied().unwrap_or(0.0);
        let mut machine = Machine::new(case.table, start);
        machine.block = case.block;
        let arm = case.orders.first().map_or(0, |(tick, _)| *tick);
        Ok(Self {
            case,
            rate: case.rate(),
            faulty: false,
            active: Vec::new(),
            controller,
            machine,
            sensors: Sensors::new(SensorModel::laboratory(case.noise)),
            feed: case.streamed.then(|| Feed::new(case.reference.get(arm..).unwrap_or_default())),
            dice: case.dice.clone(),
            time: 0.0,
            velocity_before: 0.0,
            last: None,
            reference: start as f32,
            at_switch: 0,
            shared: start,
        })
    }

    /// Begins the faults whose tick it is.
    fn begin(&mut self, tick: usize) {
        let case = self.case;
        if tick == case.onset {
            self.fail(case.fault);
            if matches!(case.fault, Fault::Welded) {
                let _ = self.controller.request(OperatorRequest::Trip);
            }
        }
        if let Some((fault, onset)) = case.second
            && tick == onset
        {
            self.fail(fault);
        }
    }

    fn fail(&mut self, fault: Fault) {
        let spoiled = match fault {
            Fault::Signal(_, how) | Fault::Shared(how) => Some(Spoiled::new(how, 1.0 / self.rate)),
            _ => None,
        };
        self.active.push(Active { fault, spoiled });
        match fault {
            Fault::Table(how) | Fault::Behind(how) => self.machine.fail(how),
            Fault::Welded => self.machine.welded = true,
            Fault::Block(latency) => self.machine.block = latency,
            Fault::Missed(length) => {
                (0..(1e-3 * f64::from(length) * self.rate).ceil() as u32).for_each(|_| self.coast());
                // As the firmware does when the board tells it of an overrun.
                let _ = self.controller.request(OperatorRequest::Trip);
            }
            Fault::SettingsGarbled(bits) => {
                let taken = settings::garbled(&self.case.settings, bits, &mut self.dice);
                self.retune(taken.as_ref());
            }
            Fault::SettingsNonsense => {
                let settings = settings::nonsense(&self.case.settings, &mut self.dice);
                self.retune(settings.as_ref());
            }
            Fault::SettingsWrong(factor) => {
                let settings = settings::wrong(&self.case.settings, factor, &mut self.dice);
                self.retune(Some(&settings));
            }
            _ => {}
        }
    }

    /// Hands settings to the core. Refused or not: what matters is what the table does.
    fn retune(&mut self, settings: Option<&Settings>) {
        if let Some(settings) = settings {
            let _ = self.controller.retune(settings);
        }
    }

    fn tick(&mut self, tick: usize) -> TruthSample {
        for (_, order) in self.case.orders.iter().filter(|(at, _)| *at == tick) {
            // Refused only where the guard has a reason, which is then what the watcher is shown.
            let _ = self.controller.request(*order);
        }
        if self.faulty {
            self.begin(tick);
        }
        self.limit_switches();
        let (sample, errors) = self.measure(tick);
        let command = self.controller.step(&sample);
        let dt = self.length();
        let valve = self.valve(f64::from(command.valve));
        self.velocity_before = self.machine.v;
        self.machine.advance(valve, command.status.relay == Relay::Open, dt);
        self.time += dt;
        let seen = self.seen(tick, &sample, &command, errors);
        self.last = Some(seen);
        seen
    }

    /// Length of this tick, s.
    fn length(&mut self) -> f64 {
        let jitter = self.active.iter().find_map(|active| match active.fault {
            Fault::Jitter(share) => Some(share),
            _ => None,
        });
        jitter.map_or(1.0, |share| 1.0 + self.dice.uniform(-share, share)) / self.rate
    }

    /// The emergency-stop circuit, which the board looks at in every tick.
    fn limit_switches(&mut self) {
        let at_switch = self.case.limit_switches.is_some_and(|from| self.machine.x.abs() > from);
        self.at_switch = if at_switch { self.at_switch + 1 } else { 0 };
        if f64::from(self.at_switch) > CONTACT * self.rate {
            let _ = self.controller.request(OperatorRequest::Trip);
        }
    }

    fn seen(&self, tick: usize, sample: &Sample, command: &Command, errors: [f64; 2]) -> TruthSample {
        TruthSample {
            tick,
            time: self.time,
            x: self.machine.x,
            v: self.machine.v,
            displacement_error: errors[0],
            acceleration_error: errors[1],
            unexplained: self.machine.unexplained,
            reference: f64::from(command.reference),
            knocked: self.machine.knocked(),
            output: f64::from(command.valve),
            measured: f64::from(sample.displacement),
            state: command.status.state,
            trip: command.status.trip,
            relay: command.status.relay,
        }
    }

    /// A tick that does not run: the output stands.
    fn coast(&mut self) {
        let (output, open) = self.last.map_or((0.0, true), |seen| (seen.output, seen.relay == Relay::Open));
        let valve = self.valve(output);
        self.machine.advance(valve, open, 1.0 / self.rate);
        self.time += 1.0 / self.rate;
    }
}
