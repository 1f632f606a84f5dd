//! The only entry point: one sample in, one command out.
//!
//! ```text
//! input gate -> observer, monitors -> state machine -> target -> record modifier -> law -> limits -> output
//! ```
//! An output is zero flow plus a flow command: what the valve passes no oil at (the null bias, and the LVDT's reading where
//! an inner loop subtracts it, Fig. 2) and what is asked for beyond. A trip, a blend and a limit act on the latter only,
//! so that each of them means the same for every wiring.
//!
//! A needed input that is not a believable number holds the last output for this tick and says so in the status; the
//! guard, if there is one, goes on with the sensors that remain, and trips when it lasts.

mod blend;
mod coast;
mod config;
mod law;
mod monitors;
mod tuning;

use blend::Blend;
pub(crate) use config::Config;
use config::{Law, ModeConfig};
use law::{ThreeVariableState, track};
use monitors::{MonitorInput, Monitors};
pub use tuning::Tuning;

use crate::control::{Blocked, TrackingState};
use crate::guard::{OperatorRequest, Refused, State, Supervisor, Trip};
use crate::modifier::{Modifier, ModifierState};
use crate::sample::{Channels, Command, Relay, Sample, Status};
use crate::scalar::Scalar;
use crate::settings::{Settings, SettingsError};

/// What a mode asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Asked {
    /// Flow command, m.
    flow: f32,
    /// The output that is exactly that, m: `zero + (external - zero)` would not be `external` to the last bit.
    output: f32,
}

/// The whole control law.
///
/// ```
/// use shakedown_core::{Controller, Relay, Sample, Settings};
///
/// let mut controller = Controller::new(&Settings::default())?;
/// // A reference of 10 mm, the table at 0: the paper's proportional gain asks for 37 mm.
/// let command = controller.step(&Sample::new(0.01, 0.0, 0.0));
/// assert!((command.valve - 0.037).abs() < 1e-3);
/// assert_eq!(command.status.relay, Relay::Closed); // without a guard it runs from the first tick
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Controller {
    config: Config,
    /// The last believable reading of every channel.
    readings: Sample,
    monitors: Monitors,
    supervisor: Supervisor,
    modifier: ModifierState,
    three_variable: ThreeVariableState,
    tracking: TrackingState,
    blend: Blend,
    /// Where the reference stands while the test is faded out, m.
    anchor: f32,
    /// What the record modifier was last given, m.
    target: f32,
    /// The reference after modification, m.
    reference: f32,
    /// Last output, m, and its flow command, m.
    output: f32,
    flow_command: f32,
    /// Whether the command was at its limit.
    limited: bool,
    /// Whether every needed channel has been read at least once.
    begun: bool,
    /// Whether ticks have passed that the record modifier was not given.
    gap: bool,
}

impl Controller {
    /// A controller at rest, if the settings hold. With a guard it is off, and moves nothing before it is armed and
    /// started; without one it runs.
    pub fn new(settings: &Settings) -> Result<Self, SettingsError> {
        let mut controller = Self::inert();
        controller.retune(settings)?;
        Ok(controller)
    }

    /// A controller that has no settings yet: it is off, asks for nothing and refuses every request. [`Self::retune`] makes
    /// it what [`Self::new`] gives, in the place where it lies: a small target has no stack for a second one.
    pub fn inert() -> Self {
        Self {
            config: Config::idle(),
            readings: Sample::default(),
            monitors: Monitors::new(0.0),
            supervisor: Supervisor::off(),
            modifier: ModifierState::Off,
            three_variable: ThreeVariableState::default(),
            tracking: TrackingState::default(),
            blend: Blend::default(),
            anchor: 0.0,
            target: 0.0,
            reference: 0.0,
            output: 0.0,
            flow_command: 0.0,
            limited: false,
            begun: false,
            gap: false,
        }
    }

    /// Asks for a change of state, for instance [`OperatorRequest::Arm`] and then [`OperatorRequest::Start`].
    pub fn request(&mut self, request: OperatorRequest) -> Result<(), Refused> {
        if self.config.ramps.is_none() {
            return Err(Refused::NoGuard);
        }
        let held = self.state() == State::Off;
        if let (OperatorRequest::Arm, Some(cause)) = (request, self.monitors.cause(&self.config.monitors, held)) {
            return Err(Refused::Cause(cause));
        }
        let whole = self.supervisor.whole();
        self.supervisor.request(request)?;
        match request {
            OperatorRequest::Arm => {
                self.monitors.arm();
                self.start_at(self.readings.displacement);
            }
            OperatorRequest::Hold | OperatorRequest::Stop if whole => self.anchor = self.target,
            _ => {}
        }
        Ok(())
    }

    /// Puts the law at rest with the reference at `displacement` (m).
    #[cold]
    fn start_at(&mut self, displacement: f32) {
        (self.anchor, self.target, self.reference) = (displacement, displacement, displacement);
        self.three_variable = ThreeVariableState::at(displacement);
        self.tracking = TrackingState::at(displacement);
        if let Some(modifier) = self.config.mode.modifier() {
            modifier.restart(&mut self.modifier, displacement);
        }
        self.blend = Blend::default();
        (self.gap, self.limited) = (false, false);
    }

    /// Where the test stands; always running without a guard.
    pub const fn state(&self) -> State {
        self.supervisor.state()
    }

    /// Why the guard tripped, until it is reset.
    pub const fn trip(&self) -> Option<Trip> {
        self.supervisor.cause()
    }

    /// What the relay of the hydraulic block is to do.
    pub const fn relay(&self) -> Relay {
        self.supervisor.relay()
    }

    /// How often [`Controller::state`] or [`Controller::trip`] have changed, modulo 256.
    pub const fn changes(&self) -> u8 {
        self.supervisor.changes()
    }

    /// One tick: measure, decide, command.
    pub fn step(&mut self, sample: &Sample) -> Command {
        let missing = self.config.gate.take(sample, &mut self.readings);
        if self.begin(missing) {
            let cause = self.monitor(missing);
            self.supervise(missing, cause);
            if !self.supervisor.moves() {
                self.ramp_to_zero_flow();
            } else if missing.is_empty() {
                let target = self.target();
                let reference = self.modify(target);
                let asked = self.ask(reference);
                self.put_out(asked);
            } else {
                // The last output is held.
                self.gap = true;
            }
        }
        self.command(missing)
    }

    /// Whether every needed channel has been there; until then nothing moves.
    fn begin(&mut self, missing: Channels) -> bool {
        if !self.begun && missing.is_empty() {
            self.begun = true;
            self.monitors.begin(self.readings.displacement);
            self.start_at(self.readings.reference);
        }
        self.begun
    }

    /// Observer and monitors: why the guard should trip. What the test asked for is asked for no more, as far as the safe ramp
    /// has come.
    fn monitor(&mut self, missing: Channels) -> Option<Trip> {
        let moves = self.supervisor.moves();
        let input = MonitorInput {
            reference: if moves { self.reference } else { self.readings.displacement },
            flow_command: if moves { self.flow_command } else { self.flow_command * self.supervisor.command() },
            moves,
            relay: self.supervisor.relay(),
        };
        self.monitors.step(&self.config.monitors, missing, &self.readings, input)
    }

    /// State machine: takes up what the monitors found, and moves the ramps on.
    fn supervise(&mut self, missing: Channels, cause: Option<Trip>) {
        let Some(ramps) = self.config.ramps else { return };
        if let Some(cause) = cause {
            self.supervisor.doubt(cause);
        }
        // After a trip of any cause no command is known to stop the table where the valve is not believed, or where what is behind the
        // device subtracts an LVDT (Fig. 2, or an existing position controller) that is lost or not believed: a ramp would end at some
        // command.
        let doubted = |of: fn(Trip) -> bool| cause.is_some_and(of) || self.monitors.found().is_some_and(of);
        let lost = missing.intersects(Channels::DISPLACEMENT) || doubted(Trip::doubts_displacement);
        if doubted(Trip::doubts_valve) || (lost && self.config.cancellation != 0.0) {
            self.supervisor.open_relay_at_once();
        }
        self.supervisor.advance(ramps);
    }

    /// The output at which no oil flows, m.
    fn zero_flow(&self) -> f32 {
        self.config.cancellation * self.readings.displacement + self.config.null_bias
    }

    /// The safe ramp: what was asked for at the trip, let go.
    fn ramp_to_zero_flow(&mut self) {
        // Beyond wide open the command could fall a long way without slowing the table.
        self.flow_command = self.flow_command.bounded(self.config.wide_open);
        self.output = self.zero_flow() + self.supervisor.command() * self.flow_command;
    }

    /// The reference as the test's ramps let it through, m.
    fn target(&self) -> f32 {
        let reference = self.readings.reference;
        if self.supervisor.steady() {
            reference
        } else {
            self.anchor + self.supervisor.test_weight() * (reference - self.anchor)
        }
    }

    /// The `target` (m) as the record modifier lets it through, m; in guard mode there is none.
    fn modify(&mut self, target: f32) -> f32 {
        if let Some(modifier) = self.config.mode.modifier() {
            self.target = target;
            if self.gap {
                Modifier::resume(&mut self.modifier, target);
                self.gap = false;
            }
            self.reference = modifier.advance(&mut self.modifier, target, self.monitors.velocity_limit());
        }
        self.reference
    }

    /// Law: what the mode asks for.
    fn ask(&mut self, reference: f32) -> Asked {
        let zero = self.zero_flow();
        let blocked = self.blocked();
        let passed = |output: f32| Asked { flow: output - zero, output };
        let flow = match &self.config.mode {
            ModeConfig::Guard => return passed(self.readings.external),
            ModeConfig::Modifier(_) => return passed(reference),
            ModeConfig::Controller(_, Law::Tracking(law)) => track(law, &mut self.tracking, reference, &self.readings),
            ModeConfig::Controller(_, Law::ThreeVariable(law)) => {
                let velocity = self.monitors.velocity(&self.config.monitors, &self.readings);
                law.step(&mut self.three_variable, reference, &self.readings, velocity, blocked)
            }
        };
        Asked { flow, output: zero + flow }
    }

    /// The direction in which integrators must not go on.
    fn blocked(&self) -> Blocked {
        if !self.config.anti_windup {
            Blocked::Neither
        } else if !self.limited {
            self.monitors.blocked()
        } else if self.flow_command > 0.0 {
            Blocked::Positive
        } else {
            Blocked::Negative
        }
    }

    /// Limits and output: what was `asked` for. The ramps of the test fade an existing controller's command, and what is left of
    /// the output before a change of settings is blended out.
    fn put_out(&mut self, asked: Asked) {
        let zero = self.zero_flow();
        let fades = matches!(self.config.mode, ModeConfig::Guard) && !self.supervisor.steady();
        let faded = if fades { self.supervisor.test_weight() * asked.flow } else { asked.flow };
        let flow = self.blend.step(faded, self.output - zero, self.config.blend_step);
        self.limited = !self.config.within.holds(flow);
        if flow.is_nan() {
            // No input makes the law's state other than a number, but a flipped bit might.
            self.start_at(self.readings.displacement);
            if self.config.ramps.is_some() {
                self.supervisor.trip(Trip::Internal);
            }
        } else if self.limited {
            self.flow_command = flow.bounded(self.config.command_limit);
            self.output = zero + self.flow_command;
        } else {
            self.flow_command = flow;
            self.output = if flow == asked.flow { asked.output } else { zero + flow };
        }
    }

    /// The command, and what happened in the tick that `missing` is from.
    fn command(&self, missing: Channels) -> Command {
        Command {
            valve: self.output,
            reference: self.reference,
            status: Status {
                saturated: self.monitors.saturated(),
                held: !missing.is_empty(),
                missing,
                limited: self.limited,
                velocity_limit: self.monitors.velocity_limit(),
                state: self.supervisor.state(),
                trip: self.supervisor.cause(),
                relay: self.supervisor.relay(),
            },
        }
    }
}
