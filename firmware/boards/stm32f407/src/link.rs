//! What the link asks of the board: line, flash, pins.

use shakedown_core::link::{MAX_FRAME, Setup, StopCause};
use shakedown_firmware::OpenRelay;
use shakedown_firmware::link_task::{self, LinkBoard};
use shakedown_firmware::queues::TestStatus;
use shakedown_firmware::store;

use crate::{flash::Flash, line::Line, pins, watchdog};

/// The link of this board.
pub type Link = link_task::Link<'static, Hardware>;

/// What the link owns of the board.
pub struct Hardware {
    pub(crate) line: Line,
    pub(crate) flash: Flash,
}

impl LinkBoard for Hardware {
    fn acknowledge(&mut self) {
        self.line.acknowledge();
    }

    fn take(&mut self) -> Option<u8> {
        self.line.take()
    }

    fn ready(&self) -> bool {
        self.line.ready()
    }

    fn send(&mut self, write: impl FnOnce(&mut [u8; MAX_FRAME]) -> usize) {
        self.line.send(write);
    }

    fn save(&mut self, proof: &OpenRelay, setup: &Setup) -> bool {
        let done = self.flash.write(proof, |flash| store::save(flash, setup));
        if let Err(error) = &done {
            defmt::error!("settings not saved: {}", defmt::Debug2Format(error));
        }
        done.is_ok()
    }

    fn standing_cause(&self) -> Option<StopCause> {
        pins::standing_cause()
    }

    fn served(&self) {
        watchdog::served();
    }

    #[cold]
    #[inline(never)]
    fn log(&self, standing: TestStatus) {
        defmt::info!("{}", standing);
    }
}
