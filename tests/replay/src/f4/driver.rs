//! Lock step: the world is asked at each update of the sampling timer, and at no other instant.

use std::sync::{Arc, Mutex, PoisonError};

use rigless::emulator::{Access, AccessKind, Driver, HitKind, Host, Settled, Stop, Watch};
use rigless::session::Session;
use rigless::time::VirtualNanos;

use super::board::Board;
use super::outboard::Wires;
use super::sampling::Sampling;
use super::silicon::Silicon;
use super::stack::Stack;
use super::tick_cost::TickCost;
use super::timer::Timer;
use crate::world::SCANS;
use crate::{Fitted, Line, Tick, World};

const TIM2_CR1: u64 = 0x4000_0000;
const TIM2_ARR: u64 = 0x4000_002C;
const DAC_DHR12R1: u64 = 0x4000_7408;
const GPIOB_BSRR: u64 = 0x4002_0418;
/// How long to wait before looking again while the timer stands, ns.
const PATIENCE: u64 = 1_000_000;
/// The driver of a run.
pub(super) struct Lockstep<W> {
    pub(super) world: W,
    wire: Arc<Mutex<Line>>,
    timer: Timer,
    pub(super) sampling: Sampling,
    /// When the scans under way end, ns, where they go, and what they are.
    pub(super) scans: Option<(u64, u64, [[u16; 4]; SCANS])>,
    /// When the next update comes, ns.
    next: u64,
    pub(super) outboard: Option<Wires>,
    pub(super) busy: bool,
    pub(super) inputs: [u16; 4],
    pub(super) circuit_closed: bool,
    supply: u32,
    output: Option<u16>,
    relay: bool,
    resets: usize,
    first: bool,
    ticked: bool,
    /// Instructions to follow, and from which tick to the next.
    follow: Option<(u64, Vec<u64>)>,
    followed: Vec<u64>,
    /// Where a line's end in the log is kept, and whether the relay was closed at each.
    log: Option<u64>,
    pub(super) logged: Vec<bool>,
    stack: Stack,
    silicon: Silicon,
    pub(super) tick_cost: TickCost,
    /// What the program has written to its console.
    pub(super) console: String,
}

impl<W: World> Lockstep<W> {
    pub(super) fn new(world: W, wire: Arc<Mutex<Line>>) -> Self {
        let outboard = (world.fitted() == Fitted::Outboard).then(Wires::default);
        Self {
            world,
            wire,
            timer: Timer::default(),
            sampling: Sampling::default(),
            scans: None,
            next: 0,
            outboard,
            busy: true,
            inputs: [0; 4],
            circuit_closed: true,
            supply: 3300,
            output: None,
            relay: false,
            resets: 0,
            first: true,
            ticked: false,
            follow: None,
            followed: Vec::new(),
            log: None,
            logged: Vec::new(),
            stack: Stack::default(),
            silicon: Silicon::default(),
            tick_cost: TickCost::default(),
            console: String::new(),
        }
    }

    /// What the chips outboard share with this driver; none where there are none.
    pub(super) fn outboard(&self) -> Option<Wires> {
        self.outboard.clone()
    }

    pub(super) const fn ticked(&self) -> bool {
        self.ticked
    }

    pub(super) fn silicon(&self) -> Silicon {
        self.silicon.clone()
    }

    pub(super) const fn stack(&self) -> Stack {
        self.stack
    }

    pub(super) fn into_world(self) -> (W, Vec<u64>) {
        (self.world, self.followed)
    }

    /// Follows the instructions at `addresses` through tick `tick`.
    pub(super) fn follow(mut self, tick: u64, addresses: &[u64]) -> Self {
        self.follow = Some((tick, addresses.to_vec()));
        self
    }

    /// Notes whether the relay is closed whenever the word at `address` is written.
    pub(super) fn log_at(mut self, address: u64) -> Self {
        self.log = Some(address);
        self
    }

    fn watch(&self, session: &mut Session<Board>) {
        let Some((tick, addresses)) = &self.follow else { return };
        for &address in addresses {
            if self.timer.updates == *tick {
                session.watch(Watch::Instruction(address));
            } else if self.timer.updates == tick + 1 {
                session.unwatch(Watch::Instruction(address));
            }
        }
    }

    /// A reset, which may be over and the timer started again before the next stop.
    fn note_resets(&mut self, session: &mut Session<Board>) -> bool {
        let resets = session.resets().len();
        let new = resets != self.resets;
        if new {
            self.resets = resets;
            self.timer = Timer::default();
            self.scans = None;
            self.relay = false;
            session.board_mut().set_options(self.world.option_bytes());
        }
        new
    }

    /// The same at the program's first access to the timer.
    fn hear_of_resets(&mut self, session: &mut Session<Board>, access: Access) {
        if self.note_resets(session) {
            self.circuit(session, access.virtual_time);
        }
    }

    /// A write of the firmware's that the emulator has no model for, or that moves the timer.
    fn notice(&mut self, session: &mut Session<Board>, access: Access, value: u64) {
        match access.address {
            DAC_DHR12R1 => self.output = Some((value & 0xFFF) as u16 * SCANS as u16),
            GPIOB_BSRR if value & 1 != 0 => self.relay = true,
            GPIOB_BSRR if value & 1 << 16 != 0 => self.relay = false,
            TIM2_ARR => {
                self.hear_of_resets(session, access);
                self.timer.set_reload(value);
            }
            TIM2_CR1 => {
                let running = value & 1 != 0;
                self.hear_of_resets(session, access);
                if running && !self.timer.running {
                    self.timer.start(access.virtual_time.0);
                    self.next = self.timer.next();
                    session.run_until(VirtualNanos(self.next));
                }
                self.timer.control(value);
                self.timer.running = running;
                if !running {
                    self.scans = None;
                }
            }
            _ => {}
        }
    }

    /// Asks the world, then starts the conversion. None ends the run.
    fn update(&mut self, session: &mut Session<Board>, stop: Stop) -> Option<()> {
        let wire = Arc::clone(&self.wire);
        let mut line = wire.lock().unwrap_or_else(PoisonError::into_inner);
        let (was_closed, supply) = (self.circuit_closed, self.supply);
        if let Some(wires) = &self.outboard {
            self.output = wires.lock().unwrap_or_else(PoisonError::into_inner).output;
        }
        let tick = Tick {
            index: self.timer.updates,
            time: stop.at.0,
            instructions: stop.instruction_count,
            output: self.output,
            relay: self.relay,
            resets: self.resets,
            inputs: &mut self.inputs,
            circuit_closed: &mut self.circuit_closed,
            supply: &mut self.supply,
            line: &mut line,
        };
        let go_on = self.world.tick(tick);
        drop(line);
        self.timer.update();
        if self.circuit_closed != was_closed {
            self.circuit(session, stop.at);
        }
        let part = &mut session.board_mut().part;
        if self.supply != supply {
            part.whole.set_supply(self.supply);
        }
        self.convert(session, stop.at);
        go_on.then_some(())
    }
}

impl<W: World> Driver<Board> for Lockstep<W> {
    fn on_settled(&mut self, session: &mut Session<Board>, host: &mut dyn Host, settled: Settled) {
        match settled {
            Settled::Access { access, value } => {
                self.tick_cost.settled(access, self.relay);
                self.silicon.settled(session, host, self.world.oscillator(), access, value);
                if access.kind == AccessKind::Write {
                    self.sampling.notice(access.address, value);
                    self.acknowledge(host, access.address);
                    if access.address == DAC_DHR12R1
                        && let Some(time) = self.world.stands()
                    {
                        self.silicon.stand(session, host, access.virtual_time.0 + time);
                    }
                    self.notice(session, access, value);
                }
            }
            Settled::Hit(hit) if hit.kind == HitKind::Instruction => self.followed.push(hit.address),
            Settled::Hit(_) => self.logged.push(self.relay),
            Settled::Stop(stop) => {
                if std::mem::take(&mut self.first) {
                    if let Some(address) = self.log {
                        session.watch(Watch::Writes { address, length: 4 });
                    }
                    session.board_mut().part.whole.rcc.calibrate_lsi(self.world.watchdog_clock());
                    session.board_mut().set_options(self.world.option_bytes());
                    self.circuit(session, stop.at);
                }
                self.silicon.stopped(session, host, stop.at.0);
            }
            _ => {}
        }
    }

    fn on_console(&mut self, _: VirtualNanos, _: u64, bytes: &[u8]) {
        self.console.push_str(&String::from_utf8_lossy(bytes));
    }

    fn on_stop(&mut self, session: &mut Session<Board>, stop: Stop, host: &mut dyn Host) -> Option<VirtualNanos> {
        if self.note_resets(session) {
            self.circuit(session, stop.at);
        }
        if !self.timer.running {
            return self.ticked.then_some(VirtualNanos(stop.at.0 + PATIENCE));
        }
        if let Some((_, buffer, scans)) = self.scans.take() {
            Self::deliver(host, buffer, &scans);
            return Some(VirtualNanos(self.next));
        }
        self.ticked = true;
        self.watch(session);
        if self.update(session, stop).is_none() {
            self.stack = Stack::measured(host);
            return None;
        }
        self.next = self.timer.next();
        let due = self.scans.as_ref().map(|&(due, ..)| due);
        Some(VirtualNanos(due.map_or(self.next, |due| due.min(self.next))))
    }
}
