//! One run: the core in charge of a table, what surrounds it as the board does, and the fault.

use super::case::{Case, REST, TICKS};
use super::class::{Channel, Fault};
use super::dice::Dice;
use super::feed::{Feed, Line};
use super::machine::Machine;
use super::motions::RATE;
use super::settings;
use super::spoil::Spoiled;
use crate::plant::sensors::{SensorModel, Sensors};
use shakedown_core::{Command, Controller, Mode, OperatorRequest, Relay, Sample, Settings, SettingsError, State, Trip};

/// A tick as an onlooker sees it who knows the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
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
    fault: Fault,
    controller: Controller,
    machine: Machine,
    sensors: Sensors,
    spoiled: Option<Spoiled>,
    feed: Option<Feed<'a>>,
    dice: Dice,
    time: f64,
    velocity_before: f64,
    last: Option<Seen>,
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
    pub seen: Vec<Seen>,
    /// The table without the fault, m, as long.
    pub without: Vec<f64>,
}

/// From a table at a limit switch to its circuit open, ticks: a roller's way, and the contact's own.
const CONTACT: u32 = 5;

/// What a loop behind the device reads of a broken wire, m: the end of its converter.
const RAIL: f64 = 0.16;

/// How long a run goes on after a trip, s.
pub const AFTER: f64 = 0.8;

/// Runs `case` with its fault and without; they are one up to the fault.
pub fn run(case: &Case) -> Result<Pair, RigError> {
    let mut rig = Rig::new(case)?;
    let mut pair = Pair { seen: Vec::with_capacity(TICKS), without: Vec::with_capacity(TICKS) };
    for tick in 0..case.onset {
        let seen = rig.tick(tick);
        pair.without.push(seen.x);
        pair.seen.push(seen);
    }
    let mut twin = rig.clone();
    rig.fault = case.fault;
    rig.begin();
    let mut left = (AFTER * RATE) as usize;
    for tick in case.onset..TICKS {
        let seen = rig.tick(tick);
        left -= usize::from(seen.trip.is_some());
        pair.seen.push(seen);
        pair.without.push(twin.tick(tick).x);
        if left == 0 {
            break;
        }
    }
    Ok(pair)
}

impl<'a> Rig<'a> {
    fn new(case: &'a Case) -> Result<Self, RigError> {
        let controller = Controller::new(&case.settings).map_err(|cause| RigError { number: case.number, cause })?;
        let start = case.reference.first().copied().unwrap_or(0.0);
        Ok(Self {
            case,
            fault: Fault::None,
            controller,
            machine: Machine::new(case.table, start),
            sensors: Sensors::new(SensorModel::laboratory(case.noise)),
            spoiled: None,
            feed: case.streamed.then(|| Feed::new(case.reference.get(REST..).unwrap_or_default())),
            dice: case.dice.clone(),
            time: 0.0,
            velocity_before: 0.0,
            last: None,
            reference: start as f32,
            at_switch: 0,
            shared: start,
        })
    }

    /// The fault begins.
    fn begin(&mut self) {
        match self.fault {
            Fault::Signal(_, how) | Fault::Shared(how) => self.spoiled = Some(Spoiled::new(how, 1.0 / RATE)),
            Fault::Table(how) | Fault::Behind(how) => self.machine.fail(how),
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

    fn tick(&mut self, tick: usize) -> Seen {
        if tick == REST {
            // Refused only where the guard has a reason, which is then what the watcher is shown.
            let _ = self.controller.request(OperatorRequest::Arm);
            let _ = self.controller.request(OperatorRequest::Start);
        }
        let faulty = tick >= self.case.onset;
        if let Fault::Missed(count) = self.fault
            && tick == self.case.onset
        {
            (0..count).for_each(|_| self.coast());
            // As the firmware does when the board tells it of an overrun.
            let _ = self.controller.request(OperatorRequest::Trip);
        }
        self.limit_switches();
        let (sample, errors) = self.measure(tick, faulty);
        let command = self.controller.step(&sample);
        let dt = match self.fault {
            Fault::Jitter(share) if faulty => (1.0 + self.dice.uniform(-share, share)) / RATE,
            _ => 1.0 / RATE,
        };
        let valve = self.valve(f64::from(command.valve));
        self.velocity_before = self.machine.v;
        self.machine.advance(valve, command.status.relay == Relay::Open, dt);
        self.time += dt;
        let seen = self.seen(tick, &sample, &command, errors);
        self.last = Some(seen);
        seen
    }

    /// The emergency-stop circuit, which the board looks at in every tick.
    fn limit_switches(&mut self) {
        let at_switch = self.case.limit_switches.is_some_and(|from| self.machine.x.abs() > from);
        self.at_switch = if at_switch { self.at_switch + 1 } else { 0 };
        if self.at_switch > CONTACT {
            let _ = self.controller.request(OperatorRequest::Trip);
        }
    }

    fn seen(&self, tick: usize, sample: &Sample, command: &Command, errors: [f64; 2]) -> Seen {
        Seen {
            tick,
            time: self.time,
            x: self.machine.x,
            v: self.machine.v,
            displacement_error: errors[0],
            acceleration_error: errors[1],
            unexplained: self.machine.unexplained,
            reference: f64::from(command.reference),
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
        self.machine.advance(valve, open, 1.0 / RATE);
        self.time += 1.0 / RATE;
    }

    /// What the valve gets of the core's output: in modifier mode an existing controller stands between, with an LVDT of its
    /// own or the device's; behind a device that cancels it, a hard-wired loop of unity gain over the device's.
    fn valve(&self, output: f64) -> f64 {
        let shares = matches!(self.case.fault, Fault::Shared(_));
        match self.case.settings.mode {
            Mode::Modifier => self.case.existing * (output - if shares { self.shared } else { self.machine.x }),
            Mode::Controller if shares => output - self.shared,
            _ => output,
        }
    }

    /// What the converters read, and by how much LVDT and accelerometer are wrong.
    fn measure(&mut self, tick: usize, faulty: bool) -> (Sample, [f64; 2]) {
        let truth = [self.machine.x, (self.machine.v - self.velocity_before) * RATE];
        let mut x = self.sensors.displacement(self.time, truth[0]);
        let mut a = self.sensors.acceleration(self.time, truth[1]);
        let wanted = self.case.reference.get(tick).copied().unwrap_or(0.0);
        // The existing controller closes its loop over its own reading of the same LVDT.
        let before = self.case.reference.get(tick.saturating_sub(1)).copied().unwrap_or(wanted);
        let fed = self.case.feed_forward * (wanted - before) * RATE;
        let mut external = self.case.existing * (wanted - x) + fed;
        let mut reference = if self.feed.is_some() { self.next_point(faulty) } else { wanted as f32 };
        if let (Some(spoiled), Fault::Signal(channel, _)) = (&mut self.spoiled, self.fault) {
            match channel {
                Channel::Displacement => x = spoiled.pass(x, &mut self.dice),
                Channel::Acceleration => a = spoiled.pass(a, &mut self.dice),
                Channel::Command if self.case.settings.mode == Mode::Guard => {
                    external = spoiled.pass(external, &mut self.dice);
                }
                Channel::Command => reference = spoiled.pass(wanted, &mut self.dice) as f32,
            }
            if channel == Channel::Displacement {
                external = self.case.existing * (wanted - x) + fed;
            }
        }
        if let (Some(spoiled), Fault::Shared(_)) = (&mut self.spoiled, self.fault) {
            x = spoiled.pass(x, &mut self.dice);
        }
        // A broken wire is pulled to the rail that drives the table outward.
        self.shared = if x.is_finite() { x } else { RAIL.copysign(-truth[0]) };
        let sample = Sample { external: external as f32, ..Sample::new(reference, x as f32, a as f32) };
        (sample, [x - truth[0], a - truth[1]])
    }

    /// The next point of the stream, as the firmware's loop takes it: its absence fades the test out.
    fn next_point(&mut self, faulty: bool) -> f32 {
        let line = match self.fault {
            Fault::LinkCut if faulty => Line::Cut,
            Fault::LinkGarbled(share) if faulty => Line::Garbled(share),
            _ => Line::Whole,
        };
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
