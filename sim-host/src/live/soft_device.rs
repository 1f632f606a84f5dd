//! A twin of the device: the firmware's own loop and desk, around a table of the library, at the pace of the clock on the wall.
//!
//! What it answers is what a board answers: the same code decides in every tick and carries out every request. It is no board:
//! converters are ideal, no tick is late, and nothing is kept in flash.

use std::collections::VecDeque;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, TryRecvError, channel, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use shakedown_core::Mode;
use shakedown_core::link::{Assembler, Clock, HostRequest, MAX_FRAME, Report, Scale, Setup, SetupError, encode};
use shakedown_firmware::link_server::{Action, LinkServer, LoopStatus};
use shakedown_firmware::queues::Queues;
use shakedown_firmware::{ControlLoop, defaults};

use crate::closed_loop::ClosedLoopError;
use crate::closed_loop::twin::Twin;
use crate::device::Line;
use crate::plant::Plant;

/// Plant steps in a tick.
const STEPS: usize = 4;
/// Most that it makes up for when it was kept from running.
const CATCH_UP: Duration = Duration::from_millis(50);
/// Bytes that its line carries in a millisecond: a megabit a second, ten bits a byte.
const BYTES_A_MS: f64 = 100.0;
/// Pieces that the line holds for a host that does not read; more are lost, as on a wire.
const HELD: usize = 256;

/// Why there is no twin.
#[derive(Debug, thiserror::Error)]
pub enum SoftDeviceError {
    /// The setup does not hold.
    #[error("the twin's setup: {0}")]
    Setup(SetupError),
    /// The twin is in the place of a controller.
    #[error("the twin's setup: mode {0:?}: the twin runs in mode `controller` only")]
    Mode(Mode),
    /// The table does not hold.
    #[error("the twin's table: {0}")]
    Table(#[from] ClosedLoopError),
}

/// The host's end of the line to a twin; dropping it ends the twin.
#[derive(Debug)]
pub struct SoftDevice {
    to: Sender<Vec<u8>>,
    from: Receiver<Vec<u8>>,
    heard: VecDeque<u8>,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl SoftDevice {
    /// The setup of a twin of `table`: a board that was never set up, and the table's largest speed.
    pub fn setup(table: &Twin) -> Setup {
        let mut setup = defaults::setup();
        setup.control.velocity_limit = table.velocity_limit() as f32;
        setup.control.valve.gain = (table.plant.b0 / table.plant.a1) as f32;
        setup.control.valve.lag = (1.0 / table.plant.a1) as f32;
        setup
    }

    /// Starts a twin of `table` under `setup`.
    pub fn start(setup: Setup, table: Twin) -> Result<Self, SoftDeviceError> {
        setup.validate().map_err(SoftDeviceError::Setup)?;
        if setup.control.mode != Mode::Controller {
            return Err(SoftDeviceError::Mode(setup.control.mode));
        }
        // What does not make a plant is refused here and not in the thread.
        drop(table.plant(1e-3, 0.0)?);
        let (to, requests) = channel();
        let (reports, from) = sync_channel(HELD);
        let over = Arc::new(AtomicBool::new(false));
        let ends = Ends { requests, reports, over: Arc::clone(&over) };
        let thread = std::thread::spawn(move || run(&setup, table, &ends));
        Ok(Self { to, from, heard: VecDeque::new(), over, thread: Some(thread) })
    }
}

impl Drop for SoftDevice {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Line for SoftDevice {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        loop {
            match self.from.try_recv() {
                Ok(piece) => self.heard.extend(piece),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) if self.heard.is_empty() => {
                    return Err(io::Error::other("the twin has ended"));
                }
                Err(TryRecvError::Disconnected) => break,
            }
        }
        let count = bytes.len().min(self.heard.len());
        for (place, byte) in bytes.iter_mut().zip(self.heard.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if !bytes.is_empty() && self.to.send(bytes.to_vec()).is_err() {
            return Err(io::Error::other("the twin has ended"));
        }
        Ok(bytes.len())
    }
}

/// The twin's ends.
struct Ends {
    requests: Receiver<Vec<u8>>,
    reports: SyncSender<Vec<u8>>,
    over: Arc<AtomicBool>,
}

/// What is at the converters: the table, standing while the relay is open.
struct Bench {
    table: Twin,
    plant: Box<dyn Plant>,
    rate: f64,
    before: f64,
    acceleration: f64,
    oil: bool,
}

impl Bench {
    fn new(table: Twin, rate: f64) -> Result<Self, ClosedLoopError> {
        let plant = table.plant(1.0 / (rate * STEPS as f64), 0.0)?;
        Ok(Self { table, plant, rate, before: 0.0, acceleration: 0.0, oil: false })
    }

    /// One tick under the output `code`.
    fn advance(&mut self, setup: &Setup, code: u16, relay: bool) {
        let rate = f64::from(setup.control.rate);
        if rate != self.rate || (self.oil && !relay) {
            // Without oil it stands where it is.
            let x = self.plant.displacement();
            if let Ok(plant) = self.table.plant(1.0 / (rate * STEPS as f64), x) {
                self.plant = plant;
            }
            (self.rate, self.before) = (rate, 0.0);
        }
        self.oil = relay;
        let velocity = if relay {
            let command = f64::from(setup.wiring.output.to_si(code));
            self.plant.advance(command, STEPS);
            self.plant.velocity(command)
        } else {
            0.0
        };
        self.acceleration = (velocity - self.before) * rate;
        self.before = velocity;
    }

    /// The codes at the converter now.
    fn codes(&self, setup: &Setup) -> [u16; 4] {
        let wiring = &setup.wiring;
        let full = f64::from(wiring.full_scale);
        let code = |scale: &Scale, si: f64| {
            (si / f64::from(scale.per_code) + f64::from(scale.zero)).round().clamp(0.0, full) as u16
        };
        [
            code(&wiring.reference, 0.0),
            code(&wiring.displacement, self.plant.displacement()),
            code(&wiring.acceleration, self.acceleration),
            code(&wiring.external, 0.0),
        ]
    }
}

fn run(setup: &Setup, table: Twin, ends: &Ends) {
    let mut queues = Queues::new();
    let (loop_end, desk_end) = queues.split();
    let rate = f64::from(setup.control.rate);
    let (Ok(mut decide), Ok(mut bench)) = (ControlLoop::new(setup, loop_end, false), Bench::new(table, rate)) else {
        return;
    };
    let entropy = getrandom::u64().unwrap_or_else(|_| u64::from(std::process::id()));
    let desk = LinkServer::new(*setup, false, Clock::Crystal, defaults::LIMITS, entropy, desk_end);
    let mut server = Served { desk, assembler: Assembler::new(), answer: None, allowance: 0.0 };
    let mut start = Instant::now();
    let mut elapsed = Duration::ZERO;
    while !ends.over.load(Ordering::Relaxed) {
        let codes = bench.codes(server.desk.setup());
        let outcome = decide.tick(|input| codes.get(input).copied().unwrap_or_default());
        bench.advance(server.desk.setup(), outcome.output, decide.relay());
        let (ticks, dropped) = decide.counts();
        server.serve(LoopStatus { standing: decide.standing(), ticks, dropped, cause: None }, ends, bench.rate);
        elapsed += Duration::from_secs_f64(1.0 / bench.rate);
        let wall = start.elapsed();
        match elapsed.checked_sub(wall) {
            Some(ahead) if ahead >= Duration::from_millis(1) => std::thread::sleep(ahead),
            None => start += wall.saturating_sub(elapsed + CATCH_UP),
            _ => {}
        }
    }
}

/// The firmware's desk at its line.
struct Served<'a> {
    desk: LinkServer<'a>,
    assembler: Assembler,
    answer: Option<Report>,
    /// Bytes that the line has room for.
    allowance: f64,
}

impl Served<'_> {
    /// What the board's link task does between two ticks.
    fn serve(&mut self, seen: LoopStatus, ends: &Ends, rate: f64) {
        self.allowance = (self.allowance + BYTES_A_MS * 1000.0 / rate).min(MAX_FRAME as f64);
        if let Some(action) = self.desk.heed() {
            self.act(action);
        }
        while let Ok(bytes) = ends.requests.try_recv() {
            for byte in bytes {
                if self.assembler.gather(byte) {
                    self.hear(seen, ends);
                }
            }
        }
        if self.allowance > 0.0 {
            let report = self.answer.take().or_else(|| self.desk.volunteer(seen));
            self.send(report, ends);
        }
    }

    fn hear(&mut self, seen: LoopStatus, ends: &Ends) {
        match self.assembler.frame::<HostRequest>() {
            Some(Ok(request)) => {
                // One answer at a time: an earlier one goes out first.
                let earlier = self.answer.take();
                self.send(earlier, ends);
                let action = self.desk.take(request, seen, self.desk.milliseconds(seen.ticks));
                self.act(action);
            }
            Some(Err(_)) => self.desk.count_garbled(),
            None => {}
        }
    }

    fn act(&mut self, action: Action) {
        match action {
            Action::Send(report) => self.answer = Some(report),
            Action::Save(proof) => self.answer = Some(self.desk.saved(proof, true)),
            // It has no chip.
            Action::TellOptions => self.answer = Some(Report::Options(heapless::Vec::new())),
            Action::Wait => {}
        }
    }

    fn send(&mut self, report: Option<Report>, ends: &Ends) {
        let Some(report) = report else { return };
        let mut frame = [0; MAX_FRAME];
        let length = encode(&report, &mut frame).unwrap_or(0);
        self.allowance -= length as f64;
        // What nobody reads is lost.
        let _ = ends.reports.try_send(frame.get(..length).unwrap_or_default().to_vec());
    }
}
