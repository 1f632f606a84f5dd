//! The emulated F4. Everything that knows the emulator (`rigless` 0.4, young and not settled) is in this folder.
//!
//! Two things the emulator does not model are supplied here, from the firmware's own register writes: the DAC (its data
//! register is watched), and the triggers from TIM2 by TIM1 to the converter and its DMA (where all their registers are set as they
//! must be, the samples of an update are put where the DMA would put them, and its interrupt is raised; see [`sampling`]). The part is an STM32F427, whose first megabyte of flash, RAM, timers, converters and DMA are the F407's.

mod board;
mod count;
mod driver;
mod inputs;
mod outboard;
mod sampling;
mod silicon;
mod stack;
mod tick_cost;
mod timer;
mod wire;

use std::path::Path;
use std::sync::{Arc, Mutex};

use rigless::emulator::{self, Start};
use rigless::image::Image;
use rigless::session::Session;
use rigless::time::VirtualNanos;

use crate::{ReplayError, World};
use board::Board;
pub use count::{Mark, marks};
use driver::Lockstep;
pub use silicon::Silicon;
pub use stack::Stack;

/// Virtual time in which the firmware must start its timer, ms.
const BOOT_LIMIT: u64 = 2000;

/// What a run leaves behind.
#[derive(Debug)]
pub struct Ran<W> {
    /// The world, with what it has recorded.
    pub world: W,
    /// Instructions retired.
    pub instructions: u64,
    /// Virtual time, ns.
    pub time: u64,
    /// Resets, with the virtual time of each, ns.
    pub resets: Vec<u64>,
    /// What the firmware touched and the emulator has nothing at, by address, or no model for, by name; a list that grows is
    /// a new blind spot.
    pub blind_spots: Vec<String>,
    /// The stack, which the firmware paints at reset.
    pub stack: Stack,
    /// What the program did that an emulator forgives and the silicon does not.
    pub silicon: Silicon,
    /// Instructions of the dearest tick, from the register access that begins it to the last that it makes.
    pub dearest_tick: u64,
    /// The same of those that began with the relay closed.
    pub dearest_closed: u64,
    /// What the program wrote to its console.
    pub console: String,
    /// The status that it ended with; none where it did not end by itself.
    pub status: Option<u32>,
    /// What [`follow`] followed.
    pub followed: Vec<u64>,
    /// At each line of the log, whether the relay was closed; only where [`run_logged`] watches it.
    pub logged: Vec<bool>,
}

/// Runs the image at `elf` in `world` until the world ends it.
pub fn run<W: World>(elf: &Path, world: W) -> Result<Ran<W>, ReplayError> {
    start(elf, &[], |wire| Lockstep::new(world, wire))
}

/// How much flash the part has, kilobyte, in its factory's word, which the emulator leaves empty (RM0090, 39.2).
const FLASH_SIZE: (u64, u16) = (0x1FFF_7A22, 1024);

/// The same, with bytes at addresses of the flash that an earlier life of the device left there.
pub fn run_with<W: World>(elf: &Path, flash: &[(u64, Vec<u8>)], world: W) -> Result<Ran<W>, ReplayError> {
    let size = (FLASH_SIZE.0, FLASH_SIZE.1.to_le_bytes().to_vec());
    start(elf, &[flash, &[size]].concat(), |wire| Lockstep::new(world, wire))
}

/// The same, and follows the program through one tick: the instructions among `addresses` that it came by, in order.
pub fn follow<W: World>(elf: &Path, world: W, tick: u64, addresses: &[u64]) -> Result<Ran<W>, ReplayError> {
    start(elf, &[], |wire| Lockstep::new(world, wire).follow(tick, addresses))
}

/// The same as [`run`], and notes at each line that the program logs whether the relay was closed.
pub fn run_logged<W: World>(elf: &Path, world: W) -> Result<Ran<W>, ReplayError> {
    let log = crate::size::log(elf)?;
    start(elf, &[], |wire| Lockstep::new(world, wire).log_at(log))
}

fn start<W: World>(
    elf: &Path,
    flash: &[(u64, Vec<u8>)],
    driver: impl FnOnce(Arc<Mutex<crate::Line>>) -> Lockstep<W>,
) -> Result<Ran<W>, ReplayError> {
    let unreadable = |reason: String| ReplayError::Image { path: elf.to_owned(), reason };
    let mut images = vec![Image::read(elf, None).map_err(|error| unreadable(error.to_string()))?];
    for (address, bytes) in flash {
        let content = Image::new(Path::new("flash"), bytes.clone(), Some(*address));
        images.push(content.map_err(|error| unreadable(error.to_string()))?);
    }
    let emulator = |error: &dyn std::error::Error| ReplayError::Emulator(error.to_string());
    let wire = Arc::new(Mutex::new(crate::Line::default()));
    let driver = driver(Arc::clone(&wire));
    let board = Box::new(Board::new(wire, driver.outboard()).map_err(|error| emulator(&error))?);
    let until = VirtualNanos(BOOT_LIMIT * 1_000_000);
    let session = Session::new(board, 0, until).map_err(|error| emulator(&error))?;
    let mut start = Start::new(&images);
    start.semihosting = true;
    let finished = emulator::run(session, &start, driver).map_err(|error| emulator(&error))?;
    let (stop, status) = (finished.stop, finished.exit_status);
    if !finished.driver.ticked() {
        return Err(ReplayError::NoTick(BOOT_LIMIT));
    }
    let (resets, blind_spots) = (finished.session.resets(), blind_spots(&finished.session));
    let resets = resets.iter().map(|reset| reset.at.0).collect();
    let (stack, silicon) = (finished.driver.stack(), finished.driver.silicon());
    let (dearest_tick, dearest_closed) = finished.driver.tick_cost.most();
    let console = finished.driver.console.clone();
    let logged = finished.driver.logged.clone();
    let (world, followed) = finished.driver.into_world();
    Ok(Ran {
        world,
        logged,
        stack,
        silicon,
        dearest_tick,
        dearest_closed,
        console,
        status,
        followed,
        resets,
        blind_spots,
        instructions: stop.map_or(0, |stop| stop.instruction_count),
        time: stop.map_or(0, |stop| stop.at.0),
    })
}

fn blind_spots(session: &Session<Board>) -> Vec<String> {
    let unmodeled = session.unimplemented().values().map(|spot| format!("{}.{}", spot.instance, spot.register));
    session.unmapped().iter().map(ToString::to_string).chain(unmodeled).collect()
}
