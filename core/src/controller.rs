//! The only entry point: one sample in, one command out.
//!
//! ```text
//! walls -> observer -> saturation, guard -> state machine -> target -> record modifier -> laws -> limits -> output
//! ```
//! An output is zero flow plus a command: what the valve passes no oil at (the null bias, and the LVDT's reading where
//! an inner loop subtracts it, Fig. 2) and what is asked for beyond. A trip, a blend and a limit act on the latter only,
//! so that each of them means the same for every wiring.
//!
//! A needed input that is not a believable number holds the last output for this tick and says so in the status; the
//! guard, if there is one, goes on with the sensors that remain, and trips when it lasts.

mod config;
mod law;
mod watch;

pub(crate) use config::Config;
use law::Law;
use watch::Watch;

use crate::guard::{Refused, Request, State, Supervisor, Trip};
use crate::modifier::ModifierState;
use crate::sample::{Channels, Command, Relay, Sample, Status};
use crate::scalar::Scalar;
use crate::settings::{Mode, Settings, SettingsError};

/// The whole control law.
#[derive(Debug, Clone)]
pub struct Controller {
    config: Config,
    /// The last believable reading of every channel.
    readings: Sample,
    watch: Watch,
    law: Law,
    modifier: ModifierState,
    /// None without a guard: always running.
    supervisor: Option<Supervisor>,
    blend: Blend,
    /// Where the reference stands while the test is faded out, m.
    anchor: f32,
    /// What the record modifier was last given, m.
    target: f32,
    /// The reference after modification, m; none before the first tick.
    reference: Option<f32>,
    /// Last output, m, and its part beyond zero flow, m.
    output: f32,
    excess: f32,
    limited: bool,
}

/// What is left of the output before a change of settings.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Blend {
    offset: f32,
    weight: f32,
    pending: bool,
}

impl Controller {
    /// A controller at rest, if the settings hold. With a guard it is off, and moves nothing before it is armed and
    /// started; without one it runs.
    pub fn new(settings: &Settings) -> Result<Self, SettingsError> {
        let config = Config::new(settings)?;
        Ok(Self {
            readings: Sample::default(),
            watch: Watch::new(&config),
            law: Law::default(),
            modifier: config.modifier.start(0.0),
            supervisor: config.guard.is_some().then(Supervisor::off),
            blend: Blend { offset: 0.0, weight: 0.0, pending: false },
            anchor: 0.0,
            target: 0.0,
            reference: None,
            output: 0.0,
            excess: 0.0,
            limited: false,
            config,
        })
    }

    /// Exchanges the settings between two ticks, whole or not at all, while the state goes on. The output does not jump:
    /// what it would jump by is taken up and let go over [`Settings::blend`]. A change of mode is the same thing.
    /// Settings with a guard put a controller that had none off, and the other way round is refused while not off.
    pub fn retune(&mut self, settings: &Settings) -> Result<(), SettingsError> {
        let config = Config::new(settings)?;
        match (&self.supervisor, &config.guard) {
            (Some(supervisor), None) if supervisor.state() != State::Off => {
                return Err(SettingsError::Contradiction { field: "guard", with: "a test that is not off" });
            }
            (Some(_), None) => self.supervisor = None,
            (None, Some(_)) => self.supervisor = Some(Supervisor::off()),
            _ => {}
        }
        self.watch.retune(&config, &self.config);
        if !config.modifier.owns(&self.modifier) {
            self.modifier = config.modifier.start(self.reference.unwrap_or(self.readings.displacement));
        }
        self.blend.pending = self.reference.is_some();
        self.config = config;
        Ok(())
    }

    /// Asks for a change of state, for instance [`Request::Arm`] and then [`Request::Start`].
    pub fn request(&mut self, request: Request) -> Result<(), Refused> {
        let Some(supervisor) = &mut self.supervisor else { return Err(Refused::NoGuard) };
        if request == Request::Arm
            && let Some(cause) = self.watch.cause()
        {
            return Err(Refused::Cause(cause));
        }
        let whole = supervisor.whole();
        supervisor.request(request)?;
        match request {
            Request::Arm => self.start_at(self.readings.displacement),
            Request::Hold | Request::Stop if whole => self.anchor = self.target,
            _ => {}
        }
        Ok(())
    }

    /// Puts the law at rest with the reference standing at `displacement` (m).
    fn start_at(&mut self, displacement: f32) {
        self.anchor = displacement;
        self.target = displacement;
        self.law = Law::default();
        self.modifier = self.config.modifier.start(displacement);
        self.blend = Blend { offset: 0.0, weight: 0.0, pending: false };
        self.reference = Some(displacement);
        self.limited = false;
    }

    /// One tick: measure, decide, command.
    pub fn step(&mut self, sample: &Sample) -> Command {
        let missing = self.config.walls.take(sample, &mut self.readings);
        if self.reference.is_none() && missing.is_empty() {
            self.modifier = self.config.modifier.start(self.readings.reference);
            self.reference = Some(self.readings.reference);
        }
        let cause = self.watch(missing);
        let moves = match (&mut self.supervisor, &self.config.guard) {
            (Some(supervisor), Some(guard)) => {
                if let Some(cause) = cause
                    && supervisor.moves()
                {
                    supervisor.trip(cause);
                }
                supervisor.advance(&guard.ramps);
                supervisor.moves()
            }
            _ => true,
        };
        if !moves {
            self.make_safe();
        } else if missing.is_empty() {
            self.decide();
        }
        self.command(missing)
    }

    /// What the sensors say of the table, the valve and themselves.
    #[inline]
    fn watch(&mut self, missing: Channels) -> Option<Trip> {
        let (error, demand) = match self.config.mode {
            Mode::Guard => (self.excess, self.excess * self.config.valve_gain),
            Mode::Controller => {
                (self.reference.unwrap_or(0.0) - self.readings.displacement, self.excess * self.config.valve_gain)
            }
            Mode::Modifier => {
                (self.reference.unwrap_or(0.0) - self.readings.displacement, self.law.reference_velocity())
            }
        };
        self.watch.step(&self.config, &self.readings, missing, error, demand)
    }

    /// The output at which no oil flows, m.
    #[inline]
    fn zero_flow(&self) -> f32 {
        match self.config.mode {
            // An existing position controller subtracts the LVDT.
            Mode::Modifier => self.readings.displacement,
            _ => self.config.inner_loop.cancellation(self.readings.displacement) + self.config.null_bias,
        }
    }

    /// The safe ramp: what was asked for at the trip, let go.
    fn make_safe(&mut self) {
        let left = self.supervisor.map_or(0.0, |supervisor| supervisor.command());
        // Beyond wide open the command could fall a long way without slowing the table.
        self.excess = self.excess.within(-self.config.wide_open, self.config.wide_open);
        self.output = self.zero_flow() + left * self.excess;
    }

    /// The output of the mode, all inputs being good.
    fn decide(&mut self) {
        let zero = self.zero_flow();
        let (asked, whole) = match self.config.mode {
            Mode::Guard => (self.readings.external - zero, self.readings.external),
            Mode::Modifier => {
                let reference = self.fit_reference();
                (reference - zero, reference)
            }
            Mode::Controller => {
                let reference = self.fit_reference();
                let blocked = self.watch.blocked(&self.config, self.limited, self.excess);
                let asked = self.law.step(&self.config, reference, &self.readings, self.watch.velocity(), blocked);
                (asked, zero + asked)
            }
        };
        let faded = match &self.supervisor {
            Some(supervisor) if self.config.mode == Mode::Guard && !supervisor.whole() => supervisor.presence() * asked,
            _ => asked,
        };
        let blended = self.blend(faded, zero);
        let limit = self.config.command_limit;
        let excess = blended.within(-limit, limit);
        if excess.is_nan() {
            self.recover();
            return;
        }
        self.limited = excess != blended;
        self.excess = excess;
        // What nothing acts on passes to the last bit, which `zero + (external - zero)` would not.
        self.output = if excess == asked { whole } else { zero + excess };
    }

    /// The reference as the test's ramps and the record modifier let it through, m.
    #[inline]
    fn fit_reference(&mut self) -> f32 {
        self.target = match &self.supervisor {
            Some(supervisor) if !supervisor.whole() => {
                self.anchor + supervisor.presence() * (self.readings.reference - self.anchor)
            }
            _ => self.readings.reference,
        };
        let limit = self.watch.velocity_limit(&self.config);
        let reference = self.config.modifier.advance(&mut self.modifier, self.target, limit);
        self.law.see_reference(&self.config, reference, self.reference.unwrap_or(reference));
        self.reference = Some(reference);
        reference
    }

    /// Takes up what a change of settings would make the command jump by, and lets it go.
    #[inline]
    fn blend(&mut self, asked: f32, zero: f32) -> f32 {
        if self.blend.pending {
            self.blend = Blend { offset: self.output - zero - asked, weight: 1.0, pending: false };
        }
        if self.blend.weight <= 0.0 {
            return asked;
        }
        let w = self.blend.weight;
        self.blend.weight = w - self.config.blend_step;
        asked + self.blend.offset * (w * w * (3.0 - 2.0 * w))
    }

    /// The law's state was not a number. No input does this; a flipped bit might.
    #[cold]
    fn recover(&mut self) {
        self.start_at(self.readings.displacement);
        if let Some(supervisor) = &mut self.supervisor {
            supervisor.trip(Trip::Internal);
        }
    }

    #[inline]
    fn command(&self, missing: Channels) -> Command {
        let (state, trip, relay) = match &self.supervisor {
            Some(supervisor) => (supervisor.state(), supervisor.cause(), supervisor.relay()),
            None => (State::Running, None, Relay::Closed),
        };
        Command {
            valve: self.output,
            reference: self.reference.unwrap_or(0.0),
            status: Status {
                saturated: self.watch.saturated(),
                held: !missing.is_empty(),
                missing,
                limited: self.limited,
                velocity_limit: self.watch.velocity_limit(&self.config),
                state,
                trip,
                relay,
            },
        }
    }
}
