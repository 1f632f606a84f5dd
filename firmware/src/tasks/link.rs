//! The link: whatever came is answered, whatever is due is sent, one frame at a time.

use shakedown_core::link::{Assembler, MAX_FRAME, RefusedBecause, Report, Request, encode};
use shakedown_firmware::desk::{Action, Desk, Seen};
use shakedown_firmware::store;

use crate::board::{flash::Flash, line::Line, pins, standing};

pub(crate) use crate::board::line::{received, sent};

/// What the link owns.
pub(crate) struct Link {
    pub(crate) desk: Desk<'static>,
    pub(crate) line: Line,
    pub(crate) flash: Flash,
    pub(crate) assembler: Assembler,
    pub(crate) answer: Option<Report>,
}

impl Link {
    /// Reads requests as long as their answers can leave, then sends what is due.
    pub(crate) fn serve(&mut self) {
        self.line.acknowledge();
        while self.answer.is_none() {
            let Some(byte) = self.line.take() else { break };
            match self.assembler.push::<Request>(byte) {
                Some(Ok(request)) => self.answer = Some(self.carry_out(request)),
                Some(Err(_)) => self.desk.count_garbled(),
                None => {}
            }
        }
        if self.line.ready() {
            if let Some(report) = self.answer.take().or_else(|| self.desk.volunteer(seen())) {
                self.line.send(|buffer: &mut [u8; MAX_FRAME]| encode(&report, buffer).unwrap_or(0));
            }
        }
    }

    fn carry_out(&mut self, request: Request) -> Report {
        let seen = seen();
        match self.desk.take(request, seen, self.desk.milliseconds(seen.ticks)) {
            Action::Send(report) => report,
            Action::Save(setup) => match self.flash.write(|flash| store::save(flash, &setup)) {
                Ok(()) => {
                    self.desk.saved();
                    Report::Done
                }
                Err(error) => {
                    defmt::error!("settings not saved: {}", defmt::Debug2Format(&error));
                    Report::Refused(RefusedBecause::Flash)
                }
            },
        }
    }
}

fn seen() -> Seen {
    let (standing, ticks, dropped) = standing::read();
    Seen { standing, ticks, dropped, cause: pins::standing_cause() }
}
