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

mod blend;
mod config;
mod law;
mod track;
mod watch;
use blend::Blend;
use law::Law;
use track::Tracker;
use watch::{Drive, Watch};
pub(crate) use {config::Config, track::tracking};

use crate::guard::{Refused, Request, State, Supervisor, Trip};
use crate::modifier::{Modifier, ModifierState};
use crate::sample::{Channels, Command, Course, Relay, Sample, Status};
use crate::scalar::Scalar;
use crate::settings::{Mode, Settings, SettingsError};

/// Whether the last tick ran whole, nothing missing, fading or blending, and no change was asked for since; and how much of
/// the configuration a tick then need not ask about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quiet {
    /// It did not.
    No,
    /// It did.
    Partly,
    /// And every part that looks on is in use.
    All,
    /// And the mode is [`Mode::Guard`], on the sensors that every table has.
    Guard,
}

/// The whole control law.
#[derive(Debug, Clone)]
// In this order, so that all that a tick touches lies within reach of one base register, and the long buffer behind it.
#[repr(C)]
pub struct Controller {
    config: Config,
    /// The last believable reading of every channel.
    readings: Sample,
    watch: Watch,
    law: Law,
    supervisor: Supervisor,
    blend: Blend,
    /// Where the reference stands while the test is faded out, m.
    anchor: f32,
    /// What the record modifier was last given, m.
    target: f32,
    /// The reference after modification, m.
    reference: f32,
    /// Last output, m.
    output: f32,
    /// Its part beyond zero flow, m.
    excess: f32,
    limited: bool,
    /// Whether [`Blend`] has anything to do.
    blending: bool,
    /// Whether every needed channel has been read at least once.
    begun: bool,
    tracker: Tracker,
    quiet: Quiet,
    /// Whether ticks have passed that the record modifier did not hear of.
    gap: bool,
    modifier: ModifierState,
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
        let config = Config::none();
        Self {
            readings: Sample::default(),
            watch: Watch::new(&config),
            law: Law::default(),
            supervisor: Supervisor::off(),
            blend: Blend::default(),
            anchor: 0.0,
            target: 0.0,
            reference: 0.0,
            output: 0.0,
            excess: 0.0,
            limited: false,
            blending: false,
            begun: false,
            tracker: Tracker::default(),
            quiet: Quiet::No,
            gap: false,
            modifier: ModifierState::Off,
            config,
        }
    }

    /// Exchanges the settings between two ticks, whole or not at all, while the state goes on. The output does not jump:
    /// what it would jump by is taken up and let go over [`Settings::blend`]. A change of mode is the same thing.
    /// Settings with a guard put a controller that had none off; the guard is not taken away from a test that is not off.
    pub fn retune(&mut self, settings: &Settings) -> Result<(), SettingsError> {
        let config = Config::new(settings)?;
        let law = tracking(settings)?;
        match (self.config.parts.guard, config.parts.guard) {
            (true, false) if self.supervisor.state() != State::Off => {
                return Err(SettingsError::Contradiction { field: "guard", with: "a test that is not off" });
            }
            (_, false) => self.supervisor = Supervisor::unguarded(),
            (false, true) => self.supervisor = Supervisor::off(),
            (true, true) => {}
        }
        if !self.begun {
            self.output = config.null_bias;
        }
        self.watch.retune(&config, &self.config);
        self.tracker.retune(law.as_ref(), self.readings.displacement);
        if !config.modifier.owns(&self.modifier) {
            config.modifier.restart(&mut self.modifier, self.reference);
        }
        self.blend.pending = self.begun;
        self.blending = self.begun;
        self.quiet = Quiet::No;
        self.config = config;
        Ok(())
    }

    /// Asks for a change of state, for instance [`Request::Arm`] and then [`Request::Start`].
    pub fn request(&mut self, request: Request) -> Result<(), Refused> {
        if !self.config.parts.guard {
            return Err(Refused::NoGuard);
        }
        if let (Request::Arm, Some(cause)) = (request, self.watch.cause()) {
            return Err(Refused::Cause(cause));
        }
        let whole = self.supervisor.whole();
        self.quiet = Quiet::No;
        self.supervisor.request(request)?;
        match request {
            Request::Arm => {
                self.watch.arm();
                self.start_at(self.readings.displacement);
            }
            Request::Hold | Request::Stop if whole => self.anchor = self.target,
            _ => {}
        }
        Ok(())
    }

    /// Puts the law at rest with the reference standing at `displacement` (m).
    fn start_at(&mut self, displacement: f32) {
        self.anchor = displacement;
        self.target = displacement;
        self.reference = displacement;
        self.law = Law::at(displacement);
        self.tracker.start_at(displacement);
        self.config.modifier.restart(&mut self.modifier, displacement);
        self.gap = false;
        self.blend = Blend::default();
        self.blending = false;
        self.limited = false;
    }

    /// Where the test stands; always running without a guard.
    #[inline]
    pub const fn state(&self) -> State {
        self.supervisor.state()
    }

    /// Why the guard tripped, until it is reset.
    #[inline]
    pub const fn trip(&self) -> Option<Trip> {
        self.supervisor.cause()
    }

    /// How often [`Controller::state`] or [`Controller::trip`] have changed, modulo 256.
    #[inline]
    pub const fn changes(&self) -> u8 {
        self.supervisor.changes()
    }

    /// One tick: measure, decide, command.
    #[inline]
    pub fn step(&mut self, sample: &Sample) -> Command {
        let course = self.advance(sample);
        self.command(course.missing())
    }

    /// The first half of [`Self::step`]: the tick itself. A caller that reads of the command only what it needs, when it needs
    /// it, spares the rest.
    #[inline]
    pub fn advance(&mut self, sample: &Sample) -> Course {
        // A test that runs whole, which is where the ticks count, asks no questions; see `go_on` for all of them.
        if self.passes(sample) {
            return self.pass(sample);
        }
        let missing = self.config.walls.take(sample, &mut self.readings);
        if self.quiet != Quiet::No && missing.is_empty() {
            let cause = if self.quiet == Quiet::All {
                self.watch.step::<true, false>(&self.config, &self.readings, self.drive())
            } else {
                self.watch_partly()
            };
            match cause {
                None if self.decide::<true, false>() => return Course::Whole,
                None => {}
                cause => self.go_on(missing, cause),
            }
        } else if self.begun || self.begin(missing) {
            let cause = self.watch(missing);
            self.go_on(missing, cause);
        }
        Course::Other(missing)
    }

    /// Whether a tick with this `sample` may be [`Self::pass`]: in the middle of a test in [`Mode::Guard`], with every part that
    /// looks on in use, on the sensors that every table has, all of them believable.
    #[inline(always)]
    pub fn passes(&self, sample: &Sample) -> bool {
        self.quiet == Quiet::Guard && self.config.walls.admit_three(sample)
    }

    /// [`Self::advance`] where [`Self::passes`]: with nothing to ask about the configuration and the state.
    #[inline(always)]
    pub fn pass(&mut self, sample: &Sample) -> Course {
        self.readings.external = sample.external;
        self.readings.displacement = sample.displacement;
        self.readings.acceleration = sample.acceleration;
        self.readings.limit_switch = sample.limit_switch;
        self.readings.relay_closed = sample.relay_closed;
        match self.watch.step::<true, true>(&self.config, &self.readings, self.drive()) {
            None if self.decide::<true, true>() => return Course::Whole,
            None => {}
            cause => self.go_on(Channels::NONE, cause),
        }
        Course::Other(Channels::NONE)
    }

    /// The rest of a tick in which something may be missing, fading or blending, or the guard may have found a cause to
    /// trip.
    #[inline(never)]
    fn go_on(&mut self, missing: Channels, cause: Option<Trip>) {
        if cause.is_some() || !self.supervisor.steady() {
            self.supervise(missing, cause);
        }
        let whole = missing.is_empty() && self.supervisor.steady();
        if !self.supervisor.moves() {
            self.make_safe();
        } else if missing.is_empty() {
            self.decide::<false, false>();
        } else {
            self.gap = true;
        }
        self.quiet = if !whole || self.blending || self.limited || !self.supervisor.steady() {
            Quiet::No
        } else if self.config.guards() {
            Quiet::Guard
        } else if self.config.complete() {
            Quiet::All
        } else {
            Quiet::Partly
        };
    }

    /// Takes up what the guard has found, and moves the ramps on.
    #[inline(never)]
    fn supervise(&mut self, missing: Channels, cause: Option<Trip>) {
        if !self.config.parts.guard {
            return;
        }
        if let Some(cause) = cause {
            self.supervisor.doubt(cause);
            if self.zero_flow_is_unknown(missing, cause) {
                self.supervisor.open_relay_at_once();
            }
        }
        self.supervisor.advance(self.config.guard.ramps);
    }

    /// Whether the zero-flow output cannot be known: what stands behind the device subtracts the LVDT (Fig. 2, or an existing
    /// position controller), and its reading is lost or stuck. A ramp would then end at some command, not at zero flow.
    #[cold]
    fn zero_flow_is_unknown(&self, missing: Channels, cause: Trip) -> bool {
        let lost = cause == Trip::SensorLost && missing.any(Channels::DISPLACEMENT);
        self.config.cancellation != 0.0 && (lost || cause == Trip::DisplacementStuck)
    }

    /// The first tick for which every needed channel is there. Until then nothing moves.
    #[cold]
    fn begin(&mut self, missing: Channels) -> bool {
        self.begun = missing.is_empty();
        if self.begun {
            self.watch.begin(self.readings.displacement);
            self.start_at(self.readings.reference);
        }
        self.begun
    }

    /// What pushes the table since the last tick.
    #[inline]
    fn drive(&self) -> Drive {
        Drive {
            reference: self.reference,
            excess: self.excess,
            moves: self.supervisor.moves(),
            relay: self.supervisor.relay(),
        }
    }

    /// What they say where some parts that look on are not in use.
    #[inline(never)]
    fn watch_partly(&mut self) -> Option<Trip> {
        self.watch.step_partly(&self.config, &self.readings, self.drive())
    }

    /// What the sensors say of the table, the valve and themselves.
    #[inline(never)]
    fn watch(&mut self, missing: Channels) -> Option<Trip> {
        let mut drive = self.drive();
        if !self.supervisor.moves() {
            // What the test asked for is asked for no more, as far as the safe ramp has come.
            drive.excess *= self.supervisor.command();
            drive.reference = self.readings.displacement;
        }
        if missing.is_empty() {
            self.watch.step_again(&self.config, &self.readings, drive)
        } else {
            self.watch.step_without(&self.config, missing, &self.readings, drive)
        }
    }

    /// The output at which no oil flows, m.
    #[inline]
    fn zero_flow(&self) -> f32 {
        self.config.cancellation * self.readings.displacement + self.config.null_bias
    }

    /// The safe ramp: what was asked for at the trip, let go.
    #[inline(never)]
    fn make_safe(&mut self) {
        // Beyond wide open the command could fall a long way without slowing the table.
        self.excess = self.excess.bounded(self.config.wide_open);
        self.output = self.zero_flow() + self.supervisor.command() * self.excess;
    }

    /// The output of the mode, all inputs being good; `WHOLE` where nothing fades or blends, `GUARD` where the mode is known to
    /// be [`Mode::Guard`]. False where the command was beyond its limit.
    #[inline(always)]
    fn decide<const WHOLE: bool, const GUARD: bool>(&mut self) -> bool {
        let zero = self.zero_flow();
        let mode = if GUARD { Mode::Guard } else { self.config.mode };
        let (asked, whole) = match mode {
            Mode::Guard => (self.readings.external - zero, self.readings.external),
            Mode::Modifier => {
                let reference = self.fit_reference::<WHOLE>();
                (reference - zero, reference)
            }
            Mode::Controller => {
                let reference = self.fit_reference::<WHOLE>();
                let asked = self.tracker.step(reference, &self.readings).unwrap_or_else(|| {
                    let blocked = self.watch.blocked(&self.config, self.limited, self.excess);
                    let velocity = self.watch.velocity(&self.config, &self.readings);
                    self.law.step(&self.config, reference, &self.readings, velocity, blocked)
                });
                (asked, zero + asked)
            }
        };
        let all = WHOLE || self.supervisor.steady() && !self.blending;
        let wanted = if all { asked } else { self.fade(asked, zero) };
        let within = self.config.within.holds(wanted);
        if within {
            if !WHOLE {
                self.limited = false;
            }
            self.excess = wanted;
            // What nothing acts on passes to the last bit, which `zero + (external - zero)` would not.
            self.output = if WHOLE || wanted == asked { whole } else { zero + wanted };
        } else {
            self.limit(wanted, zero);
        }
        within
    }

    /// A command beyond what the valve is given, or none at all: no input makes the law's state other than a number,
    /// but a flipped bit might.
    #[cold]
    fn limit(&mut self, wanted: f32, zero: f32) {
        if wanted.is_nan() {
            self.quiet = Quiet::No;
            self.start_at(self.readings.displacement);
            if self.config.parts.guard {
                self.supervisor.trip(Trip::Internal);
            }
            return;
        }
        self.limited = true;
        self.quiet = Quiet::No;
        self.excess = wanted.bounded(self.config.command_limit);
        self.output = zero + self.excess;
    }

    /// Lets through what the state of the test lets through of an existing controller's command, and what is left of
    /// the output before a change of settings.
    #[inline(never)]
    fn fade(&mut self, asked: f32, zero: f32) -> f32 {
        let guards = self.config.mode == Mode::Guard;
        let faded = if guards { self.supervisor.presence() * asked } else { asked };
        if self.blend.pending {
            self.blend = Blend { offset: self.output - zero - faded, weight: 1.0, pending: false };
        }
        let w = self.blend.weight;
        let next = w - self.config.blend_step;
        self.blend.weight = if next > 0.0 { next } else { 0.0 };
        self.blending = self.blend.weight > 0.0;
        if w > 0.0 { faded + self.blend.offset * (w * w * (3.0 - 2.0 * w)) } else { faded }
    }

    /// The reference as the test's ramps and the record modifier let it through, m.
    #[inline(always)]
    fn fit_reference<const WHOLE: bool>(&mut self) -> f32 {
        self.target = self.readings.reference;
        if !WHOLE && !self.supervisor.steady() {
            self.target = self.anchor + self.supervisor.presence() * (self.target - self.anchor);
        }
        if !WHOLE && self.gap {
            Modifier::resume(&mut self.modifier, self.target);
            self.gap = false;
        }
        let limit = self.watch.velocity_limit();
        self.reference = self.config.modifier.advance(&mut self.modifier, self.target, limit);
        if self.config.uses_rates {
            self.law.see_reference(&self.config, self.reference, &self.readings);
        }
        self.reference
    }

    /// What goes out after the last tick, m: [`Command::valve`].
    #[inline]
    pub const fn valve(&self) -> f32 {
        self.output
    }

    /// What the relay of the hydraulic block is to do after the last tick: [`Status::relay`].
    #[inline]
    pub const fn relay(&self) -> Relay {
        self.supervisor.relay()
    }

    /// The other half of [`Self::step`]: the command, and what happened in the tick that `missing` is from.
    #[inline]
    pub fn command(&self, missing: Channels) -> Command {
        Command {
            valve: self.output,
            reference: self.reference,
            status: Status {
                saturated: self.watch.saturated(),
                held: !missing.is_empty(),
                missing,
                limited: self.limited,
                velocity_limit: self.watch.velocity_limit(),
                state: self.supervisor.state(),
                trip: self.supervisor.cause(),
                relay: self.supervisor.relay(),
            },
        }
    }
}
