//! Lock step: the world is asked at each update of the sampling timer, and at no other instant.

use std::sync::{Arc, Mutex, PoisonError};

use rigless::device::Level;
use rigless::emulator::{Access, AccessKind, Driver, Host, Settled, Stop, Watch};
use rigless::mcu::Operate;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::soc::stm32f427::peripherals::adc::Channel;
use rigless::soc::stm32f427::peripherals::gpio::Pin;
use rigless::time::VirtualNanos;

use super::board::Board;
use super::silicon::Silicon;
use super::tick_cost::TickCost;
use crate::{Line, Tick, World};

const TIM2_CR1: u64 = 0x4000_0000;
const TIM2_ARR: u64 = 0x4000_002C;
const DAC_DHR12R1: u64 = 0x4000_7408;
const GPIOB_BSRR: u64 = 0x4002_0418;
const ADC1_CR2: u64 = 0x4001_2008;
const SWSTART: u64 = 1 << 30;
const DMA2_S0CR: u64 = 0x4002_6410;
const ADON: u64 = 1;
/// Nanoseconds to so many counts of the timer, which has 84 MHz.
const NANOSECONDS: (u64, u64) = (250, 21);
/// How long to wait before looking again while the timer stands, ns.
const PATIENCE: u64 = 1_000_000;
/// Port B, and the emergency stop on it.
const PORT_B: usize = 1;
const STOP_PIN: u8 = 1;
/// Where the vector table holds the top of the stack, whose bottom is that of the memory (`memory.x`); and what the firmware
/// paints it with at reset.
const STACK_TOP: u64 = 0x0800_0000;
const MEMORY: u64 = 0x2000_0000;
const PAINT: u64 = 0xCCCC_CCCC;

/// The timer's updates, from its registers.
#[derive(Debug, Clone, Copy, Default)]
struct Timer {
    running: bool,
    started: u64,
    updates: u64,
    reload: u64,
    /// Counts before the first update of this start and since, at the reload in force then.
    counts: u64,
}

impl Timer {
    fn next(&mut self) -> u64 {
        self.counts += self.reload + 1;
        self.started + self.counts * NANOSECONDS.0 / NANOSECONDS.1
    }
}

/// The driver of a run.
pub(super) struct Lockstep<W> {
    world: W,
    wire: Arc<Mutex<Line>>,
    timer: Timer,
    inputs: [u16; 4],
    circuit_closed: bool,
    supply: u32,
    output: Option<u16>,
    relay: bool,
    resets: usize,
    first: bool,
    ticked: bool,
    /// Instructions to follow, and from which tick to the next.
    follow: Option<(u64, Vec<u64>)>,
    followed: Vec<u64>,
    stack: Stack,
    silicon: Silicon,
    pub(super) tick_cost: TickCost,
    /// What the program has written to its console.
    pub(super) console: String,
}

/// The stack, byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Stack {
    /// Deepest it has been.
    pub deepest: u64,
    /// What there is of it.
    pub size: u64,
}

impl<W: World> Lockstep<W> {
    pub(super) fn new(world: W, wire: Arc<Mutex<Line>>) -> Self {
        Self {
            world,
            wire,
            timer: Timer::default(),
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
            stack: Stack::default(),
            silicon: Silicon::default(),
            tick_cost: TickCost::default(),
            console: String::new(),
        }
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

    /// How deep the paint is gone.
    fn measure_stack(&mut self, host: &mut dyn Host) {
        let top = host.read(STACK_TOP, Width::W32).unwrap_or(MEMORY);
        let painted = |&address: &u64| host.read(address, Width::W32).is_ok_and(|word| word == PAINT);
        let untouched = (MEMORY..top).step_by(4).take_while(painted).count() as u64 * 4;
        let size = top.saturating_sub(MEMORY);
        self.stack = Stack { deepest: size - untouched, size };
    }

    pub(super) fn into_world(self) -> (W, Vec<u64>) {
        (self.world, self.followed)
    }

    /// Follows the instructions at `addresses` through tick `tick`.
    pub(super) fn follow(mut self, tick: u64, addresses: &[u64]) -> Self {
        self.follow = Some((tick, addresses.to_vec()));
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
    fn note_resets(&mut self, session: &Session<Board>) -> bool {
        let resets = session.resets().len();
        let new = resets != self.resets;
        if new {
            self.resets = resets;
            self.timer.running = false;
            self.relay = false;
        }
        new
    }

    /// A write of the firmware's that the emulator has no model for, or that moves the timer.
    fn notice(&mut self, session: &mut Session<Board>, access: Access, value: u64) {
        match access.address {
            DAC_DHR12R1 => self.output = Some((value & 0xFFF) as u16),
            GPIOB_BSRR if value & 1 != 0 => self.relay = true,
            GPIOB_BSRR if value & 1 << 16 != 0 => self.relay = false,
            TIM2_ARR => self.timer.reload = value,
            TIM2_CR1 => {
                let running = value & 1 != 0;
                if self.note_resets(session) {
                    self.circuit(session, access.virtual_time);
                }
                if running && !self.timer.running {
                    self.timer = Timer {
                        running,
                        started: access.virtual_time.0,
                        updates: 0,
                        counts: 0,
                        reload: self.timer.reload,
                    };
                    session.run_until(VirtualNanos(self.timer.next()));
                }
                self.timer.running = running;
            }
            _ => {}
        }
    }

    fn circuit(&self, session: &mut Session<Board>, at: VirtualNanos) {
        let level = if self.circuit_closed { Level::Low } else { Level::High };
        if let Some(pin) = Pin::new(STOP_PIN) {
            session
                .board_mut()
                .part
                .whole
                .drive_port(at, PORT_B, |port, registers, context| port.drive(pin, Some(level), registers, context));
        }
    }

    /// Asks the world, then starts the conversion. None ends the run.
    fn update(&mut self, session: &mut Session<Board>, stop: Stop) -> Option<()> {
        let wire = Arc::clone(&self.wire);
        let mut line = wire.lock().unwrap_or_else(PoisonError::into_inner);
        let (was_closed, supply, inputs) = (self.circuit_closed, self.supply, self.inputs);
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
        self.timer.updates += 1;
        if self.circuit_closed != was_closed {
            self.circuit(session, stop.at);
        }
        let part = &mut session.board_mut().part;
        if self.supply != supply {
            part.whole.set_supply(self.supply);
        }
        for (number, (&code, was)) in (0..).zip(self.inputs.iter().zip(inputs)) {
            if let Some(channel) = Channel::new(number).filter(|_| code != was || self.timer.updates == 1) {
                part.whole.adc[0].set_input(channel, u32::from(code));
            }
        }
        if self.world.overruns() {
            let _ = part.write(stop.at, DMA2_S0CR, Width::W32, 0);
        }
        if self.world.converts() {
            let control = part.read(stop.at, ADC1_CR2, Width::W32).unwrap_or(0);
            if control & ADON != 0 {
                let _ = part.write(stop.at, ADC1_CR2, Width::W32, control | SWSTART);
            }
        }
        go_on.then_some(())
    }
}

impl<W: World> Driver<Board> for Lockstep<W> {
    fn on_settled(&mut self, session: &mut Session<Board>, host: &mut dyn Host, settled: Settled) {
        match settled {
            Settled::Access { access, value } => {
                self.tick_cost.settled(access);
                self.silicon.settled(session, host, self.world.oscillator(), access, value);
                if access.kind == AccessKind::Write {
                    if access.address == DAC_DHR12R1
                        && let Some(time) = self.world.stands()
                    {
                        self.silicon.stand(session, host, access.virtual_time.0 + time);
                    }
                    self.notice(session, access, value);
                }
            }
            Settled::Hit(hit) => self.followed.push(hit.address),
            Settled::Stop(stop) => {
                if std::mem::take(&mut self.first) {
                    session.board_mut().part.whole.rcc.calibrate_lsi(self.world.watchdog_clock());
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
        self.ticked = true;
        self.watch(session);
        if self.update(session, stop).is_none() {
            self.measure_stack(host);
            return None;
        }
        Some(VirtualNanos(self.timer.next()))
    }
}
