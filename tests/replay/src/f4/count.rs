//! Instructions between marks: an image that writes numbers to the converter's data register, and when.

use std::path::Path;
use std::sync::Arc;

use rigless::emulator::{self, Access, AccessKind, Driver, Host, Settled, Start, Stop};
use rigless::image::Image;
use rigless::session::Session;
use rigless::time::VirtualNanos;

use super::board::Board;
use crate::ReplayError;

const DAC_DHR12R1: u64 = 0x4000_7408;
/// The mark that ends a run.
const DONE: u64 = 0xFFF;
/// Virtual time between two looks at whether it ended, and until it must have, ns.
const STRIDE: u64 = 1_000_000;
const LIMIT: u64 = 2_000_000_000;

/// A mark, and how many instructions had been retired when it was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mark {
    /// What was written.
    pub value: u64,
    /// Instructions retired until then.
    pub instructions: u64,
}

#[derive(Debug, Default)]
struct Marks(Vec<Mark>);

impl Marks {
    fn ended(&self) -> bool {
        self.0.last().is_some_and(|mark| mark.value == DONE)
    }
}

impl Driver<Board> for Marks {
    fn on_settled(&mut self, _: &mut Session<Board>, _: &mut dyn Host, settled: Settled) {
        if let Settled::Access { access: Access { kind: AccessKind::Write, address, .. }, value } = settled
            && address == DAC_DHR12R1
            && let Settled::Access { access, .. } = settled
        {
            self.0.push(Mark { value, instructions: access.instruction_count });
        }
    }

    fn on_stop(&mut self, _: &mut Session<Board>, stop: Stop, _: &mut dyn Host) -> Option<VirtualNanos> {
        (!self.ended() && stop.at.0 < LIMIT).then_some(VirtualNanos(stop.at.0 + STRIDE))
    }
}

/// Runs the image at `elf` until it marks its end; its marks.
pub fn marks(elf: &Path) -> Result<Vec<Mark>, ReplayError> {
    let image = Image::read(elf, None)
        .map_err(|error| ReplayError::Image { path: elf.to_owned(), reason: error.to_string() })?;
    let emulator = |error: &dyn std::error::Error| ReplayError::Emulator(error.to_string());
    let board = Box::new(Board::new(Arc::default(), None).map_err(|error| emulator(&error))?);
    let session = Session::new(board, 0, VirtualNanos(STRIDE)).map_err(|error| emulator(&error))?;
    let images = [image];
    let finished = emulator::run(session, &Start::new(&images), Marks::default()).map_err(|error| emulator(&error))?;
    if finished.driver.ended() {
        Ok(finished.driver.0)
    } else {
        Err(ReplayError::Emulator("the image did not mark its end".into()))
    }
}
